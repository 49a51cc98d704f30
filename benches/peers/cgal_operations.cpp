// CGAL on whole operations: subdivision, normals, volume, components, the orientation of a soup half of whose faces are
// reversed, the welding of a soup of single triangles, and from that soup to a mesh in three calls.

#include "shape.hpp"

#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>

namespace PMP = CGAL::Polygon_mesh_processing;
typedef CGAL::Simple_cartesian<double> Kernel;
typedef Kernel::Point_3 Point;
typedef Kernel::Vector_3 Vector;
typedef CGAL::Surface_mesh<Point> Mesh;
typedef std::vector<std::size_t> Polygon;

static Mesh build(const Shape& shape) {
  typedef Mesh::Vertex_index V;
  Mesh mesh;
  mesh.reserve(shape.points.size(), shape.triangles.size() * 3 / 2 + shape.points.size() / 100, shape.triangles.size());
  for (const auto& p : shape.points) {
    mesh.add_vertex(Point(p[0], p[1], p[2]));
  }
  for (const auto& t : shape.triangles) {
    mesh.add_face(V(t[0]), V(t[1]), V(t[2]));
  }
  return mesh;
}

// Each run changes a thing of its own, made before the clock starts.
template <class Thing, class Run>
Thing time_change(const std::string& operation, const Thing& thing, int repeats, Run run) {
  std::vector<double> times;
  Thing last;
  for (int i = 0; i < std::max(repeats, 1); ++i) {
    Thing fresh = thing;
    const double start = now();
    run(fresh);
    times.push_back(now() - start);
    last = std::move(fresh);
  }
  std::sort(times.begin(), times.end());
  print("cgal", operation, times.front() / 1e9, "s");
  print("cgal", operation + "_median", times[times.size() / 2] / 1e9, "s");
  return last;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FILE REPEATS\n", argv[0]);
    return 2;
  }
  const Shape shape = read_shape(argv[1]);
  const int repeats = std::atoi(argv[2]);
  const Mesh mesh = build(shape);
  const auto refined = [](const char* name, const Mesh& fine) {
    print("cgal", std::string(name) + "_faces", double(fine.number_of_faces()), "faces");
  };
  refined("loop", time_change("loop", mesh, repeats, [](Mesh& m) {
    CGAL::Subdivision_method_3::Loop_subdivision(m, CGAL::parameters::number_of_iterations(1));
  }));
  refined("catmull_clark", time_change("catmull_clark", mesh, repeats, [](Mesh& m) {
    CGAL::Subdivision_method_3::CatmullClark_subdivision(m, CGAL::parameters::number_of_iterations(1));
  }));
  refined("sqrt3", time_change("sqrt3", mesh, repeats, [](Mesh& m) {
    CGAL::Subdivision_method_3::Sqrt3_subdivision(m, CGAL::parameters::number_of_iterations(1));
  }));
  time_change("normals", mesh, repeats, [](Mesh& m) {
    const auto at_vertices = m.add_property_map<Mesh::Vertex_index, Vector>("v:normal").first;
    const auto at_faces = m.add_property_map<Mesh::Face_index, Vector>("f:normal").first;
    PMP::compute_normals(m, at_vertices, at_faces);
  });
  double volume = 0;
  bool closed = CGAL::is_closed(mesh);
  if (closed) {
    const auto took = best(repeats, [&] { return volume = PMP::volume(mesh); });
    print("cgal", "volume", took.least / 1e9, "s");
    print("cgal", "volume_checksum", volume, "volume");
  }
  std::size_t parts = 0;
  time_change("components", mesh, repeats, [&](Mesh& m) {
    const auto part = m.add_property_map<Mesh::Face_index, std::size_t>("f:part").first;
    parts = PMP::connected_components(m, part);
  });
  print("cgal", "components_edges", double(parts), "parts");

  // Every other face reversed.
  std::vector<Point> points;
  std::vector<Polygon> polygons;
  for (const auto& p : shape.points) {
    points.emplace_back(p[0], p[1], p[2]);
  }
  for (std::size_t f = 0; f < shape.triangles.size(); ++f) {
    const auto& t = shape.triangles[f];
    polygons.push_back(f % 2 ? Polygon{t[0], t[2], t[1]} : Polygon{t[0], t[1], t[2]});
  }
  typedef std::pair<std::vector<Point>, std::vector<Polygon>> Soup;
  time_change("unify", Soup{points, polygons}, repeats, [](Soup& s) {
    if (!PMP::orient_polygon_soup(s.first, s.second)) {
      fail("cgal cannot orient the soup");
    }
  });
  // Every face with corners of its own.
  std::vector<Point> corners;
  std::vector<Polygon> single;
  for (const auto& t : shape.triangles) {
    const std::size_t first = corners.size();
    for (const auto v : t) {
      corners.push_back(points[v]);
    }
    single.push_back({first, first + 1, first + 2});
  }
  const Soup welded = time_change("weld_soup", Soup{corners, single}, repeats, [](Soup& s) {
    PMP::merge_duplicate_points_in_polygon_soup(s.first, s.second);
  });
  print("cgal", "weld_soup_edges", double(welded.first.size()), "vertices");
  struct Both {
    Soup soup;
    Mesh mesh;
  };
  const Both made = time_change("soup_to_mesh", Both{Soup{corners, single}, Mesh()}, repeats, [](Both& b) {
    PMP::merge_duplicate_points_in_polygon_soup(b.soup.first, b.soup.second);
    PMP::orient_polygon_soup(b.soup.first, b.soup.second);
    PMP::polygon_soup_to_polygon_mesh(b.soup.first, b.soup.second, b.mesh);
  });
  refined("soup_to_mesh", made.mesh);
}
