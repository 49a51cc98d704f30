// OpenMesh on whole operations: subdivision, normals, smoothing, reduction; in double, and in its default single
// precision under names that end in _f32. A reduced mesh is left as a PLY file for reduce.py.

#include "shape.hpp"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>

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

// Each run changes a mesh of its own, made before the clock starts.
template <class Mesh, class Run>
Mesh time_change(const std::string& operation, const Mesh& mesh, int repeats, Run run) {
  std::vector<double> times;
  Mesh last;
  for (int i = 0; i < std::max(repeats, 1); ++i) {
    Mesh fresh = mesh;
    const double start = now();
    run(fresh);
    times.push_back(now() - start);
    last = std::move(fresh);
  }
  std::sort(times.begin(), times.end());
  print("openmesh", operation, times.front() / 1e9, "s");
  print("openmesh", operation + "_median", times[times.size() / 2] / 1e9, "s");
  return last;
}

template <class Mesh, class PolyMesh>
void time_all(const std::string& suffix, const Shape& shape, int repeats, const char* reduced) {
  typedef typename Mesh::Point::value_type Real;
  const Mesh mesh = build<Mesh>(shape);
  const auto refined = [&](const char* name, const auto& fine) {
    print("openmesh", name + suffix + "_faces", double(fine.n_faces()), "faces");
  };
  refined("loop", time_change("loop" + suffix, mesh, repeats, [](Mesh& m) {
    OpenMesh::Subdivider::Uniform::LoopT<Mesh, Real> scheme;
    scheme.attach(m);
    scheme(1);
    scheme.detach();
  }));
  const PolyMesh polygons = build<PolyMesh>(shape);
  refined("catmull_clark", time_change("catmull_clark" + suffix, polygons, repeats, [](PolyMesh& m) {
    OpenMesh::Subdivider::Uniform::CatmullClarkT<PolyMesh, Real> scheme;
    scheme.attach(m);
    scheme(1);
    scheme.detach();
  }));
  time_change("normals" + suffix, mesh, repeats, [](Mesh& m) {
    m.request_face_normals();
    m.request_vertex_normals();
    m.update_normals();
  });
  time_change("laplacian10" + suffix, mesh, repeats, [](Mesh& m) {
    OpenMesh::Smoother::JacobiLaplaceSmootherT<Mesh> smoother(m);
    smoother.initialize(OpenMesh::Smoother::SmootherT<Mesh>::Tangential_and_Normal, OpenMesh::Smoother::SmootherT<Mesh>::C0);
    smoother.smooth(10);
  });
  const Mesh few = time_change("reduce" + suffix, mesh, repeats, [](Mesh& m) {
    typedef OpenMesh::Decimater::DecimaterT<Mesh> Decimater;
    Decimater decimater(m);
    typename OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    decimater.initialize();
    decimater.decimate_to_faces(0, m.n_faces() / 10);
    m.garbage_collection();
  });
  refined("reduce", few);
  if (suffix.empty() && reduced) {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const auto v : few.vertices()) {
      const auto& p = few.point(v);
      points.push_back({double(p[0]), double(p[1]), double(p[2])});
    }
    for (const auto f : few.faces()) {
      std::array<std::uint32_t, 3> t;
      int i = 0;
      for (const auto v : few.fv_range(f)) {
        t[i++] = v.idx();
      }
      triangles.push_back(t);
    }
    write_ply(reduced, points, triangles);
  }
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: %s FILE REPEATS [REDUCED.ply]\n", argv[0]);
    return 2;
  }
  const Shape shape = read_shape(argv[1]);
  const int repeats = std::atoi(argv[2]);
  typedef OpenMesh::TriMesh_ArrayKernelT<DoubleTraits> Triangles;
  typedef OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits> Polygons;
  time_all<Triangles, Polygons>("", shape, repeats, argc == 4 ? argv[3] : nullptr);
  time_all<OpenMesh::TriMesh_ArrayKernelT<>, OpenMesh::PolyMesh_ArrayKernelT<>>("_f32", shape, repeats, nullptr);
}
