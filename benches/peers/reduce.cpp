// CGAL's Surface_mesh_simplification with Lindstrom and Turk's cost and placement on one shape: the time, and the result as
// a PLY file that reduce.py measures.

#include "shape.hpp"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/boost/graph/IO/PLY.h>
#include <ctime>
#include <fstream>

namespace SMS = CGAL::Surface_mesh_simplification;
typedef CGAL::Simple_cartesian<double> Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Mesh;

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s SHAPE.raw FACES OUT.ply\n", argv[0]);
    return 2;
  }
  const Shape shape = read_shape(argv[1]);
  Mesh mesh;
  for (const auto& p : shape.points) {
    mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
  }
  for (const auto& t : shape.triangles) {
    mesh.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
  }
  // On a closed mesh two faces go with three edges.
  const std::size_t edges = std::strtoull(argv[2], nullptr, 10) * 3 / 2;
  const std::clock_t start = std::clock();
  SMS::edge_collapse(mesh, SMS::Count_stop_predicate<Mesh>(edges),
                     CGAL::parameters::get_cost(SMS::LindstromTurk_cost<Mesh>())
                         .get_placement(SMS::LindstromTurk_placement<Mesh>()));
  std::printf("cgal\treduce\t%.3f\ts\n", double(std::clock() - start) / CLOCKS_PER_SEC);
  mesh.collect_garbage();
  std::ofstream out(argv[3], std::ios::binary);
  CGAL::IO::write_PLY(out, mesh);
  return 0;
}
