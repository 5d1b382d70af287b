#include "prepare/georeference/checks/flight_speed.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/base/order_statistics.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr double kLongestLeg = 2.5;  // of the median leg

struct Leg {
  double time_s = 0.0;
  double path_m = 0.0;
};

// Legs from photo to photo, one list per flight, in the order of time.
std::vector<std::vector<Leg>> LegsOfFlights(const survey::Survey& survey) {
  std::map<int, std::vector<const survey::Photo*>> flights;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.time_s && std::isfinite(*photo.time_s)) flights[photo.flight].push_back(&photo);
  }
  std::vector<std::vector<Leg>> all;
  for (auto& [flight, photos] : flights) {
    std::stable_sort(photos.begin(), photos.end(), [](const auto* a, const auto* b) { return *a->time_s < *b->time_s; });
    std::vector<Leg>& legs = all.emplace_back();
    for (size_t i = 1; i < photos.size(); ++i) {
      const Eigen::Vector3d move = photos[i]->cam_from_enu.OriginInSource() - photos[i - 1]->cam_from_enu.OriginInSource();
      legs.push_back({*photos[i]->time_s - *photos[i - 1]->time_s, move.head<2>().norm()});
    }
  }
  return all;
}

// Speeds over all windows of `n_window` legs; over all legs together if there are fewer.
void AddSpeeds(const std::vector<Leg>& run, size_t n_window, std::vector<double>& speeds) {
  n_window = std::min(n_window, run.size());
  for (size_t first = 0; n_window > 0 && first + n_window <= run.size(); ++first) {
    Leg sum;
    for (size_t i = first; i < first + n_window; ++i) {
      sum.time_s += run[i].time_s;
      sum.path_m += run[i].path_m;
    }
    if (sum.time_s > 0.0) speeds.push_back(sum.path_m / sum.time_s);
  }
}

}  // namespace

double SpeedFromPositions(const survey::Survey& survey) {
  const std::vector<std::vector<Leg>> flights = LegsOfFlights(survey);
  std::vector<double> times;
  for (const std::vector<Leg>& legs : flights) {
    for (const Leg& leg : legs) {
      if (leg.time_s > 0.0) times.push_back(leg.time_s);
    }
  }
  if (times.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double median_s = base::Median(times);
  // A fixed number of legs: windows that end when a rounded time is reached would favour times that are rounded up.
  const auto n_window = static_cast<size_t>(std::max(1.0, std::ceil(kStretch_s / median_s)));
  std::vector<double> speeds;
  for (const std::vector<Leg>& legs : flights) {
    std::vector<Leg> run;
    for (const Leg& leg : legs) {
      if (leg.time_s < kLongestLeg * median_s) {
        run.push_back(leg);
        continue;
      }
      AddSpeeds(run, n_window, speeds);
      run.clear();
    }
    AddSpeeds(run, n_window, speeds);
  }
  return base::Median(speeds);
}

}  // namespace skyquilt::prepare::georeference
