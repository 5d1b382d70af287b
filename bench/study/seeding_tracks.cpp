#include "bench/study/seeding_tracks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "prepare/poses/pairs.h"
#include "simulate/flight.h"

namespace skyquilt::bench {
namespace {

using prepare::poses::PhotoPlace;

// Random numbers of features and of matches do not depend on each other.
constexpr uint64_t kFeatureStream = 71, kMatchStream = 72;

prepare::poses::SeedPhoto TaggedPhoto(const simulate::PhotoPlan& plan, uint32_t image_id, const geo::EnuFrame& frame) {
  prepare::poses::SeedPhoto photo;
  photo.image_id = image_id;
  photo.camera_id = 1;
  photo.name = plan.name;
  if (plan.position_tagged) {
    photo.gps = frame.GeodeticFromEnu(plan.tagged_position);
    photo.relative_altitude_m = plan.relative_altitude_m;
  }
  if (plan.tagged_gimbal) {
    photo.yaw_deg = plan.tagged_gimbal->yaw_deg;
    photo.pitch_deg = plan.tagged_gimbal->pitch_deg;
    photo.roll_deg = plan.tagged_gimbal->roll_deg;
  }
  return photo;
}

// Where the photos look by their tags, as `prepare` finds it (prepare/poses/photo_places.h) from files.
std::vector<std::optional<PhotoPlace>> TaggedPlaces(const std::vector<simulate::PhotoPlan>& photos, double height_m) {
  std::vector<std::optional<PhotoPlace>> places;
  for (const simulate::PhotoPlan& photo : photos) {
    if (!photo.position_tagged) {
      places.emplace_back();
      continue;
    }
    PhotoPlace place;
    place.camera = photo.tagged_position.head<2>();
    place.target = place.camera;
    Eigen::Vector3d axis = -Eigen::Vector3d::UnitZ();
    if (photo.tagged_gimbal) {
      const simulate::GimbalAngles& angles = *photo.tagged_gimbal;
      axis = simulate::PoseFromGimbal(Eigen::Vector3d::Zero(), angles.yaw_deg, angles.pitch_deg, angles.roll_deg).rotation.conjugate() *
             Eigen::Vector3d::UnitZ();
    }
    constexpr double kLeastDown = 0.5;  // nearer to the horizon the middle of the photo is too far away to be matched
    place.target += photo.relative_altitude_m / std::max(-axis.z(), kLeastDown) * axis.head<2>();
    place.view = height_m * axis;
    places.emplace_back(place);
  }
  return places;
}

double MedianHeight(const std::vector<simulate::PhotoPlan>& photos) {
  std::vector<double> heights;
  heights.reserve(photos.size());
  for (const simulate::PhotoPlan& photo : photos) heights.push_back(photo.relative_altitude_m);
  return heights.empty() ? 0.0 : base::Median(std::move(heights));
}

// Adds features to the photos. Returns the index of the point of every feature, per photo, ascending.
std::vector<std::vector<uint32_t>> AddFeatures(const camera::Camera& camera, const std::vector<simulate::PhotoPlan>& photos,
                                               const std::vector<survey::ColmapPoint>& points, const TrackErrors& errors,
                                               prepare::poses::SeedInput* input) {
  base::Random random(errors.seed, kFeatureStream);
  std::vector<std::vector<uint32_t>> point_of(photos.size());
  for (uint32_t p = 0; p < points.size(); ++p) {
    for (const uint32_t id : points[p].image_ids) {
      if (random.UniformDouble() >= errors.seen_share) continue;
      const auto pixel = camera.ImgFromCam(photos[id - 1].cam_from_enu * points[p].x_in_world);
      if (!pixel) continue;
      const double noise_x = errors.noise_px * random.Normal(), noise_y = errors.noise_px * random.Normal();
      input->photos[id - 1].features.push_back((*pixel + Eigen::Vector2d(noise_x, noise_y)).cast<float>());
      point_of[id - 1].push_back(p);
    }
  }
  return point_of;
}

// The features of the points that both photos show. Their lists of points ascend.
prepare::poses::PairMatches MatchPair(uint32_t a, uint32_t b, const std::vector<std::vector<uint32_t>>& point_of) {
  prepare::poses::PairMatches pair{a + 1, b + 1, {}};
  const std::vector<uint32_t>&in_a = point_of[a], &in_b = point_of[b];
  for (size_t i = 0, j = 0; i < in_a.size() && j < in_b.size();) {
    if (in_a[i] == in_b[j]) {
      pair.features.push_back({static_cast<uint32_t>(i++), static_cast<uint32_t>(j++)});
    } else if (in_a[i] < in_b[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  return pair;
}

}  // namespace

SimulatedTracks MakeTracks(const camera::Camera& camera, const std::vector<simulate::PhotoPlan>& photos,
                           const std::vector<survey::ColmapPoint>& points, const geo::EnuFrame& frame, const TrackErrors& errors) {
  SimulatedTracks made;
  made.truth.height_m = MedianHeight(photos);
  for (uint32_t i = 0; i < photos.size(); ++i) {
    made.input.photos.push_back(TaggedPhoto(photos[i], i + 1, frame));
    made.truth.photos.push_back({.name = photos[i].name, .cam_from_enu = photos[i].cam_from_enu, .focal_px = camera.FocalX()});
  }
  prepare::poses::SeedLens lens{.camera = camera};
  for (size_t i = 0; i < (camera::HasOneFocalLength(camera.model) ? 1U : 2U); ++i) lens.camera.params[i] *= 1.0 + errors.focal_share;
  made.input.cameras.emplace(1U, std::move(lens));

  const std::vector<std::vector<uint32_t>> point_of = AddFeatures(camera, photos, points, errors, &made.input);
  for (const std::vector<uint32_t>& of_photo : point_of) made.n_features += of_photo.size();
  base::Random random(errors.seed, kMatchStream);
  for (const auto& [a, b] : prepare::poses::PairsInSpace(TaggedPlaces(photos, made.truth.height_m), prepare::poses::PairRules())) {
    base::ThrowIfCancelled();
    prepare::poses::PairMatches pair = MatchPair(a, b, point_of);
    for (auto& match : pair.features) {
      if (random.UniformDouble() >= errors.wrong_share) continue;
      match[1] = random.Below(static_cast<uint32_t>(point_of[b].size()));
      ++made.n_wrong;
    }
    made.n_matches += pair.features.size();
    if (!pair.features.empty()) made.input.pairs.push_back(std::move(pair));
  }
  return made;
}

}  // namespace skyquilt::bench
