#include "bench/study/thin_survey.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skyquilt::bench {

double TiltDeg(const survey::Photo& photo) {
  const Eigen::Vector3d axis = photo.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  return std::atan2(axis.head<2>().norm(), -axis.z()) * 180.0 / std::numbers::pi;
}

survey::Survey ThinSurvey(survey::Survey survey, const Variant& variant) {
  const auto chosen = [&variant](const survey::Photo& photo) {
    if (TiltDeg(photo) > variant.max_tilt_deg) return false;
    return variant.photo_prefixes.empty() || std::any_of(variant.photo_prefixes.begin(), variant.photo_prefixes.end(),
                                                         [&photo](const std::string& prefix) { return photo.name.starts_with(prefix); });
  };
  std::vector<survey::Photo> kept;
  std::vector<int32_t> new_index;
  int number = 0;
  for (survey::Photo& photo : survey.photos) {
    const bool keep = photo.is_test || (chosen(photo) && number++ % variant.every_nth_photo == 0);
    new_index.push_back(keep ? static_cast<int32_t>(kept.size()) : -1);
    if (keep) kept.push_back(std::move(photo));
  }
  survey.photos = std::move(kept);
  survey.tracks = survey.tracks.Renumbered(new_index);
  survey.kept_tracks = survey.kept_tracks.Renumbered(new_index);
  return survey;
}

}  // namespace skyquilt::bench
