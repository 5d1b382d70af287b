#include "prepare/control/fit/tag_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/order_statistics.h"
#include "prepare/bundle/robust.h"

namespace skyquilt::prepare::control {
namespace {

struct TaggedPhoto {
  uint32_t photo = 0;
  Eigen::Vector3d tag = Eigen::Vector3d::Zero();         // ENU; z of the photo when the tag has no height
  Eigen::Vector3d difference = Eigen::Vector3d::Zero();  // tag less photo; z is NaN when the tag has no height
};

// In the order of time where it is known.
std::vector<TaggedPhoto> TaggedPhotos(const std::vector<input::PreparedPhoto>& photos, const geo::EnuFrame& frame,
                                      const bundle::BundleProblem& bundle) {
  std::vector<size_t> order(photos.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const bool timed =
      std::all_of(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.file.tags.capture_time_s.has_value(); });
  const auto time_s = [&](size_t i) { return *photos[i].file.tags.capture_time_s; };
  if (timed) std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return time_s(a) < time_s(b); });
  std::vector<TaggedPhoto> tagged;
  for (const size_t i : order) {
    if (!photos[i].gps) continue;
    geo::Geodetic place = *photos[i].gps;
    const bool has_height = std::isfinite(place.height_m);
    if (!has_height) place.height_m = frame.origin().height_m;
    TaggedPhoto one;
    one.photo = static_cast<uint32_t>(photos[i].image);
    one.tag = frame.EnuFromGeodetic(place);
    one.difference = one.tag - bundle.photos[one.photo].centre;
    if (!one.tag.allFinite()) continue;
    if (!has_height) {
      one.tag.z() = bundle.photos[one.photo].centre.z();
      one.difference.z() = std::numeric_limits<double>::quiet_NaN();
    }
    tagged.push_back(one);
  }
  return tagged;
}

struct AxisNoise {
  double shift_m = 0.0;
  double sigma_m = std::numeric_limits<double>::infinity();
};

// Infinite when too few tags know the axis.
AxisNoise NoiseOf(const std::vector<TaggedPhoto>& tagged, int axis) {
  // The best receivers; the antenna is not in the camera, and exposure and tag differ in time.
  constexpr double kLeastSigma_m = 0.05;
  std::vector<double> differences;
  for (const TaggedPhoto& one : tagged) {
    if (std::isfinite(one.difference[axis])) differences.push_back(one.difference[axis]);
  }
  AxisNoise noise;
  if (differences.size() < kLeastTags) return noise;
  noise.shift_m = base::Median(differences);
  const double sigma_m = std::max(base::Nmad(differences), kLeastSigma_m);
  bundle::SerialCorrelation correlation;
  for (const double difference : differences) correlation.Add(0, std::clamp(difference - noise.shift_m, -3.0 * sigma_m, 3.0 * sigma_m));
  noise.sigma_m = sigma_m * std::sqrt(correlation.VarianceFactor());
  return noise;
}

}  // namespace

bool UseTagScatter(const std::vector<input::PreparedPhoto>& photos, const geo::EnuFrame& frame, bundle::BundleProblem& bundle,
                   Eigen::Vector3d* shift) {
  const std::vector<TaggedPhoto> tagged = TaggedPhotos(photos, frame, bundle);
  if (tagged.size() < kLeastTags) return false;
  Eigen::Vector3d sigma;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisNoise noise = NoiseOf(tagged, axis);
    // As the cost counts it: what is added to the tag.
    (*shift)[axis] = -noise.shift_m;
    sigma[axis] = noise.sigma_m;
  }
  for (const TaggedPhoto& one : tagged) {
    bundle::BundlePhoto& photo = bundle.photos[one.photo];
    photo.gps = one.tag;
    photo.gps_sigma = sigma;
    if (!std::isfinite(one.difference.z())) photo.gps_sigma.z() = std::numeric_limits<double>::infinity();
  }
  return true;
}

}  // namespace skyquilt::prepare::control
