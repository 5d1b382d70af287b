#include "simulate/survey_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/config/options.h"
#include "core/image/normal_image.h"
#include "core/image/srgb.h"
#include "simulate/flights/flight_settings.h"
#include "simulate/model_frame.h"

namespace skyquilt::simulate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFirstPhoto_s = 1777888800.0;  // 2026-05-04 10:00:00 on the camera's clock

// The options as the user gave them.
Json OptionsJson(SimulateOptions options) {
  Json json = Json::object();
  for (const config::Option& option : config::OptionsOf(options)) {
    std::visit([&](const auto* value) { json[option.key] = *value; }, option.value);
  }
  // Surveys look as before there were these options.
  if (options.flight == "survey") {
    json.erase("flight");
    json.erase("photos");
  }
  if (options.tags == "auto") json.erase("tags");
  if (options.lights == "one") {
    json.erase("lights");
    json.erase("lights_every");
  }
  if (!options.marsh) json.erase("marsh");
  if (options.ortho_cell_m == 0.0) json.erase("ortho_cell_m");
  if (options.edge_targets == 0) json.erase("edge_targets");
  if (options.video_fps == 0) json.erase("video_fps");
  if (options.panoramas == 0) {
    json.erase("panoramas");
    json.erase("panorama_width");
  }
  return json;
}

double Rounded(double value, double unit) {
  return std::round(value / unit) * unit;
}

void TagPosition(const PhotoPlan& photo, const geo::EnuFrame& frame, survey::PhotoTags& tags) {
  geo::Geodetic gps = frame.GeodeticFromEnu(photo.tagged_position);
  if (photo.coordinates_swapped) std::swap(gps.latitude_deg, gps.longitude_deg);
  if (photo.tagged_heights == HeightTags::kZero) gps.height_m = 0.0;
  if (photo.tagged_heights == HeightTags::kNone) {
    gps.height_m = std::numeric_limits<double>::quiet_NaN();
  } else {
    tags.absolute_altitude_m = Rounded(gps.height_m, 0.01);
    tags.relative_altitude_m = photo.tagged_heights == HeightTags::kZero ? 0.0 : Rounded(photo.relative_altitude_m, 0.01);
  }
  tags.gps = gps;
}

}  // namespace

image::Image8 Develop(const image::ImageF& rgb_linear, const Development& development) {
  // Table from linear light to 8-bit sRGB, fine enough where sRGB is steepest.
  constexpr size_t kTableSize = 1U << 15U;
  static const std::array<uint8_t, kTableSize + 1> table = [] {
    std::array<uint8_t, kTableSize + 1> srgb{};
    for (size_t i = 0; i <= kTableSize; ++i) {
      srgb[i] = static_cast<uint8_t>(std::lround(255.0F * image::SrgbFromLinear(static_cast<float>(i) / static_cast<float>(kTableSize))));
    }
    return srgb;
  }();
  image::Image8 out(rgb_linear.width, rgb_linear.height, 3);
  std::array<float, 3> scale{};
  for (size_t c = 0; c < scale.size(); ++c) scale[c] = static_cast<float>(development.gain[c]) * kNormalExposure;
  const Eigen::Vector2d& centre = development.principal_point;
  const Eigen::Vector2d farthest = centre.cwiseAbs().cwiseMax((Eigen::Vector2d(out.width, out.height) - centre).cwiseAbs());
  const double log_per_px2 = std::log1p(-development.vignetting) / farthest.squaredNorm();
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const double distance2 = (Eigen::Vector2d(x + 0.5, y + 0.5) - centre).squaredNorm();
      // Exactly 1 when there is no vignetting.
      const auto vignetting = static_cast<float>(std::exp(log_per_px2 * distance2));
      const float* light = rgb_linear.At(x, y);
      uint8_t* stored = out.At(x, y);
      for (size_t c = 0; c < scale.size(); ++c) {
        const float value = std::clamp(light[c] * (vignetting * scale[c]), 0.0F, 1.0F);
        stored[c] = table[static_cast<size_t>(std::lrint(value * static_cast<float>(kTableSize)))];
      }
    }
  }
  return out;
}

survey::PhotoTags MakeTags(const PhotoPlan& photo, const camera::Camera& camera, const geo::EnuFrame& frame) {
  survey::PhotoTags tags;
  if (photo.position_tagged) TagPosition(photo, frame, tags);
  if (photo.tagged_gimbal) {
    tags.gimbal_yaw_deg = Rounded(std::remainder(photo.tagged_gimbal->yaw_deg, 360.0), 0.01);
    tags.gimbal_pitch_deg = Rounded(photo.tagged_gimbal->pitch_deg, 0.01);
    tags.gimbal_roll_deg = Rounded(photo.tagged_gimbal->roll_deg, 0.01);
  }
  tags.speed_mps = photo.tagged_speed_mps;
  if (photo.exposure_tagged) tags.exposure = {photo.exposure_time_s, photo.f_number, photo.iso};
  // A sensor 13.2 mm wide, as on common survey drones.
  tags.focal_length_mm = Rounded(13.2 * camera.FocalX() / camera.width, 0.01);
  tags.focal_length_35mm = std::round(36.0 * camera.FocalX() / camera.width);
  tags.capture_time_s = kFirstPhoto_s + photo.time_s;
  tags.make = "Skyquilt";
  tags.model = "Simulated";
  return tags;
}

void WritePhoto(const std::filesystem::path& folder, const PhotoPlan& photo, const image::Image8& pixels, const camera::Camera& camera,
                const geo::EnuFrame& frame, int jpeg_quality) {
  const std::filesystem::path file = folder / "images" / photo.name;
  image::SaveJpeg(pixels, file, jpeg_quality);
  survey::WritePhotoTags(MakeTags(photo, camera, frame), file);
}

survey::ColmapModel MakeModel(const camera::Camera& camera, const std::vector<PhotoPlan>& photos, std::vector<survey::ColmapPoint> points) {
  survey::ColmapModel model;
  model.cameras[1] = camera;
  for (size_t i = 0; i < photos.size(); ++i) model.images.push_back({static_cast<uint32_t>(i + 1), 1, photos[i].name, photos[i].cam_from_enu});
  model.points = std::move(points);
  return model;
}

void WriteModel(const std::filesystem::path& folder, const survey::ColmapModel& model) {
  std::filesystem::create_directories(folder / "sparse" / "0");
  survey::WriteProjectedColmapBinary(model, folder / "sparse" / "0");
}

void WriteSurfaceTruth(const std::filesystem::path& folder, const PhotoPlan& photo, const SurfaceImages& surfaces) {
  const std::filesystem::path truth = folder / "truth", name = photo.name;
  image::SaveFloatTiff(surfaces.z_depth, truth / "depth" / std::filesystem::path(name).replace_extension(".tiff"));
  image::SaveNormals(surfaces.normals, truth / "normals" / std::filesystem::path(name).replace_extension(".png"));
  WriteClasses(folder, photo, surfaces);
}

void WriteClasses(const std::filesystem::path& folder, const PhotoPlan& photo, const SurfaceImages& surfaces) {
  image::SavePng(surfaces.classes, folder / "truth" / "classes" / std::filesystem::path(photo.name).replace_extension(".png"));
}

void WriteExposureTruth(const std::filesystem::path& folder, const std::vector<PhotoPlan>& photos, const PlaceSpec& place) {
  Json list = Json::array();
  for (const PhotoPlan& photo : photos) {
    list.push_back({{"name", photo.name},
                    {"gain", photo.gain},
                    {"light_rgb", LightRgb(photo)},
                    {"exposure_time_s", photo.exposure_time_s},
                    {"f_number", photo.f_number},
                    {"iso", photo.iso}});
  }
  const Json json = {
      {"about",
       "gain: factor on linear light by the photo's settings, t * ISO / (100 N^2), relative to the median photo; light_rgb: true factors on linear "
       "red, green and blue light relative to normal exposure, including the exposure offset and the brightness errors and colour drift that no tag "
       "records; vignetting: fraction of light lost in the corner farthest from the principal point; the factor is exp(log(1 - vignetting) r^2) "
       "where r is the distance from the principal point, 1 at that corner"},
      {"vignetting", place.vignetting},
      {"photos", list}};
  base::WriteFileAtomically(folder / "truth" / "exposure.json", base::JsonText(json, 1) + "\n");
}

void WriteSummary(const std::filesystem::path& folder, const PlaceSpec& place, const SimulateOptions& options, const geo::EnuFrame& frame,
                  size_t n_photos, const std::optional<geo::Similarity3d>& model_from_enu) {
  const geo::Geodetic& origin = frame.origin();
  Json json = {{"place", place.name},
               {"seed", place.seed},
               {"photos", n_photos},
               {"origin", {{"latitude_deg", origin.latitude_deg}, {"longitude_deg", origin.longitude_deg}, {"height_m", origin.height_m}}},
               {"exact_frame", !model_from_enu},
               {"gps_noise_m", place.gps_noise_m},
               {"test_every", options.test_every},
               {"options", OptionsJson(options)},
               {"blocks",
                {{"rows", place.rows},
                 {"columns", place.columns},
                 {"min_enu", {place.area_min.x(), place.area_min.y()}},
                 {"max_enu", {place.area_max.x(), place.area_max.y()}},
                 {"altitudes_agl_m", place.altitudes_agl_m}}}};
  if (place.landscape == Landscape::kCity) {
    const double yaw_deg = place.city.yaw_deg, turn_deg = place.city.district_turn_deg;
    json["city_yaw_deg"] = yaw_deg;
    json["district_yaw_deg"] = {yaw_deg, std::remainder(yaw_deg + turn_deg, 360.0)};
  }
  if (place.flight != FlightKind::kSurvey) {
    const Eigen::Vector3d up = model_from_enu ? Eigen::Vector3d(model_from_enu->rotation * Eigen::Vector3d::UnitZ()) : Eigen::Vector3d::UnitZ();
    json["flight"] = FlightName(place.flight);
    json["truth"]["up_in_model"] = {up.x(), up.y(), up.z()};
  }
  if (model_from_enu) {
    const geo::Similarity3d enu_from_model = Inverse(*model_from_enu);
    const Eigen::Quaterniond& r = enu_from_model.rotation;
    const Eigen::Vector3d& t = enu_from_model.translation;
    json["truth"]["enu_from_model"] = {
        {"scale", enu_from_model.scale}, {"rotation_wxyz", {r.w(), r.x(), r.y(), r.z()}}, {"translation_m", {t.x(), t.y(), t.z()}}};
  }
  base::WriteFileAtomically(folder / "simulate.json", base::JsonText(json, 1) + "\n");
}

}  // namespace skyquilt::simulate
