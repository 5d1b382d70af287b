#include "surface/texture/chart_directions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace skyquilt::surface {
namespace {

constexpr int kAzimuthBins = 45;      // of 2 degrees each
constexpr double kSteepNormal = 0.5;  // largest |z| of the normal of a facade
constexpr double kUpPreference = 1.1;

}  // namespace

double FacadeAzimuth(const TileGeometry& geometry) {
  constexpr double kRightAngle = std::numbers::pi / 2.0;
  std::array<double, kAzimuthBins> weight{};
  for (size_t t = 0; t < geometry.triangle.size(); ++t) {
    const Eigen::Vector3d& normal = geometry.face_normal[t];
    if (std::abs(normal.z()) > kSteepNormal) continue;
    const double azimuth = std::atan2(normal.y(), normal.x()) / kRightAngle;  // in right angles
    const double within = azimuth - std::floor(azimuth);
    weight[static_cast<size_t>(std::clamp(static_cast<int>(within * kAzimuthBins), 0, kAzimuthBins - 1))] += geometry.area[t];
  }
  const auto at = [&weight](int bin) { return weight[static_cast<size_t>((bin + 2 * kAzimuthBins) % kAzimuthBins)]; };
  int peak = 0;
  double best = 0.0;
  for (int bin = 0; bin < kAzimuthBins; ++bin) {
    const double smooth = at(bin - 1) + 2.0 * at(bin) + at(bin + 1);
    if (smooth > best) {
      best = smooth;
      peak = bin;
    }
  }
  if (!(best > 0.0)) return 0.0;
  double total = 0.0;
  double moment = 0.0;
  for (int step = -2; step <= 2; ++step) {
    total += at(peak + step);
    moment += at(peak + step) * step;
  }
  const double azimuth = (peak + 0.5 + moment / total) / kAzimuthBins;
  return (azimuth - std::floor(azimuth)) * kRightAngle;
}

ChartDirections DirectionsOf(const TileGeometry& geometry) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  ChartDirections directions;
  directions[0] = {z, x, -y};
  directions[1] = {-z, x, y};
  const double first = FacadeAzimuth(geometry);
  for (size_t i = 2; i < directions.size(); ++i) {
    const double azimuth = first + static_cast<double>(i - 2) * std::numbers::pi / 4.0;
    const Eigen::Vector3d out(std::cos(azimuth), std::sin(azimuth), 0.0);
    directions[i] = {out, z.cross(out), -z};
  }
  return directions;
}

int BestDirection(const ChartDirections& directions, const Eigen::Vector3d& normal) {
  int best = 0;
  double best_score = kUpPreference * directions[0].out.dot(normal);
  for (int i = 1; i < kChartDirections; ++i) {
    const double score = directions[static_cast<size_t>(i)].out.dot(normal);
    if (score > best_score) {
      best = i;
      best_score = score;
    }
  }
  return best;
}

}  // namespace skyquilt::surface
