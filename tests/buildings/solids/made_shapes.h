// Shapes for tests of solids: single houses by hand, and random ones.
#pragma once

#include <algorithm>
#include <vector>

#include "buildings/building.h"
#include "core/base/random.h"

namespace skyquilt::buildings {

inline Part MakePart(int u0, int u1, int v0, int v1, RoofKind roof, bool along_u, double eave_z, double ridge_z, int joins = -1) {
  return {u0, u1, v0, v1, roof, along_u, eave_z, ridge_z, joins};
}

// Parts between common lines turned by an odd angle, far from the origin of ENU; ground at 100 m.
inline Shape MakeShape(std::vector<double> u, std::vector<double> v, std::vector<Part> parts) {
  Shape shape;
  shape.origin = {812.3456, -431.2345};
  shape.yaw_rad = 0.4321;
  shape.u = std::move(u);
  shape.v = std::move(v);
  shape.parts = std::move(parts);
  shape.ground_z = 100.0;
  return shape;
}

// Which coincidences a random shape may have.
enum class Chance {
  kCommonLines,   // parts share wall lines, heights differ: what a fit gives
  kCommonHeights  // heights are shared too: what people build, with roofs that meet exactly
};

// One to four parts with flat, gable or hip roofs; gables may join others. Parts may touch at corners or not at all.
inline Shape RandomShape(base::Random& random, Chance chance) {
  const auto lines = [&] {
    std::vector<double> at = {0.0};
    while (at.size() < 5) at.push_back(at.back() + random.Uniform(1.5, 9.0));
    return at;
  };
  Shape shape = MakeShape(lines(), lines(), {});
  shape.yaw_rad = random.Uniform(0.0, 1.57);
  const int n = 1 + static_cast<int>(random.Below(4));
  const auto pair_of_lines = [&](int* from, int* to) {
    *from = static_cast<int>(random.Below(4));
    *to = *from + 1 + static_cast<int>(random.Below(static_cast<uint32_t>(4 - *from)));
  };
  const auto height = [&](double low, double step) {
    return chance == Chance::kCommonHeights ? low + step * static_cast<double>(random.Below(3)) : low + random.Uniform(0.0, 3.0 * step);
  };
  for (int p = 0; p < n; ++p) {
    Part part;
    pair_of_lines(&part.u0, &part.u1);
    pair_of_lines(&part.v0, &part.v1);
    part.roof = std::vector{RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip}[random.Below(3)];
    part.along_u = random.Below(2) == 0;
    if (part.roof == RoofKind::kHip) {
      const Eigen::Vector2d size = shape.MaxOf(part, false) - shape.MinOf(part, false);
      part.along_u = size.x() >= size.y();
    }
    part.eave_z = shape.ground_z + height(3.0, 3.0);
    part.ridge_z = part.roof == RoofKind::kFlat ? part.eave_z : part.eave_z + height(1.0, 1.5);
    shape.parts.push_back(part);
  }
  for (int p = 0; p < n; ++p) {
    const int host = static_cast<int>(random.Below(static_cast<uint32_t>(n)));
    Part& part = shape.parts[static_cast<size_t>(p)];
    const bool pitched = shape.parts[static_cast<size_t>(host)].roof != RoofKind::kFlat;
    if (part.roof == RoofKind::kGable && host != p && pitched && random.Below(2) == 0) part.joins = host;
  }
  return shape;
}

}  // namespace skyquilt::buildings
