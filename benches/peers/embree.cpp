// Embree on one shape: building its tree, first hits, any hits, and closest points by its point query; in single precision,
// which is all it has. The file is what `cargo bench --bench query -- --write FILE` leaves. Single rays, one thread, as
// ours.

#include "shape.hpp"

#include <cmath>
#include <embree3/rtcore.h>
#include <limits>

struct Questions {
  Shape shape;
  std::vector<std::array<double, 6>> rays;
  std::vector<std::array<double, 3>> points;
};

static Questions read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t counts[4];
  file.read(reinterpret_cast<char*>(counts), sizeof counts);
  if (!file) {
    fail(std::string("no questions in ") + path);
  }
  Questions q;
  q.shape.points.resize(counts[0]);
  q.shape.triangles.resize(counts[1]);
  q.rays.resize(counts[2]);
  q.points.resize(counts[3]);
  file.read(reinterpret_cast<char*>(q.shape.points.data()), counts[0] * 24);
  file.read(reinterpret_cast<char*>(q.shape.triangles.data()), counts[1] * 12);
  file.read(reinterpret_cast<char*>(q.rays.data()), counts[2] * 48);
  file.read(reinterpret_cast<char*>(q.points.data()), counts[3] * 24);
  if (!file) {
    fail(std::string("cannot read ") + path);
  }
  return q;
}

struct Vec {
  float x, y, z;
};
static Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static Vec along(Vec a, Vec d, float t) { return {a.x + d.x * t, a.y + d.y * t, a.z + d.z * t}; }
static float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// The point of a triangle that is closest to p (Ericson, "Real-Time Collision Detection", 5.1.5).
static Vec closest(Vec p, Vec a, Vec b, Vec c) {
  const Vec ab = b - a, ac = c - a, ap = p - a;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec bp = p - b;
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
  const Vec cp = p - c;
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return along(b, c - b, (d4 - d3) / (d4 - d3 + (d5 - d6)));
  const float per = 1 / (va + vb + vc);
  return along(along(a, ab, vb * per), ac, vc * per);
}

struct Search {
  const std::vector<Vec>* points;
  const Shape* shape;
  float best;
};

static bool visit(RTCPointQueryFunctionArguments* args) {
  auto* search = static_cast<Search*>(args->userPtr);
  const auto& t = search->shape->triangles[args->primID];
  const auto& v = *search->points;
  const Vec p{args->query->x, args->query->y, args->query->z};
  const Vec d = p - closest(p, v[t[0]], v[t[1]], v[t[2]]);
  const float distance = std::sqrt(dot(d, d));
  if (distance < search->best) {
    search->best = distance;
    args->query->radius = distance;
    return true;
  }
  return false;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FILE REPEATS\n", argv[0]);
    return 2;
  }
  const Questions q = read(argv[1]);
  const int repeats = std::atoi(argv[2]);
  const char* name = "embree_f32";
  std::vector<Vec> points;
  for (const auto& p : q.shape.points) {
    points.push_back({float(p[0]), float(p[1]), float(p[2])});
  }
  const RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  RTCScene scene = nullptr;
  const auto build = best(repeats, [&] {
    if (scene) {
      rtcReleaseScene(scene);
    }
    scene = rtcNewScene(device);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, points.data(), 0, sizeof(Vec), points.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, q.shape.triangles.data(), 0, 12, q.shape.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene);
    return 0;
  });
  print(name, "index", build.least / 1e9, "s");

  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const auto ray = [](const std::array<double, 6>& r) {
    RTCRay ray{};
    ray.org_x = float(r[0]), ray.org_y = float(r[1]), ray.org_z = float(r[2]);
    ray.dir_x = float(r[3]), ray.dir_y = float(r[4]), ray.dir_z = float(r[5]);
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = -1;
    return ray;
  };
  std::size_t found = 0;
  const auto first = best(repeats, [&] {
    found = 0;
    for (const auto& r : q.rays) {
      RTCRayHit hit{ray(r), {}};
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &hit);
      found += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return found;
  });
  print(name, "first_hit", q.rays.size() / first.least * 1e6, "thousand/s");
  print(name, "first_hit_found", double(found), "answers");
  const auto any = best(repeats, [&] {
    found = 0;
    for (const auto& r : q.rays) {
      RTCRay one = ray(r);
      rtcOccluded1(scene, &context, &one);
      found += one.tfar < 0;
    }
    return found;
  });
  print(name, "is_hit", q.rays.size() / any.least * 1e6, "thousand/s");
  print(name, "is_hit_found", double(found), "answers");

  double sum = 0;
  const auto near = best(repeats, [&] {
    sum = 0;
    for (const auto& p : q.points) {
      RTCPointQuery query{float(p[0]), float(p[1]), float(p[2]), 0, std::numeric_limits<float>::infinity()};
      RTCPointQueryContext stack;
      rtcInitPointQueryContext(&stack);
      Search search{&points, &q.shape, std::numeric_limits<float>::infinity()};
      rtcPointQuery(scene, &query, &stack, visit, &search);
      sum += search.best;
    }
    return sum;
  });
  print(name, "closest_point", q.points.size() / near.least * 1e6, "thousand/s");
  print(name, "closest_point_checksum", sum, "length");
}
