#include "prepare/poses/focal_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/log.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr double kGuessFactor = 1.2;
constexpr double kFilm_mm = 35.0;  // what COLMAP takes as the longer side of film of 35 mm

double LongerSide(const camera::Camera& camera) {
  return std::max(camera.width, camera.height);
}

}  // namespace

std::string FarFocal::Text() const {
  return fmt::format("a focal length of {:.0f} px for {} photos, whose tags say {:.0f} px", found_px, n_photos, tagged_px);
}

bool IsGuessedFocal(const camera::Camera& camera) {
  const double guess = kGuessFactor * LongerSide(camera);
  return std::abs(camera.FocalX() - guess) < 1e-6 * guess;
}

std::optional<double> TaggedFocalPx(const survey::PhotoTags& tags, int width, int height) {
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

void CorrectFocals(const std::vector<input::PhotoFile>& photos, survey::ColmapDatabase& database) {
  std::map<std::string, const input::PhotoFile*> photo_of_name;
  for (const input::PhotoFile& photo : photos) photo_of_name.emplace(photo.name, &photo);
  struct OfCamera {
    std::vector<double> focals_mm;
    size_t n_photos = 0;
    bool converted = false;
  };
  std::map<uint32_t, OfCamera> tags;
  for (const survey::DatabaseImage& image : database.ReadImages()) {
    const auto photo = photo_of_name.find(image.name);
    if (photo == photo_of_name.end()) continue;
    OfCamera& of_camera = tags[image.camera_id];
    ++of_camera.n_photos;
    of_camera.converted = of_camera.converted || photo->second->converted;
    if (photo->second->tags.focal_length_35mm) of_camera.focals_mm.push_back(*photo->second->tags.focal_length_35mm);
  }
  for (const auto& [id, camera] : database.ReadCameras()) {
    const auto found = tags.find(id);
    // Cameras without a focal length are not COLMAP's.
    if (found == tags.end() || !(camera.FocalX() > 0.0)) continue;
    OfCamera& of_camera = found->second;
    const double stated_mm = camera.FocalX() / LongerSide(camera) * kFilm_mm;
    const bool plausible = survey::IsPlausibleFocal35(stated_mm);
    if (plausible && !of_camera.converted) continue;
    std::vector<double>& focals_mm = of_camera.focals_mm;
    const auto middle = focals_mm.begin() + static_cast<std::ptrdiff_t>(focals_mm.size() / 2);
    if (!focals_mm.empty()) std::nth_element(focals_mm.begin(), middle, focals_mm.end());
    const double focal_px = LongerSide(camera) * (focals_mm.empty() ? kGuessFactor : *middle / kFilm_mm);
    if (!plausible) {
      base::LogWarning(
          "the tags of {} photos say a focal length of {:.3g} mm for film of 35 mm (FocalLengthIn35mmFilm, or FocalLength with the size of the "
          "sensor), "
          "which no lens has: it is not used, and poses are searched for from {:.0f} px, {}",
          of_camera.n_photos, stated_mm, focal_px, focals_mm.empty() ? "a guess" : "which other photos of the same camera say");
    }
    database.SetFocal(id, focal_px, !focals_mm.empty());
  }
}

bool AnyFocalMoved(const std::map<uint32_t, double>& from_px, const survey::ColmapModel& model) {
  return std::any_of(from_px.begin(), from_px.end(), [&](const auto& from) {
    const auto camera = model.cameras.find(from.first);
    return camera != model.cameras.end() && std::abs(std::log(camera->second.FocalX() / from.second)) > kUsualFocalError;
  });
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

}  // namespace skyquilt::prepare::poses
