// What both peers share: the input, the clock, the memory, and how results are printed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <malloc.h>
#include <string>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <utility>
#include <vector>

struct Shape {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

[[noreturn]] inline void fail(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(3);
}

// Little-endian: u64 vertices, u64 triangles, three f64 a vertex, three u32 a triangle.
inline Shape read_shape(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::uint64_t size = file ? static_cast<std::uint64_t>(file.tellg()) : 0;
  std::uint64_t counts[2] = {0, 0};
  file.seekg(0);
  file.read(reinterpret_cast<char*>(counts), sizeof counts);
  if (!file || counts[0] > size || counts[1] > size || size != 16 + 24 * counts[0] + 12 * counts[1]) {
    fail(std::string("no shape in ") + path);
  }
  Shape shape;
  shape.points.resize(counts[0]);
  shape.triangles.resize(counts[1]);
  file.read(reinterpret_cast<char*>(shape.points.data()), counts[0] * sizeof shape.points[0]);
  file.read(reinterpret_cast<char*>(shape.triangles.data()), counts[1] * sizeof shape.triangles[0]);
  if (!file) {
    fail(std::string("cannot read ") + path);
  }
  return shape;
}

// Processor time of this thread, in nanoseconds.
inline double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

struct Times {
  double least, median;
};

// The least and the median time of several runs. What a run returns is dropped after the clock has stopped.
template <class Run>
Times best(int repeats, Run run) {
  std::vector<double> times;
  for (int i = 0; i < std::max(repeats, 1); ++i) {
    const double start = now();
    const auto result = run();
    times.push_back(now() - start);
    asm volatile("" : : "r"(&result) : "memory");
  }
  std::sort(times.begin(), times.end());
  return {times.front(), (times[(times.size() - 1) / 2] + times[times.size() / 2]) / 2};
}

inline void print(const char* name, const std::string& operation, double value, const char* unit) {
  std::printf("%s\t%s\t%.3f\t%s\n", name, operation.c_str(), value, unit);
}

inline void print(const char* name, const std::string& operation, Times times, double count, const char* unit) {
  print(name, operation, times.least / count, unit);
  print(name, operation + "_median", times.median / count, unit);
}

// Bytes taken from the heap and not given back, mapped blocks included.
inline double heap() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

// Memory of this process in bytes, by the name /proc/self/status gives it: VmRSS now, VmHWM at most.
inline double status(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(name, 0) == 0) {
      return 1024 * std::atof(line.c_str() + name.size());
    }
  }
  fail("no " + name + " in /proc/self/status");
}

// Prints what a mesh takes a face: `memory` is what malloc has handed out for it (mallinfo2), `resident` the pages
// touched for it, `peak` those of the build at its highest. The build runs in a child process, after memory that was
// freed earlier has gone back to the system: none of it is taken again unseen.
template <class Build>
void print_memory(const char* name, const std::string& suffix, double faces, Build build) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) {
    fail("cannot fork");
  }
  if (child == 0) {
    malloc_trim(0);
    const double taken = heap(), resident = status("VmRSS:");
    const auto mesh = build();
    print(name, "memory" + suffix, (heap() - taken) / faces, "bytes/face");
    print(name, "resident" + suffix, (status("VmRSS:") - resident) / faces, "bytes/face");
    print(name, "peak" + suffix, (status("VmHWM:") - resident) / faces, "bytes/face");
    std::fflush(stdout);
    _exit(0);
  }
  int verdict = 0;
  if (waitpid(child, &verdict, 0) != child || verdict != 0) {
    fail("the build failed in the child process");
  }
}

enum class Edit { flip, split, collapse };

// The edges that are edited: 100,000 half-edges of triangles far apart, the same in every program.
inline std::vector<std::pair<std::uint32_t, std::uint32_t>> picks(const Shape& shape) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> picked;
  for (std::uint64_t n = 0; n < 100000; ++n) {
    const auto& t = shape.triangles[n * 7919 % shape.triangles.size()];
    picked.emplace_back(t[n % 3], t[(n + 1) % 3]);
  }
  return picked;
}

// Times checked edits on a fresh mesh each: a flip, a split with the faces beside it, a collapse into an end.
template <class Mesh, class Build, class Find, class Do>
void time_edits(const char* name, const std::string& suffix, const Shape& shape, int repeats, Build build, Find find,
                Do edit) {
  const auto picked = picks(shape);
  const std::pair<Edit, std::string> edits[] = {
      {Edit::flip, "flip"}, {Edit::split, "split"}, {Edit::collapse, "collapse"}};
  for (const auto& [which, what] : edits) {
    std::vector<double> times;
    std::size_t done = 0;
    for (int i = 0; i < std::max(repeats, 1); ++i) {
      Mesh mesh = build();
      std::vector<decltype(find(mesh, 0, 0))> halfedges;
      for (const auto& p : picked) {
        halfedges.push_back(find(mesh, p.first, p.second));
      }
      done = 0;
      const double start = now();
      for (const auto h : halfedges) {
        done += edit(mesh, h, which);
      }
      times.push_back(now() - start);
    }
    std::sort(times.begin(), times.end());
    const Times all{times.front(), (times[(times.size() - 1) / 2] + times[times.size() / 2]) / 2};
    print(name, what + suffix, all, double(picked.size()), "ns/edge");
    print(name, what + "_done" + suffix, double(done), "edits");
  }
}

// A binary PLY file of doubles, as reduce.py reads it.
inline void write_ply(const char* path, const std::vector<std::array<double, 3>>& points,
                      const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.write(reinterpret_cast<const char*>(points.data()), points.size() * sizeof points[0]);
  for (const auto& t : triangles) {
    out.put(3);
    out.write(reinterpret_cast<const char*>(t.data()), sizeof t);
  }
  if (!out) {
    fail(std::string("cannot write ") + path);
  }
}
