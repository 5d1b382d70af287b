#include "tour/propose/relief.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::tour {
namespace {

constexpr int kWindowsAcross = 12;  // along the longer side
constexpr double kLeastWindow_m = 6.0;
constexpr double kLowShare = 0.05, kHighShare = 0.95;
constexpr double kLeastKnown = 0.5;
constexpr double kLeastRelief = 0.05;  // of the window's side: flatter places are nothing to look at
constexpr double kApart = 2.0;         // windows

}  // namespace

std::vector<ReliefPlace> FindRelief(const Heights& heights, int most, const std::vector<Eigen::Vector2d>& taken) {
  const Eigen::Vector2d size = heights.box().sizes();
  const double window_m = std::max(kLeastWindow_m, size.maxCoeff() / kWindowsAcross);
  const Eigen::Vector2d min = heights.box().min();
  std::vector<ReliefPlace> places;
  std::vector<double> z;
  // Windows overlap by half.
  for (double y = min.y() + 0.5 * window_m; y + 1.5 * window_m <= heights.box().max().y(); y += 0.5 * window_m) {
    for (double x = min.x() + 0.5 * window_m; x + 1.5 * window_m <= heights.box().max().x(); x += 0.5 * window_m) {
      const auto cell = [](double length, double step) { return static_cast<int>(std::floor(length / step)); };
      const int first_column = cell(x - min.x(), heights.cell_m().x()), last_column = cell(x + window_m - min.x(), heights.cell_m().x());
      const int first_row = cell(y - min.y(), heights.cell_m().y()), last_row = cell(y + window_m - min.y(), heights.cell_m().y());
      z.clear();
      int cells = 0;
      for (int row = first_row; row <= std::min(last_row, heights.rows() - 1); ++row) {
        for (int column = first_column; column <= std::min(last_column, heights.columns() - 1); ++column) {
          ++cells;
          if (const double top = heights.Top(column, row); !std::isnan(top)) z.push_back(top);
        }
      }
      if (static_cast<double>(z.size()) < kLeastKnown * cells || z.empty()) continue;
      const double low = base::NearestRankQuantile(z, kLowShare), high = base::NearestRankQuantile(z, kHighShare);
      if (high - low < kLeastRelief * window_m) continue;
      places.push_back({.low_enu = {x + 0.5 * window_m, y + 0.5 * window_m, low}, .size_m = window_m, .relief_m = high - low});
    }
  }
  std::stable_sort(places.begin(), places.end(), [](const ReliefPlace& a, const ReliefPlace& b) { return a.relief_m > b.relief_m; });
  std::vector<ReliefPlace> chosen;
  std::vector<Eigen::Vector2d> far_from = taken;
  for (const ReliefPlace& place : places) {
    if (static_cast<int>(chosen.size()) >= most) break;
    const Eigen::Vector2d here = place.low_enu.head<2>();
    const bool apart =
        std::all_of(far_from.begin(), far_from.end(), [&](const Eigen::Vector2d& other) { return (other - here).norm() >= kApart * window_m; });
    if (!apart) continue;
    far_from.push_back(here);
    chosen.push_back(place);
  }
  return chosen;
}

}  // namespace skyquilt::tour
