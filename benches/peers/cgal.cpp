// CGAL's Surface_mesh on one shape: build, one-ring sweep, check, boundary, memory, Euler operations. The build is the faster of adding faces
// one by one and of Polygon Mesh Processing's conversion of a soup; both are printed.

#include "shape.hpp"

#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/Euler_operations.h>
#include <CGAL/boost/graph/helpers.h>

typedef CGAL::Simple_cartesian<double> Kernel;
typedef Kernel::Point_3 Point;
typedef CGAL::Surface_mesh<Point> Mesh;

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

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FILE REPEATS\n", argv[0]);
    return 2;
  }
  const char* name = "cgal";
  const Shape shape = read_shape(argv[1]);
  const int repeats = std::atoi(argv[2]);
  const double faces = shape.triangles.size(), vertices = shape.points.size();

  std::vector<Point> points;
  for (const auto& p : shape.points) {
    points.emplace_back(p[0], p[1], p[2]);
  }
  const auto build_soup = [&] {
    Mesh mesh;
    CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, shape.triangles, mesh);
    return mesh;
  };
  print_memory(name, "_soup", faces, build_soup);
  print_memory(name, "", faces, [&] { return build(shape); });
  const auto one_by_one = best(repeats, [&] { return build(shape); });
  const auto from_soup = best(repeats, build_soup);
  print(name, "build_add_face", one_by_one, faces, "ns/face");
  print(name, "build_soup", from_soup, faces, "ns/face");
  print(name, "build", one_by_one.least < from_soup.least ? one_by_one : from_soup, faces, "ns/face");

  const Mesh mesh = build(shape);
  if (mesh.number_of_faces() != shape.triangles.size() || build_soup().number_of_faces() != mesh.number_of_faces()) {
    fail("cgal lost faces");
  }
  std::array<double, 3> sum;
  const auto ring = best(repeats, [&] {
    sum = {0, 0, 0};
    for (const auto v : mesh.vertices()) {
      for (const auto n : CGAL::vertices_around_target(mesh.halfedge(v), mesh)) {
        const Point& p = mesh.point(n);
        sum[0] += p.x();
        sum[1] += p.y();
        sum[2] += p.z();
      }
    }
    return sum;
  });
  print(name, "ring", ring, vertices, "ns/vertex");
  print(name, "ring_checksum", sum[0] + sum[1] + sum[2], "length");

  bool ok = true;
  const auto check = best(repeats, [&] { return ok = CGAL::is_valid_polygon_mesh(mesh) && ok; });
  if (!ok) {
    fail("cgal finds its own mesh broken");
  }
  print(name, "validate", check, faces, "ns/face");

  std::size_t boundary = 0;
  const auto count = best(repeats, [&] {
    boundary = 0;
    for (const auto e : mesh.edges()) {
      boundary += mesh.is_border(e);
    }
    return boundary;
  });
  print(name, "boundary", count, double(mesh.number_of_edges()), "ns/edge");
  print(name, "boundary_edges", double(boundary), "edges");

  typedef Mesh::Halfedge_index H;
  time_edits<Mesh>(name, "", shape, repeats, [&] { return build(shape); },
    [](const Mesh& m, std::uint32_t a, std::uint32_t b) {
      return m.halfedge(Mesh::Vertex_index(a), Mesh::Vertex_index(b));
    },
    [](Mesh& m, H h, Edit edit) {
      const auto e = m.edge(h);
      if (m.is_removed(e)) {
        return false;
      }
      const auto opposite_vertex = [&m](H side) { return m.target(m.next(side)); };
      switch (edit) {
        case Edit::flip: {
          if (m.is_border(e)) return false;
          const auto c = opposite_vertex(h), d = opposite_vertex(m.opposite(h));
          if (c == d || m.halfedge(c, d) != Mesh::null_halfedge()) return false;
          CGAL::Euler::flip_edge(h, m);
          return true;
        }
        case Edit::split: {
          const Point middle = CGAL::midpoint(m.point(m.source(h)), m.point(m.target(h)));
          const H half = CGAL::Euler::split_edge(h, m);
          m.point(m.target(half)) = middle;
          const H other = m.opposite(h);
          if (!m.is_border(half)) CGAL::Euler::split_face(half, m.next(h), m);
          if (!m.is_border(other)) CGAL::Euler::split_face(other, m.next(m.next(other)), m);
          return true;
        }
        case Edit::collapse:
          if (!CGAL::Euler::does_satisfy_link_condition(e, m)) return false;
          // Which end stays is its own choice, so the counts of what was done differ a little from the others.
          CGAL::Euler::collapse_edge(e, m);
          return true;
      }
      return false;
    });
}
