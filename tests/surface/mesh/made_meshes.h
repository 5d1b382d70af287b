// Meshes for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "surface/mesh.h"

namespace skyquilt::surface {

using HeightOf = std::function<double(int x, int y)>;
using IsCell = std::function<bool(int x, int y)>;

// Vertices at whole metres, x0 <= x <= x1 and likewise y; two triangles per cell [x, x + 1) x [y, y + 1) that is wanted. Keys tell x and y.
inline Mesh GridMesh(
    int x0, int y0, int x1, int y1, const HeightOf& height, const IsCell& wanted = [](int, int) { return true; }) {
  Mesh mesh;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      mesh.position.emplace_back(x, y, height(x, y));
      mesh.key.push_back(static_cast<uint64_t>(x + 100000) << 44U | static_cast<uint64_t>(y + 100000) << 24U);
      mesh.views.push_back(static_cast<uint8_t>(3 + (x & 1)));
      mesh.filled.push_back(0);
    }
  }
  const auto index = [&](int x, int y) { return static_cast<uint32_t>((y - y0) * (x1 - x0 + 1) + x - x0); };
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      if (!wanted(x, y)) continue;
      mesh.triangle.push_back({index(x, y), index(x + 1, y), index(x + 1, y + 1)});
      mesh.triangle.push_back({index(x, y), index(x + 1, y + 1), index(x, y + 1)});
    }
  }
  return mesh;
}

inline double Flat(int, int) {
  return 0.0;
}

// The same noise at the same place.
inline double Noise(int x, int y, double sigma) {
  std::mt19937 random(static_cast<uint32_t>(x * 7919 + y * 104729 + 17));
  return std::normal_distribution<double>(0.0, sigma)(random);
}

// Around the origin, counter-clockwise from outside: a cube's faces of n x n cells blown up.
inline Mesh SphereMesh(int n, double radius) {
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, sign = face % 2 == 0 ? 1 : -1;
    const auto first = static_cast<uint32_t>(mesh.position.size());
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        Eigen::Vector3i at;
        at[axis] = sign * n;
        at[(axis + 1) % 3] = 2 * i - n;
        at[(axis + 2) % 3] = 2 * j - n;
        mesh.position.push_back(at.cast<double>().normalized() * radius);
        mesh.key.push_back(static_cast<uint64_t>(at.x() + n) << 44U | static_cast<uint64_t>(at.y() + n) << 24U |
                           static_cast<uint64_t>(at.z() + n) << 6U);
        mesh.views.push_back(4);
        mesh.filled.push_back(0);
      }
    }
    const auto index = [&](int i, int j) { return first + static_cast<uint32_t>(i * (n + 1) + j); };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        Triangle s = {index(i, j), index(i + 1, j), index(i + 1, j + 1)}, t = {index(i, j), index(i + 1, j + 1), index(i, j + 1)};
        if (sign < 0) {
          std::swap(s[1], s[2]);
          std::swap(t[1], t[2]);
        }
        mesh.triangle.push_back(s);
        mesh.triangle.push_back(t);
      }
    }
  }
  return mesh;
}

}  // namespace skyquilt::surface
