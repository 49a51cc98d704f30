// OpenMesh on one shape: build, one-ring sweep, check, boundary, memory; in double and in its default single precision.

#include "shape.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Utils/MeshCheckerT.hh>
#include <sstream>

struct DoubleTraits : OpenMesh::DefaultTraits {
  typedef OpenMesh::Vec3d Point;
  typedef OpenMesh::Vec3d Normal;
};

template <class Mesh>
void build(Mesh& mesh, const Shape& shape) {
  typedef typename Mesh::Point Point;
  mesh.reserve(shape.points.size(), shape.triangles.size() * 3 / 2 + shape.points.size() / 100, shape.triangles.size());
  for (const auto& p : shape.points) {
    mesh.add_vertex(Point(p[0], p[1], p[2]));
  }
  for (const auto& t : shape.triangles) {
    mesh.add_face(mesh.vertex_handle(t[0]), mesh.vertex_handle(t[1]), mesh.vertex_handle(t[2]));
  }
}

template <class Mesh>
void time_all(const char* name, const Shape& shape, int repeats) {
  const double faces = shape.triangles.size(), vertices = shape.points.size();
  {
    const double before = heap();
    Mesh mesh;
    build(mesh, shape);
    print(name, "memory", (heap() - before) / faces, "bytes/face");
  }
  print(name, "build", best(repeats, [&] { Mesh mesh; build(mesh, shape); }) / faces, "ns/face");
  Mesh mesh;
  build(mesh, shape);
  typename Mesh::Point sum;
  const double ring = best(repeats, [&] {
    sum = typename Mesh::Point(0, 0, 0);
    for (const auto v : mesh.vertices()) {
      for (const auto n : mesh.vv_range(v)) {
        sum += mesh.point(n);
      }
    }
  });
  print(name, "ring", ring / vertices, "ns/vertex");
  print(name, "ring_checksum", double(sum[0]) + sum[1] + sum[2], "length");
  bool ok = true;
  const double check = best(repeats, [&] {
    std::ostringstream log;
    ok = OpenMesh::Utils::MeshCheckerT<Mesh>(mesh).check(OpenMesh::Utils::MeshCheckerT<Mesh>::CHECK_ALL, log) && ok;
  });
  print(name, ok ? "validate" : "validate_failed", check / faces, "ns/face");
  std::size_t boundary = 0;
  const double count = best(repeats, [&] {
    boundary = 0;
    for (const auto e : mesh.edges()) {
      boundary += mesh.is_boundary(e);
    }
  });
  print(name, "boundary", count / double(mesh.n_edges()), "ns/edge");
  print(name, "boundary_edges", double(boundary), "edges");
}

int main(int argc, char** argv) {
  if (argc < 3) {
    return 2;
  }
  const Shape shape = read_shape(argv[1]);
  const int repeats = std::atoi(argv[2]);
  time_all<OpenMesh::TriMesh_ArrayKernelT<>>("openmesh_f32", shape, repeats);
  time_all<OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>>("openmesh", shape, repeats);
}
