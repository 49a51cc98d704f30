// What both peers share: the input, the clock, and how results are printed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <string>
#include <time.h>
#include <vector>

struct Shape {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Little-endian: u64 vertices, u64 triangles, three f64 a vertex, three u32 a triangle.
inline Shape read_shape(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t counts[2] = {0, 0};
  file.read(reinterpret_cast<char*>(counts), sizeof counts);
  Shape shape;
  shape.points.resize(counts[0]);
  shape.triangles.resize(counts[1]);
  file.read(reinterpret_cast<char*>(shape.points.data()), counts[0] * sizeof shape.points[0]);
  file.read(reinterpret_cast<char*>(shape.triangles.data()), counts[1] * sizeof shape.triangles[0]);
  if (!file) {
    std::fprintf(stderr, "cannot read %s\n", path);
    std::exit(3);
  }
  return shape;
}

// Processor time of this thread, in nanoseconds.
inline double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

// The least time of several runs.
template <class Run>
double best(int repeats, Run run) {
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < repeats; ++i) {
    const double start = now();
    run();
    least = std::min(least, now() - start);
  }
  return least;
}

// Bytes taken from the heap and not given back.
inline double heap() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

inline void print(const char* name, const char* operation, double value, const char* unit) {
  std::printf("%s\t%s\t%.3f\t%s\n", name, operation, value, unit);
}
