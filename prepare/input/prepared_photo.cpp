#include "prepare/input/prepared_photo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prepare/input/tag_accuracy.h"

namespace skyquilt::prepare::input {

PreparedPhoto PreparePhoto(const PhotoFile& file, size_t image, const geo::Rigid3d& cam_from_model) {
  const survey::PhotoTags& tags = file.tags;
  const TagAccuracy accuracy = AccuracyOf(tags);
  PreparedPhoto photo{.file = file,
                      .image = image,
                      .cam_from_model = cam_from_model,
                      .gps = tags.gps,
                      .rtk = tags.rtk,
                      .horizontal_sigma_m = accuracy.horizontal_m,
                      .vertical_sigma_m = accuracy.vertical_m};
  if (tags.gimbal_pitch_deg) photo.up_in_cam = UpInCamera(*tags.gimbal_pitch_deg, tags.gimbal_roll_deg.value_or(0.0));
  return photo;
}

Eigen::Vector3d UpInCamera(double pitch_deg, double roll_deg) {
  const double pitch = pitch_deg * std::numbers::pi / 180.0;
  const double roll = roll_deg * std::numbers::pi / 180.0;
  return {-std::cos(pitch) * std::sin(roll), -std::cos(pitch) * std::cos(roll), std::sin(pitch)};
}

std::vector<int> SplitFlights(const std::vector<PreparedPhoto>& photos, double gap_s) {
  const auto time_s = [&](size_t i) { return *photos[i].file.tags.capture_time_s; };
  std::vector<size_t> timed;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (photos[i].file.tags.capture_time_s) timed.push_back(i);
  }
  std::stable_sort(timed.begin(), timed.end(), [&](size_t a, size_t b) { return time_s(a) < time_s(b); });
  std::vector<int> flight(photos.size(), -1);
  int current = 0;
  for (size_t k = 0; k < timed.size(); ++k) {
    if (k > 0 && time_s(timed[k]) - time_s(timed[k - 1]) > gap_s) ++current;
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
