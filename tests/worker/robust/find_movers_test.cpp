// Photos that look down on patterned ground with things on it: what moved between photos is found, and what stands still is not.
#include "worker/robust/find_movers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "core/geo/ray_box.h"
#include "core/image/image.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

constexpr int kPhotoColumns = 160, kPhotoRows = 120, kPhotos = 16;
constexpr double kPhotoFocal = 120.0, kFlown_m = 40.0;  // a cell of 4 pixels shows 1.33 m

// A box that some of the photos show.
struct Box {
  Eigen::Vector3d min, max;
  Eigen::Vector3d color;
  std::vector<int> photos;  // empty: all
};

class FindMoversTest : public ::testing::Test {
 protected:
  using Light = std::function<double(int photo, const Eigen::Vector3d& place)>;

  void Photograph(const std::vector<Box>& boxes, const Light& light = {}) {
    camera_.width = kPhotoColumns;
    camera_.height = kPhotoRows;
    camera_.params = {kPhotoFocal, kPhotoFocal, kPhotoColumns / 2.0, kPhotoRows / 2.0};
    survey_.cameras = {camera_};
    survey_.photo_root = folder_.path();
    std::vector<image::PixelSource> sources;
    for (int i = 0; i < kPhotos; ++i) {
      survey::Photo photo = NadirPhoto({-12.0 + 8.0 * (i % 4), -12.0 + 8.0 * (i / 4), kFlown_m}, "p" + std::to_string(10 + i) + ".png");
      photo.is_test = i == 5;
      photo.flight = flight_of_(i);
      image::Image8 picture(kPhotoColumns, kPhotoRows, 3);
      for (int y = 0; y < kPhotoRows; ++y) {
        for (int x = 0; x < kPhotoColumns; ++x) {
          const Eigen::Vector3d color = Shade(i, photo, {x + 0.5, y + 0.5}, boxes, light);
          for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<uint8_t>(std::lround(255.0 * std::clamp(color[c], 0.0, 1.0)));
        }
      }
      image::SavePng(picture, folder_.path() / photo.name);
      sources.push_back({folder_.path() / photo.name, {}});
      survey_.photos.push_back(std::move(photo));
    }
    pixels_ = std::make_unique<image::PixelCache>(image::PixelCache::Open(folder_.path() / "pixels.bin", sources, 0, threads_));
  }

  // The ground is all that the context knows.
  Movers Find(const RobustOptions& options) {
    const brightness::Response response = brightness::Response::Neutral(kPhotos, 1);
    const RaySource source(survey_, *pixels_, response);
    const DepthCaster caster = [](std::span<const render::Ray> rays, std::span<render::RayColor> colors) {
      for (size_t i = 0; i < rays.size(); ++i) {
        colors[i].opacity = 1.0F;
        colors[i].depth_median = static_cast<float>(-rays[i].origin_enu.z() / rays[i].direction_enu.z());
      }
    };
    const int cell_px = CellPixels(survey_, *pixels_, std::numeric_limits<double>::quiet_NaN(), 1e9);
    const PhotoViews views(survey_, *pixels_, source, response, cell_px, caster, threads_);
    return FindMovers(survey_, source, views, options, cell_px, threads_);
  }

  // Share of the pixels of a photo that show a box and are rejected.
  double RejectedOf(const Movers& movers, int photo, const Box& box) const {
    int shown = 0, rejected = 0;
    ForPixels(photo, [&](int x, int y, const Eigen::Vector3d& direction) {
      if (geo::RayBox(Eye(photo), direction, box.min, box.max).Empty()) return;
      ++shown;
      rejected += movers.pixels.At(static_cast<size_t>(photo), x, y) ? 1 : 0;
    });
    return shown == 0 ? 0.0 : static_cast<double>(rejected) / shown;
  }
  // Share of all pixels of all photos that are rejected though no given box is within reach_m.
  double RejectedElsewhere(const Movers& movers, const std::vector<Box>& boxes, double reach_m) const {
    int64_t others = 0, rejected = 0;
    for (int photo = 0; photo < kPhotos; ++photo) {
      ForPixels(photo, [&](int x, int y, const Eigen::Vector3d& direction) {
        const Eigen::Vector3d reach(reach_m, reach_m, 0.0);
        for (const Box& box : boxes) {
          const bool shown = box.photos.empty() || std::ranges::find(box.photos, photo) != box.photos.end();
          if (shown && !geo::RayBox(Eye(photo), direction, box.min - reach, box.max + reach).Empty()) return;
        }
        ++others;
        rejected += movers.pixels.At(static_cast<size_t>(photo), x, y) ? 1 : 0;
      });
    }
    return static_cast<double>(rejected) / static_cast<double>(others);
  }

  std::function<int(int)> flight_of_ = [](int) { return 0; };

 private:
  Eigen::Vector3d Shade(int i, const survey::Photo& photo, const Eigen::Vector2d& pixel, const std::vector<Box>& boxes, const Light& light) const {
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    const Eigen::Vector3d direction = photo.cam_from_enu.rotation.conjugate() * camera_.RayFromImg(pixel);
    double nearest = std::numeric_limits<double>::infinity();
    Eigen::Vector3d color;
    for (const Box& box : boxes) {
      if (!box.photos.empty() && std::ranges::find(box.photos, i) == box.photos.end()) continue;
      const geo::Interval hit = geo::RayBox(eye, direction, box.min, box.max);
      if (hit.Empty() || hit.t_near >= nearest) continue;
      nearest = hit.t_near;
      color = box.color;
    }
    if (std::isfinite(nearest)) return color;
    const Eigen::Vector3d place = eye - eye.z() / direction.z() * direction;
    const double wave = 0.5 + 0.12 * std::sin(0.5 * place.x()) * std::cos(0.4 * place.y()) + (light ? light(i, place) : 0.0);
    return {0.8 * wave, wave, 0.7 * wave};
  }
  Eigen::Vector3d Eye(int photo) const { return survey_.photos[static_cast<size_t>(photo)].cam_from_enu.OriginInSource(); }
  // Every fourth pixel.
  template <typename Each>
  void ForPixels(int photo, const Each& each) const {
    for (int y = 0; y < kPhotoRows; y += 2) {
      for (int x = 0; x < kPhotoColumns; x += 2) {
        const geo::Rigid3d& pose = survey_.photos[static_cast<size_t>(photo)].cam_from_enu;
        each(x, y, Eigen::Vector3d(pose.rotation.conjugate() * camera_.RayFromImg({x + 0.5, y + 0.5})));
      }
    }
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  camera::Camera camera_;
  survey::Survey survey_;
  std::unique_ptr<image::PixelCache> pixels_;
};

Box CarAt(double x, double y, const std::vector<int>& photos, const Eigen::Vector3d& color) {
  return {{x - 3.0, y - 1.5, 0.0}, {x + 3.0, y + 1.5, 1.5}, color, photos};
}

const Eigen::Vector3d kWhite{0.9, 0.9, 0.9}, kDark{0.1, 0.1, 0.12}, kRed{0.8, 0.1, 0.1};

TEST_F(FindMoversTest, CarsThatDriveAreFoundAndThoseThatStandAreNot) {
  std::vector<Box> driving;
  for (const int photo : {2, 6, 9, 14}) driving.push_back(CarAt(-6.0 + photo, 2.0 * (photo % 3) - 1.0, {photo}, photo % 2 == 0 ? kWhite : kDark));
  const std::vector<Box> standing = {
      CarAt(10.0, 10.0, {}, kRed), CarAt(-9.0, -7.0, {}, kWhite), {{3.0, -10.0, 0.0}, {3.8, -9.2, 6.0}, kDark, {}}};  // a post
  std::vector<Box> all = driving;
  all.insert(all.end(), standing.begin(), standing.end());
  Photograph(all);
  const Movers movers = Find({.movers = "on"});
  for (const Box& car : driving) EXPECT_GT(RejectedOf(movers, car.photos[0], car), 0.9) << car.photos[0];
  for (const Box& still : standing) {
    for (int photo = 0; photo < kPhotos; ++photo) EXPECT_LT(RejectedOf(movers, photo, still), 0.05) << photo << " " << still.min.transpose();
  }
  EXPECT_LT(RejectedElsewhere(movers, driving, 3.0), 0.001);
  EXPECT_GT(movers.compared, 0.5);
  EXPECT_GT(movers.moved, 0.0);
  EXPECT_LT(movers.moved, 0.01);
  EXPECT_FALSE(movers.unclear);
  EXPECT_EQ(movers.pixels.Share(5), 0.0);  // held out
}

TEST_F(FindMoversTest, NothingMovedGivesNothing) {
  Photograph({CarAt(2.0, 1.0, {}, kRed)});
  const Movers movers = Find({.movers = "on", .prefer = "latest"});
  for (size_t photo = 0; photo < kPhotos; ++photo) EXPECT_EQ(movers.pixels.Share(photo), 0.0) << photo;
}

TEST_F(FindMoversTest, WavesAreLimitedOrNotRejectedAtAll) {
  // Patches of light that are elsewhere in each photo.
  const auto waves = [](int photo, const Eigen::Vector3d& p) {
    return std::sin(0.3 * p.x() + 2.4 * photo) * std::sin(0.25 * p.y() + 1.7 * photo) > 0.7 ? 0.3 : 0.0;
  };
  Photograph({}, waves);
  const Movers on = Find({.movers = "on"});
  ASSERT_GT(on.moved, 0.03);
  for (size_t photo = 0; photo < kPhotos; ++photo) EXPECT_LT(on.pixels.Share(photo), 0.09) << photo;  // 3 %, and a rim of one cell
  const Movers automatic = Find({.movers = "auto"});
  EXPECT_TRUE(automatic.unclear);
  for (size_t photo = 0; photo < kPhotos; ++photo) EXPECT_EQ(automatic.pixels.Share(photo), 0.0) << photo;
}

TEST_F(FindMoversTest, LightThatChangesSmoothlyIsNoThing) {
  // A bright spot opposite the sun, which moves with the camera.
  const auto spot = [](int photo, const Eigen::Vector3d& p) {
    const double x = p.x() - (-12.0 + 8.0 * (photo % 4)) - 4.0, y = p.y() - (-12.0 + 8.0 * (photo / 4)) + 3.0;
    return 0.35 * std::exp(-(x * x + y * y) / 450.0);
  };
  const Box car = CarAt(0.0, 0.0, {10}, kRed);
  Photograph({car}, spot);
  const Movers movers = Find({.movers = "on"});
  EXPECT_GT(RejectedOf(movers, 10, car), 0.9);
  EXPECT_LT(RejectedElsewhere(movers, {car}, 3.0), 0.001);
}

TEST_F(FindMoversTest, OfTwoFlightsTheEarlierOneGivesWay) {
  flight_of_ = [](int photo) { return photo % 2; };
  std::vector<int> first, second;
  for (int i = 0; i < kPhotos; ++i) (i % 2 == 0 ? first : second).push_back(i);
  const Box left = CarAt(-3.0, -4.0, first, kWhite), came = CarAt(4.0, 3.0, second, kDark);
  Photograph({left, came, CarAt(-8.0, 8.0, {}, kRed)});
  const Movers any = Find({.movers = "on", .prefer = "any"});
  const Movers latest = Find({.movers = "off", .prefer = "latest"});
  for (const int photo : {4, 6, 8, 10}) {
    EXPECT_LT(RejectedOf(any, photo, left), 0.3) << photo;  // half of the photos show it
    EXPECT_GT(RejectedOf(latest, photo, left), 0.9) << photo;
    EXPECT_GT(RejectedOf(latest, photo, came), 0.6) << photo;  // shown by its sides where it stands before the ground of other photos
  }
  for (const int photo : second) EXPECT_EQ(latest.pixels.Share(static_cast<size_t>(photo)), 0.0) << photo;
  EXPECT_GT(latest.replaced, 0.0);
}

}  // namespace
}  // namespace skyquilt::worker
