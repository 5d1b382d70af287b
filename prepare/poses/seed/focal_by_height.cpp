#include "prepare/poses/seed/focal_by_height.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "prepare/bundle/adjusted_lens.h"
#include "prepare/poses/seed/seed_survey.h"

namespace skyquilt::prepare::poses {
namespace {

// To begin with, times the guessed focal length: drones have 0.5 to 1.2 times the longer side, zoom lenses more.
constexpr double kTriedFactors[] = {1.0, 0.65, 1.6, 0.4, 2.5, 5.0};

SeedInput WithFocal(const SeedInput& input, double factor) {
  SeedInput scaled = input;
  for (auto& [id, lens] : scaled.cameras) lens = ScaledFocal(lens, factor);
  return scaled;
}

// Of the cameras above the ground, with these focal lengths; nothing when positions, directions and matches do not agree.
std::optional<double> HeightByMatches(const SeedInput& input) {
  SeedSurvey survey;
  std::string reason;
  if (!MakeSeedSurvey(input, &survey, &reason)) return std::nullopt;
  const std::vector<SeedStart> starts = FindStarts(survey, &reason);
  return starts.empty() || !(starts.front().height_m > 0.0) ? std::nullopt : std::optional(starts.front().height_m);
}

// By how much the tagged positions are farther apart, seen from above, than those of the model, which features may have shrunk; 1 when unknown.
double ScaleByTags(const SeedInput& input, const survey::ColmapModel& model) {
  std::unordered_map<uint32_t, geo::Geodetic> tag_of;
  for (const SeedPhoto& photo : input.photos) {
    if (photo.gps) tag_of.emplace(photo.image_id, geo::Geodetic{photo.gps->latitude_deg, photo.gps->longitude_deg, 0.0});
  }
  if (tag_of.empty()) return 1.0;
  const geo::EnuFrame frame(tag_of.begin()->second);
  std::vector<Eigen::Vector2d> tagged, found;
  for (const survey::ColmapImage& image : model.images) {
    const auto tag = tag_of.find(image.id);
    if (tag == tag_of.end()) continue;
    tagged.emplace_back(frame.EnuFromGeodetic(tag->second).head<2>());
    found.emplace_back(image.cam_from_world.OriginInSource().head<2>());
  }
  const auto spread = [](const std::vector<Eigen::Vector2d>& places) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& place : places) mean += place / static_cast<double>(places.size());
    double sum = 0.0;
    for (const Eigen::Vector2d& place : places) sum += (place - mean).squaredNorm();
    return std::sqrt(sum / static_cast<double>(std::max<size_t>(1, places.size())));
  };
  constexpr double kLeast_m = 1.0;
  return spread(found) > kLeast_m && spread(tagged) > kLeast_m ? spread(tagged) / spread(found) : 1.0;
}

}  // namespace

std::optional<double> FocalFactorByHeight(const SeedInput& input) {
  std::vector<double> tagged;
  for (const SeedPhoto& photo : input.photos) {
    if (photo.relative_altitude_m && *photo.relative_altitude_m >= kLeastAltitude_m) tagged.push_back(*photo.relative_altitude_m);
  }
  if (2 * tagged.size() <= input.photos.size()) return std::nullopt;
  const double tagged_m = base::Median(std::move(tagged));
  for (const double first : kTriedFactors) {
    double factor = first;
    // For cameras that look straight down one step is exact, for others it is not.
    constexpr int kSteps = 4;
    for (int step = 0; step < kSteps; ++step) {
      const std::optional<double> found_m = HeightByMatches(WithFocal(input, factor));
      if (!found_m) break;
      const double ratio = tagged_m / *found_m;
      constexpr double kArrivedRatio = 0.02;
      if (std::abs(std::log(ratio)) < kArrivedRatio) return factor;
      factor *= ratio;
      // Shorter and longer ones are no lenses of drones.
      constexpr double kShortest = 0.1, kLongest = 20.0;
      if (!(factor > kShortest && factor < kLongest)) break;
    }
  }
  return std::nullopt;
}

SeedLens ScaledFocal(const SeedLens& lens, double factor) {
  // Smaller than what is known of it: features weigh so much more than one number that a larger one would not hold it.
  constexpr double kSigma = 0.02;
  SeedLens scaled = lens;
  scaled.focal_is_known = true;
  scaled.focal_sigma = kSigma;
  if (std::optional<bundle::Lens> numbers = bundle::LensOf(lens.camera)) {
    (*numbers)[0] *= factor;
    scaled.camera = bundle::CameraOf(*numbers, lens.camera);
  }
  return scaled;
}

HeightAboveTakeOff HeightsInModel(const SeedInput& input, const survey::ColmapModel& model) {
  const double scale = ScaleByTags(input, model);
  std::unordered_map<uint32_t, std::vector<double>> seen_z;
  for (const survey::ColmapPoint& point : model.points) {
    for (const uint32_t id : point.image_ids) seen_z[id].push_back(point.x_in_world.z());
  }
  std::unordered_map<uint32_t, double> tagged_of;
  for (const SeedPhoto& photo : input.photos) {
    if (photo.relative_altitude_m) tagged_of.emplace(photo.image_id, *photo.relative_altitude_m);
  }
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> found, tagged;
  for (const survey::ColmapImage& image : model.images) {
    const auto z = seen_z.find(image.id);
    const auto tag = tagged_of.find(image.id);
    found.push_back(z == seen_z.end() ? kUnknown : scale * (image.cam_from_world.OriginInSource().z() - base::Median(z->second)));
    tagged.push_back(tag == tagged_of.end() ? kUnknown : tag->second);
  }
  return CompareHeights(found, tagged);
}

}  // namespace skyquilt::prepare::poses
