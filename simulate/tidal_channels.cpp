#include "simulate/tidal_channels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"
#include "simulate/terrain.h"

namespace skyquilt::simulate {

using Eigen::Vector2d;

TidalChannels::TidalChannels(const Vector2d& min, const Vector2d& max, double amplitude_m, uint32_t seed)
    : amplitude_m_(amplitude_m), seed_(seed), min_(min), max_(max) {
  const double start = min.x() + (0.45 + 0.12 * static_cast<double>(HashUnit(1, 2, seed))) * (max.x() - min.x());
  Grow({start, min.y() - 95.0}, 0.5 * std::numbers::pi, 8.5, 1.7, 1.5 * (max.y() - min.y()), 0, 1);
}

void TidalChannels::Grow(Vector2d from, double heading_rad, double half_width, double depth, double length, int order, uint32_t key) {
  constexpr double kStep = 6.0;
  const int n_steps = static_cast<int>(length / kStep);
  const double mean_heading = heading_rad;
  double side = HashUnit(static_cast<int>(key), 5, seed_) < 0.5F ? -1.0 : 1.0;
  int next_branch = 2 + static_cast<int>(HashCell(static_cast<int>(key), 6, seed_) % 4U);
  for (int i = 0; i < n_steps; ++i) {
    const double left = 1.0 - static_cast<double>(i) / n_steps;
    const double left_after = 1.0 - static_cast<double>(i + 1) / n_steps;
    const double swing = static_cast<double>(ValueNoise(static_cast<float>(i) / 6.0F, static_cast<float>(key), seed_));
    const double heading = mean_heading + (1.1 + 0.1 * order) * swing;
    const Vector2d to = from + kStep * Vector2d(std::cos(heading), std::sin(heading));
    // Channels become narrower and shallower towards their ends.
    const auto Taper = [](double share) { return 0.25 + 0.75 * share; };
    reaches_.push_back({from, to, half_width * Taper(left), half_width * Taper(left_after), depth * std::sqrt(left), depth * std::sqrt(left_after)});
    from = to;
    if (i == next_branch && order < 4 && left > 0.12) {
      const double angle = heading + side * (0.7 + 0.5 * static_cast<double>(HashUnit(i, 7, seed_ + key)));
      Grow(from, angle, 0.55 * half_width * Taper(left), 0.8 * depth * std::sqrt(left),
           length * (0.30 + 0.30 * static_cast<double>(HashUnit(i, 8, seed_ + key))), order + 1, key * 7U + static_cast<uint32_t>(i));
      side = -side;
      next_branch += 2 + static_cast<int>(HashCell(i, 9, seed_ + key) % 4U);
    }
  }
}

double TidalChannels::Height(double east, double north) const {
  const Vector2d p(east, north);
  double carved = 0.0;
  for (const Segment& reach : reaches_) {
    const Vector2d ab = reach.b - reach.a;
    const double s = std::clamp((p - reach.a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    const double half_width = reach.half_width_a + s * (reach.half_width_b - reach.half_width_a);
    const double away = (p - reach.a - s * ab).norm() / half_width;
    // Gentle banks extend beyond the nominal width.
    if (away > 2.2) continue;
    const double profile = 1.0 - static_cast<double>(Smoothstep(0.35F, 2.2F, static_cast<float>(away)));
    carved = std::max(carved, profile * (reach.depth_a + s * (reach.depth_b - reach.depth_a)));
  }
  const auto x = static_cast<float>(east);
  const auto y = static_cast<float>(north);
  const double banks = amplitude_m_ * static_cast<double>(FractalNoise(x, y, {70.0F, 4, 0.45F}, seed_ + 40U, 0.0F));
  return banks - carved;
}

}  // namespace skyquilt::simulate
