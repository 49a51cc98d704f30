// OpenMesh on one shape: build, one-ring sweep, check, boundary, memory, flips, splits and collapses; in double, and in its default single
// precision under names that end in _f32.
//
// Faces are added by OpenMesh's compiled core, and Debian's has assertions in it, which make that more than twice as slow.
// With CORE_ASSERTS defined the build is therefore called build_asserts, and compared with nothing.

#include "shape.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Utils/MeshCheckerT.hh>
#include <sstream>

#ifdef CORE_ASSERTS
static const std::string build_name = "build_asserts";
#else
static const std::string build_name = "build";
#endif

struct DoubleTraits : OpenMesh::DefaultTraits {
  typedef OpenMesh::Vec3d Point;
  typedef OpenMesh::Vec3d Normal;
};

template <class Mesh>
Mesh build(const Shape& shape) {
  typedef typename Mesh::Point Point;
  Mesh mesh;
  mesh.reserve(shape.points.size(), shape.triangles.size() * 3 / 2 + shape.points.size() / 100, shape.triangles.size());
  for (const auto& p : shape.points) {
    mesh.add_vertex(Point(p[0], p[1], p[2]));
  }
  for (const auto& t : shape.triangles) {
    mesh.add_face(mesh.vertex_handle(t[0]), mesh.vertex_handle(t[1]), mesh.vertex_handle(t[2]));
  }
  return mesh;
}

template <class Mesh>
void time_all(const std::string& suffix, const Shape& shape, int repeats) {
  const char* name = "openmesh";
  const double faces = shape.triangles.size(), vertices = shape.points.size();
  print_memory(name, suffix, faces, [&] { return build<Mesh>(shape); });
  print(name, build_name + suffix, best(repeats, [&] { return build<Mesh>(shape); }), faces, "ns/face");

  const Mesh mesh = build<Mesh>(shape);
  if (mesh.n_faces() != shape.triangles.size()) {
    fail("openmesh lost faces");
  }
  std::array<double, 3> sum;
  const auto ring = best(repeats, [&] {
    sum = {0, 0, 0};
    for (const auto v : mesh.vertices()) {
      for (const auto n : mesh.vv_range(v)) {
        const auto& p = mesh.point(n);
        sum[0] += p[0];
        sum[1] += p[1];
        sum[2] += p[2];
      }
    }
    return sum;
  });
  print(name, "ring" + suffix, ring, vertices, "ns/vertex");
  print(name, "ring_checksum" + suffix, sum[0] + sum[1] + sum[2], "length");

  bool ok = true;
  const auto check = best(repeats, [&] {
    typedef OpenMesh::Utils::MeshCheckerT<Mesh> Checker;
    std::ostringstream log;
    ok = Checker(mesh).check(Checker::CHECK_ALL, log) && ok;
    return ok;
  });
  if (!ok) {
    fail("openmesh finds its own mesh broken");
  }
  print(name, "validate" + suffix, check, faces, "ns/face");

  std::size_t boundary = 0;
  const auto count = best(repeats, [&] {
    boundary = 0;
    for (const auto e : mesh.edges()) {
      boundary += mesh.is_boundary(e);
    }
    return boundary;
  });
  print(name, "boundary" + suffix, count, mesh.n_edges(), "ns/edge");
  print(name, "boundary_edges" + suffix, double(boundary), "edges");

  time_edits<Mesh>(name, suffix, shape, repeats, [&shape] {
    Mesh fresh = build<Mesh>(shape);
    fresh.request_vertex_status();
    fresh.request_edge_status();
    fresh.request_halfedge_status();
    fresh.request_face_status();
    return fresh;
  }, [](const Mesh& m, std::uint32_t a, std::uint32_t b) {
    return m.find_halfedge(m.vertex_handle(a), m.vertex_handle(b));
  }, [](Mesh& m, OpenMesh::HalfedgeHandle h, Edit edit) {
    const auto e = m.edge_handle(h);
    if (m.status(e).deleted()) {
      return false;
    }
    bool ok = true;
    switch (edit) {
      case Edit::flip:
        ok = m.is_flip_ok(e);
        if (ok) m.flip(e);
        break;
      case Edit::split:
        m.split(e, (m.point(m.from_vertex_handle(h)) + m.point(m.to_vertex_handle(h))) * 0.5f);
        break;
      case Edit::collapse:
        ok = m.is_collapse_ok(h);
        if (ok) m.collapse(h);
        break;
    }
    return ok;
  });
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FILE REPEATS\n", argv[0]);
    return 2;
  }
  const Shape shape = read_shape(argv[1]);
  const int repeats = std::atoi(argv[2]);
  time_all<OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>>("", shape, repeats);
  time_all<OpenMesh::TriMesh_ArrayKernelT<>>("_f32", shape, repeats);
}
