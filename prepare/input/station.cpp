#include "prepare/input/station.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prepare/input/tag_accuracy.h"

namespace skyquilt::prepare::input {

Station MakeStation(const std::string& name, const geo::Rigid3d& cam_from_model, const survey::PhotoTags& tags) {
  Station station{.name = name,
                  .cam_from_model = cam_from_model,
                  .gps = tags.gps,
                  .time_s = tags.capture_time_s,
                  .relative_altitude_m = tags.relative_altitude_m,
                  .rtk = tags.rtk};
  const TagAccuracy accuracy = AccuracyOf(tags);
  station.horizontal_sigma_m = accuracy.horizontal_m;
  station.vertical_sigma_m = accuracy.vertical_m;
  station.position_file = tags.position_file;
  if (tags.gimbal_pitch_deg) station.up_in_cam = UpInCamera(*tags.gimbal_pitch_deg, tags.gimbal_roll_deg.value_or(0.0));
  return station;
}

Eigen::Vector3d UpInCamera(double pitch_deg, double roll_deg) {
  const double pitch = pitch_deg * std::numbers::pi / 180.0;
  const double roll = roll_deg * std::numbers::pi / 180.0;
  return {-std::cos(pitch) * std::sin(roll), -std::cos(pitch) * std::cos(roll), std::sin(pitch)};
}

std::vector<int> SplitFlights(const std::vector<Station>& stations, double gap_s) {
  std::vector<size_t> timed;
  for (size_t i = 0; i < stations.size(); ++i) {
    if (stations[i].time_s) timed.push_back(i);
  }
  std::stable_sort(timed.begin(), timed.end(), [&](size_t a, size_t b) { return *stations[a].time_s < *stations[b].time_s; });
  std::vector<int> flight(stations.size(), -1);
  int current = 0;
  for (size_t k = 0; k < timed.size(); ++k) {
    if (k > 0 && *stations[timed[k]].time_s - *stations[timed[k - 1]].time_s > gap_s) ++current;
    flight[timed[k]] = current;
  }
  int before = 0;
  for (int& number : flight) {
    if (number < 0) number = before;
    before = number;
  }
  return flight;
}

int CountFlights(const std::vector<int>& flight) {
  return flight.empty() ? 0 : *std::max_element(flight.begin(), flight.end()) + 1;
}

}  // namespace skyquilt::prepare::input
