// A small survey with known answers: coloured ground with a house on it, photographed from above with different exposures. ENU, metres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "core/base/random.h"
#include "core/geo/ray_box.h"
#include "core/image/image.h"
#include "core/image/srgb.h"
#include "core/survey/survey.h"
#include "tests/support/nadir_photo.h"

namespace skyquilt::products {

struct PatternedSurvey {
  static constexpr int kWidth = 240, kHeight = 180, kPhotosEast = 4, kPhotosNorth = 3;
  static constexpr double kFlight_m = 40.0, kFocal_px = 180.0, kSpacing_m = 12.0, kGround_m = 3.0, kRoof_m = 8.0;
  static constexpr double kHouse = 5.0;                                                // the house is this far to each side of the origin
  static constexpr double kWest = -18.0, kEast = 18.0, kSouth = -12.0, kNorth = 12.0;  // the outermost cameras

  static bool InHouse(double x, double y, double rim = 0.0) { return std::max(std::abs(x), std::abs(y)) <= kHouse + rim; }
  static double SurfaceZ(double x, double y) { return InHouse(x, y) ? kRoof_m : kGround_m; }
  // Display values, 0..1.
  static std::array<double, 3> Color(double x, double y) {
    const double wave = 0.45 + 0.12 * std::sin(0.31 * x) * std::cos(0.27 * y);
    if (InHouse(x, y)) return {wave + 0.2, 0.7 * wave, 0.6 * wave};
    return {0.8 * wave, wave, 0.45 + 0.1 * std::sin(0.2 * (x + y))};
  }

  // Writes the photos into `folder`. stops: exposures alternate between + and - this.
  static survey::Survey Write(const std::filesystem::path& folder, double stops, bool georeferenced) {
    survey::Survey survey;
    survey.origin = {47.0, 8.0, 400.0};
    survey.georeferenced = georeferenced;
    survey.photo_root = folder;
    camera::Camera camera;
    camera.width = kWidth;
    camera.height = kHeight;
    camera.params = {kFocal_px, kFocal_px, kWidth / 2.0, kHeight / 2.0};
    survey.cameras = {camera};
    // Most tests want the same photos.
    static std::map<std::pair<int, double>, image::Image8> taken;
    for (int i = 0; i < kPhotosEast * kPhotosNorth; ++i) {
      const Eigen::Vector3d eye(kWest + kSpacing_m * (i % kPhotosEast), kSouth + kSpacing_m * (i / kPhotosEast), kFlight_m + kGround_m);
      survey.photos.push_back(NadirPhoto(eye, "p" + std::to_string(10 + i) + ".png"));
      const double light = std::exp2(i % 2 == 0 ? stops : -stops);
      image::Image8& picture = taken[{i, light}];
      if (picture.width == 0) picture = Photograph(survey.photos.back(), camera, light);
      image::SavePng(picture, folder / survey.photos.back().name);
    }
    survey.points = Points(2000);
    return survey;
  }

  // What the photo shows, with this factor on linear light.
  static image::Image8 Photograph(const survey::Photo& photo, const camera::Camera& camera, double light) {
    image::Image8 picture(camera.width, camera.height, 3);
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const Eigen::Vector3d ray = photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({x + 0.5, y + 0.5});
        const geo::Interval house = geo::RayBox(eye, ray, {-kHouse, -kHouse, kGround_m}, {kHouse, kHouse, kRoof_m});
        const Eigen::Vector3d place = eye + (house.Empty() ? (kGround_m - eye.z()) / ray.z() : house.t_near) * ray;
        const std::array<double, 3> color = Color(place.x(), place.y());
        for (size_t c = 0; c < 3; ++c) {
          const float linear = static_cast<float>(light) * image::LinearFromSrgb(static_cast<float>(color[c]));
          picture.At(x, y)[c] = static_cast<uint8_t>(std::lround(255.0F * std::clamp(image::SrgbFromLinear(linear), 0.0F, 1.0F)));
        }
      }
    }
    return picture;
  }

  // On the surface; one in fifty is 10 m too low or too high.
  static std::vector<survey::SparsePoint> Points(int count) {
    base::Random random(3);
    std::vector<survey::SparsePoint> points;
    for (int i = 0; i < count; ++i) {
      const double x = random.Uniform(-30.0, 30.0), y = random.Uniform(-25.0, 25.0);
      survey::SparsePoint point;
      point.x_in_enu = {x, y, SurfaceZ(x, y) + (i % 50 == 0 ? (i % 100 == 0 ? 10.0 : -10.0) : 0.0)};
      point.track_length = 4;
      points.push_back(point);
    }
    return points;
  }
};

}  // namespace skyquilt::products
