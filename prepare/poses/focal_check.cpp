#include "prepare/poses/focal_check.h"

#include <algorithm>
#include <cmath>

#include "core/base/log.h"

namespace skyquilt::prepare {

std::string FarFocal::Text() const {
  return fmt::format("a focal length of {:.0f} px for {} photos, whose tags say {:.0f} px", found_px, n_photos, tagged_px);
}

bool IsGuessedFocal(const camera::Camera& camera) {
  constexpr double kGuessFactor = 1.2;
  const double guess = kGuessFactor * std::max(camera.width, camera.height);
  return std::abs(camera.FocalX() - guess) < 1e-6 * guess;
}

std::optional<double> TaggedFocalPx(const survey::PhotoTags& tags, int width, int height) {
  constexpr double kFilmWidth_mm = 36.0;
  const double longer = std::max(width, height);
  const auto usable = [](const std::optional<double>& value) { return value && std::isfinite(*value) && *value > 0.0; };
  if (usable(tags.calibrated_focal_px)) {
    // Of the photo as the camera took it.
    const int original = std::max(tags.original_width, tags.original_height);
    return *tags.calibrated_focal_px * (original > 0 ? longer / original : 1.0);
  }
  if (usable(tags.focal_length_35mm)) return *tags.focal_length_35mm / kFilmWidth_mm * longer;
  return std::nullopt;
}

std::optional<FarFocal> FindFarFocal(const survey::ColmapModel& model, const std::map<uint32_t, camera::Camera>& tagged) {
  std::map<uint32_t, double> tagged_px;
  for (const auto& [id, camera] : tagged) {
    if (!IsGuessedFocal(camera)) tagged_px.emplace(id, camera.FocalX());
  }
  return FindFocalFarFrom(tagged_px, model);
}

std::optional<FarFocal> FindFocalFarFrom(const std::map<uint32_t, double>& known_px, const survey::ColmapModel& model) {
  std::map<uint32_t, size_t> n_photos;
  for (const survey::ColmapImage& image : model.images) ++n_photos[image.camera_id];
  FarFocal far;
  size_t most = 0;
  for (const auto& [id, n] : n_photos) {
    const auto known = known_px.find(id);
    if (known == known_px.end()) continue;
    const double found_px = model.cameras.at(id).FocalX(), tagged_px = known->second;
    if (found_px >= kShortestFocal * tagged_px && found_px <= kLongestFocal * tagged_px) continue;
    far.n_photos += n;
    if (n <= most) continue;
    most = n;
    far.found_px = found_px;
    far.tagged_px = tagged_px;
  }
  if (static_cast<double>(far.n_photos) <= kMaxFarFocal * static_cast<double>(model.images.size())) return std::nullopt;
  return far;
}

}  // namespace skyquilt::prepare
