#include "simulate/target_paint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

constexpr double kWidestPixel_m = 4.0;  // pixels that are wider hide the targets anyway

// Mean sign over [x - width/2, x + width/2].
float MeanSign(float x, float width) {
  return std::clamp(2.0F * x / std::max(width, 1e-4F), -1.0F, 1.0F);
}

}  // namespace

TargetPaint::TargetPaint(std::vector<PaintedTarget> targets) : targets_(std::move(targets)) {
  std::sort(targets_.begin(), targets_.end(), [](const PaintedTarget& a, const PaintedTarget& b) { return a.centre.x() < b.centre.x(); });
  for (const PaintedTarget& target : targets_) reach_m_ = std::max(reach_m_, target.side_m / std::numbers::sqrt2);
}

void TargetPaint::Apply(const Hit& hit, Surface& surface) const {
  if (targets_.empty()) return;
  const float width = SurfaceFootprint(hit);
  const double reach_m = reach_m_ + std::min(static_cast<double>(width), kWidestPixel_m);
  const Eigen::Vector2d at = hit.position.head<2>().cast<double>();
  auto target = std::lower_bound(targets_.begin(), targets_.end(), at.x() - reach_m,
                                 [](const PaintedTarget& one, double east_m) { return one.centre.x() < east_m; });
  for (; target != targets_.end() && target->centre.x() <= at.x() + reach_m; ++target) {
    const Eigen::Vector2d from_centre = at - target->centre;
    if (std::abs(from_centre.y()) > reach_m) continue;
    const double cosine = std::cos(target->yaw_rad), sine = std::sin(target->yaw_rad);
    const auto x = static_cast<float>(cosine * from_centre.x() + sine * from_centre.y());
    const auto y = static_cast<float>(cosine * from_centre.y() - sine * from_centre.x());
    const auto half = static_cast<float>(0.5 * target->side_m);
    const float covered = Bar(x, -half, half, width) * Bar(y, -half, half, width);
    if (covered <= 0.0F) continue;
    const float sign = target->pattern == TargetPattern::kFourFields ? MeanSign(x, width) * MeanSign(y, width) : -MeanSign(y, width);
    const float white = 0.5F * (1.0F + sign);
    const Eigen::Vector3f paint = Eigen::Vector3f::Constant(target->black + (target->white - target->black) * white);
    surface.albedo += covered * (paint - surface.albedo);
    surface.mirror_share *= 1.0F - covered;
  }
}

}  // namespace skyquilt::simulate
