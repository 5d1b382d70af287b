#include "buildings/solids/slopes.h"

namespace skyquilt::buildings {

std::vector<Slope> SlopesOf(const Shape& shape, const Part& part) {
  const Eigen::Vector2d least = shape.MinOf(part, false), most = shape.MaxOf(part, false), half = 0.5 * (most - least);
  const double rise = part.ridge_z - part.eave_z;
  // Up from both walls along an axis.
  std::vector<Slope> slopes;
  const auto add_pair = [&](int axis, double pitch) {
    const Eigen::Vector2d up = pitch * (axis == 0 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY());
    slopes.push_back({up, part.eave_z - pitch * least[axis]});
    slopes.push_back({-up, part.eave_z + pitch * most[axis]});
  };
  const int across = part.along_u ? 1 : 0;
  const bool hip = part.roof == RoofKind::kHip;
  const bool pitched = (part.roof == RoofKind::kGable || hip) && !(rise <= 0.0) && half.minCoeff() > 0.0;
  if (!pitched) return {{Eigen::Vector2d::Zero(), part.eave_z}};
  const double pitch = rise / (hip ? half.minCoeff() : half[across]);
  add_pair(across, pitch);
  if (hip) add_pair(1 - across, pitch);
  return slopes;
}

Ring Clipped(const Ring& convex, const Eigen::Vector2d& normal, double limit) {
  Ring kept;
  for (size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d &a = convex[i], &b = convex[(i + 1) % convex.size()];
    const double over_a = normal.dot(a) - limit, over_b = normal.dot(b) - limit;
    if (over_a <= 0.0) kept.push_back(a);
    if ((over_a < 0.0 && over_b > 0.0) || (over_a > 0.0 && over_b < 0.0)) kept.push_back(a + over_a / (over_a - over_b) * (b - a));
  }
  return kept;
}

}  // namespace skyquilt::buildings
