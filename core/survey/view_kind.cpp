#include "core/survey/view_kind.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/order_statistics.h"

namespace skyquilt::survey {

bool LooksLevel(const Survey& survey, std::span<const int> photos) {
  std::vector<double> steepness;  // sines of the angles
  for (const int index : photos) {
    const Photo& photo = survey.photos[static_cast<size_t>(index)];
    if (!photo.is_test) steepness.push_back(std::abs((photo.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ()).z()));
  }
  return !steepness.empty() && base::UpperMedian(steepness) < std::sin(kLevel_deg * std::numbers::pi / 180.0);
}

bool LooksLevel(const Survey& survey) {
  std::vector<int> all(survey.photos.size());
  std::iota(all.begin(), all.end(), 0);
  return LooksLevel(survey, all);
}

}  // namespace skyquilt::survey
