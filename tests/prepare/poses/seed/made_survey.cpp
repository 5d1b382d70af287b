#include "tests/prepare/poses/seed/made_survey.h"

#include <cmath>
#include <map>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "prepare/poses/seed/seed_rotation.h"

namespace skyquilt::test {
namespace {

double Ground(double x, double y, double relief_m) {
  return relief_m * std::sin(0.05 * x + 0.4) * std::cos(0.04 * y);
}

}  // namespace

MadeSurvey MakeSurvey(const SurveyPlan& plan) {
  MadeSurvey made;
  base::Random random(plan.seed);
  for (int c = 0; c < plan.cameras; ++c) {
    const double f = 1250.0 - 150.0 * c;
    made.cameras.push_back({camera::CameraModel::kOpencv, 1600, 1200, {f, f, 800.0, 600.0, -0.03, 0.01, 3e-4, -2e-4}});
    camera::Camera initial = made.cameras.back();
    const double guess = f * (1.0 + plan.focal_error);
    initial.params = {guess, guess, 800.0, 600.0, 0.0, 0.0, 0.0, 0.0};
    made.input.cameras[static_cast<uint32_t>(c + 1)] = {initial, true};
  }
  const geo::EnuFrame frame({47.3, 8.5, 500.0});
  const int n = plan.strips * plan.per_strip;
  std::vector<Eigen::Vector3d> centres;
  for (int i = 0; i < n; ++i) {
    const int strip = i / plan.per_strip, k = i % plan.per_strip;
    const bool back = strip % 2 == 1;
    const double x = plan.along_m * (back ? plan.per_strip - 1 - k : k);
    const double centre_z = plan.height_m + random.Normal(),
                 centre_y = plan.across_m * strip + (2 * strip < plan.strips ? 0.0 : plan.gap_m) + random.Normal(), centre_x = x + random.Normal();
    const Eigen::Vector3d centre(centre_x, centre_y, centre_z);
    const double roll = plan.tilt_noise_deg * random.Normal(), pitch = plan.pitch_deg + plan.tilt_noise_deg * random.Normal();
    const Eigen::Vector3d angles((back ? 270.0 : 90.0) + plan.tilt_noise_deg * random.Normal(), pitch, roll);
    geo::Rigid3d pose;
    pose.rotation = prepare::poses::RotationFromAngles(angles.x(), angles.y(), angles.z());
    pose.translation = -(pose.rotation * centre);
    made.cam_from_enu.push_back(pose);
    made.angles_deg.push_back(angles);
    centres.push_back(centre);
    prepare::poses::SeedPhoto photo;
    photo.image_id = static_cast<uint32_t>(i + 1);
    photo.camera_id = static_cast<uint32_t>(i % plan.cameras + 1);
    photo.name = "photo_" + std::to_string(100 + i) + ".jpg";
    const double error_z = plan.gps_height_noise_m * random.Normal(), error_y = plan.gps_noise_m * random.Normal(),
                 error_x = plan.gps_noise_m * random.Normal();
    const Eigen::Vector3d error(error_x, error_y, error_z);
    photo.gps = frame.GeodeticFromEnu(centre + error);
    if (plan.gimbal_tags) {
      photo.yaw_deg = angles.x() + plan.angle_noise_deg * random.Normal();
      photo.pitch_deg = angles.y() + plan.angle_noise_deg * random.Normal();
      photo.roll_deg = angles.z() + plan.angle_noise_deg * random.Normal();
    }
    made.input.photos.push_back(std::move(photo));
  }
  // Enough points that every photo shows about as many as planned.
  const double width_m = 1600.0 / 1250.0 * plan.height_m, margin_m = 2.0 * width_m;
  const double size_x = plan.along_m * (plan.per_strip - 1) + 2.0 * margin_m,
               size_y = plan.across_m * (plan.strips - 1) + plan.gap_m + 2.0 * margin_m;
  const auto n_points = static_cast<int>(plan.points_per_photo * size_x * size_y / (0.75 * width_m * width_m));
  std::vector<std::map<int, uint32_t>> feature_of(static_cast<size_t>(n));
  made.points.resize(feature_of.size());
  for (int p = 0; p < n_points; ++p) {
    const double x = random.Uniform(-margin_m, size_x - margin_m), y = random.Uniform(-margin_m, size_y - margin_m);
    const Eigen::Vector3d point(x, y, Ground(x, y, plan.relief_m));
    for (size_t i = 0; i < feature_of.size(); ++i) {
      prepare::poses::SeedPhoto& photo = made.input.photos[i];
      const camera::Camera& camera = made.cameras[photo.camera_id - 1];
      const auto pixel = camera.ImgFromCam(made.cam_from_enu[i] * point);
      if (!pixel || pixel->x() < 0.0 || pixel->y() < 0.0 || pixel->x() > camera.width || pixel->y() > camera.height) continue;
      feature_of[i][p] = static_cast<uint32_t>(photo.features.size());
      made.points[i].push_back(p);
      const double noise_y = plan.pixel_noise_px * random.Normal(), noise_x = plan.pixel_noise_px * random.Normal();
      const Eigen::Vector2d noise(noise_x, noise_y);
      photo.features.push_back((*pixel + noise).cast<float>());
    }
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(n); ++i) {
    for (uint32_t j = i + 1; j < static_cast<uint32_t>(n); ++j) {
      if ((centres[i] - centres[j]).norm() > plan.reach_m) {
        if (plan.chance_matches == 0) continue;
        prepare::poses::PairMatches pair{i + 1, j + 1, {}};
        const auto any_of = [&](uint32_t photo) { return random.Below(static_cast<uint32_t>(made.input.photos[photo].features.size())); };
        for (int k = 0; k < plan.chance_matches; ++k) pair.features.push_back({any_of(i), any_of(j)});
        made.input.pairs.push_back(std::move(pair));
        continue;
      }
      prepare::poses::PairMatches pair{i + 1, j + 1, {}};
      for (const auto& [p, feature] : feature_of[i]) {
        const auto other = feature_of[j].find(p);
        if (other == feature_of[j].end()) continue;
        uint32_t match = other->second;
        if (random.UniformDouble() < plan.wrong_matches) match = random.Below(static_cast<uint32_t>(made.input.photos[j].features.size()));
        pair.features.push_back({feature, match});
      }
      if (!pair.features.empty()) made.input.pairs.push_back(std::move(pair));
    }
  }
  return made;
}

}  // namespace skyquilt::test
