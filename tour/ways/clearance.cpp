#include "tour/ways/clearance.h"

#include <algorithm>

namespace skyquilt::tour {
namespace {

// Longer pieces are halved unseen: their discs would hold too many cells.
constexpr double kLongestPiece_m = 1.0;
constexpr double kMostPiecesAcross = 4000.0;
constexpr double kShortestPiece_m = 0.02;
constexpr double kTolerance_m = 0.25;  // barriers may be this much too high
constexpr double kShortestCheck_m = 0.005;

double LongestPiece(const Heights& heights) {
  return std::max(kLongestPiece_m, heights.box().sizes().norm() / kMostPiecesAcross);
}

}  // namespace

std::vector<Barrier> BarriersAlong(const PlanLine& line, const Heights& heights, const std::function<double(double length_m)>& base_z) {
  std::vector<Barrier> barriers;
  const double longest = LongestPiece(heights);
  const std::function<void(double, double)> visit = [&](double from, double to) {
    const double half = (to - from) / 2.0;
    const Eigen::Vector2d x = line.At(from + half);
    if (heights.IsFar(x.x(), x.y(), kWayClearance_m + half)) {
      barriers.push_back({from, to, Heights::kNothing});
      return;
    }
    if (to - from <= longest) {
      const double z = heights.Dilated(x.x(), x.y(), kWayClearance_m, half);
      const bool good = z <= std::min(base_z(from), base_z(to)) || to - from <= kShortestPiece_m ||
                        z - heights.Dilated(x.x(), x.y(), kWayClearance_m) <= kTolerance_m;
      if (good) {
        barriers.push_back({from, to, z});
        return;
      }
    }
    visit(from, from + half);
    visit(from + half, to);
  };
  if (line.Length() > 0.0) visit(0.0, line.Length());
  return barriers;
}

bool KeepsClear(const PlanLine& line, const Heights& heights, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double longest = LongestPiece(heights);
  const std::function<bool(double, double, double, double)> check = [&](double a, double z_a, double b, double z_b) {
    const double half = (b - a) / 2.0;
    const Eigen::Vector2d x = line.At(a + half);
    if (heights.IsFar(x.x(), x.y(), kWayClearance_m + half)) return true;
    if (b - a <= longest) {
      if (heights.Dilated(x.x(), x.y(), kWayClearance_m, half) <= std::min(z_a, z_b)) return true;
      if (b - a <= kShortestCheck_m || heights.Dilated(x.x(), x.y(), kWayClearance_m) > (z_a + z_b) / 2.0) return false;
    }
    const double middle = (z_a + z_b) / 2.0;
    return check(a, z_a, a + half, middle) && check(a + half, middle, b, z_b);
  };
  return check(from.x(), from.y(), to.x(), to.y());
}

}  // namespace skyquilt::tour
