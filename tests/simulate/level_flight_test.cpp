#include "simulate/flights/level_flight.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "simulate/flights/sight.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// One flight over the hamlet, or in the room, as it is by default.
struct Level {
  explicit Level(const std::string& flight)
      : place([&flight] {
          SimulateOptions options;
          options.place = "hamlet";
          options.flight = flight;
          PlaceSpec spec = ResolvePlace(options);
          spec.ambient_voxel_m = 12.0;  // light is not looked at here
          return spec;
        }()),
        threads(2),
        world(place, 1.0, threads),
        photos(PlanLevelFlight(place, world)) {}

  PlaceSpec place;
  base::ThreadPool threads;
  World world;
  std::vector<PhotoPlan> photos;
};

const Level& LevelOf(const std::string& flight) {
  base::Progress::SetQuiet(true);
  static std::map<std::string, std::unique_ptr<Level>> made;
  std::unique_ptr<Level>& level = made[flight];
  if (!level) level = std::make_unique<Level>(flight);
  return *level;
}

Vector3d ViewOf(const PhotoPlan& photo) {
  return photo.cam_from_enu.rotation.conjugate() * Vector3d::UnitZ();
}

// Rays of a photo on a grid of 12 x 9.
struct GridRays {
  std::vector<Vector3d> points;  // where they hit
  std::vector<double> distances_m;
  double sky = 0.0;  // share that hits nothing and goes upwards
  double total = 0.0;
};

GridRays RaysOf(const Level& level, const PhotoPlan& photo) {
  constexpr int kColumns = 12, kRows = 9;
  GridRays rays;
  const Vector3d centre = photo.cam_from_enu.OriginInSource();
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const Vector3d in_cam =
          level.place.camera.RayFromImg({(i + 0.5) * level.place.camera.width / kColumns, (j + 0.5) * level.place.camera.height / kRows});
      const Vector3d direction = photo.cam_from_enu.rotation.conjugate() * in_cam;
      const std::optional<Sighting> seen = LookAlong(level.world, centre, direction);
      rays.total += 1.0;
      if (seen) {
        rays.points.push_back(centre + seen->distance_m * direction);
        rays.distances_m.push_back(seen->distance_m);
      } else if (direction.z() > 0.0) {
        rays.sky += 1.0;
      }
    }
  }
  rays.sky /= rays.total;
  return rays;
}

double ShareWithin(const GridRays& rays, double distance_m) {
  const auto n = std::count_if(rays.distances_m.begin(), rays.distances_m.end(), [=](double d) { return d < distance_m; });
  return static_cast<double>(n) / rays.total;
}

// Share of the points that are in another photo's frame; what may hide them is not looked at.
double ShareInFrame(const std::vector<Vector3d>& points, const Level& level, const PhotoPlan& photo) {
  const auto n = std::count_if(points.begin(), points.end(), [&](const Vector3d& point) {
    const std::optional<Vector2d> pixel = level.place.camera.ImgFromCam(photo.cam_from_enu * point);
    return pixel && pixel->minCoeff() >= 0.0 && pixel->x() <= level.place.camera.width && pixel->y() <= level.place.camera.height;
  });
  return static_cast<double>(n) / static_cast<double>(std::max<size_t>(points.size(), 1));
}

class EveryLevelFlight : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Flights, EveryLevelFlight, testing::Values("facade", "orbit", "street", "room"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(EveryLevelFlight, LooksLevelFromFreePlaces) {
  const Level& level = LevelOf(GetParam());
  const bool orbit = level.place.flight == FlightKind::kOrbit;
  const std::map<std::string, size_t> wanted = {{"facade", 12}, {"orbit", 40}, {"street", 60}, {"room", 50}};
  EXPECT_LE(level.photos.size(), wanted.at(GetParam()));
  EXPECT_GE(level.photos.size(), orbit ? 32U : wanted.at(GetParam()));
  for (size_t i = 0; i < level.photos.size(); ++i) {
    const PhotoPlan& photo = level.photos[i];
    EXPECT_EQ(photo.name, PhotoName(i));
    const Vector3d centre = photo.cam_from_enu.OriginInSource();
    EXPECT_LT(std::abs(ViewOf(photo).z()), 0.4) << photo.name;
    EXPECT_LT(std::abs((photo.cam_from_enu.rotation.conjugate() * Vector3d::UnitX()).z()), 0.08) << photo.name;
    // Stations have more room than this; hands and wind move the camera.
    EXPECT_TRUE(IsFree(level.world, centre, orbit ? 0.6 : 0.2)) << photo.name;
    for (const Building& building : level.world.buildings()) {
      if (centre.z() < building.ground_z_m + building.ridge_height_m) {
        EXPECT_GT(building.DistanceTo(centre.head<2>()), 0.2) << photo.name;
      }
    }
    if (level.place.flight == FlightKind::kFacade || level.place.flight == FlightKind::kStreet) {
      EXPECT_NEAR(centre.z() - GroundZ(level.world, centre.head<2>()), kEyeHeight_m, 0.2) << photo.name;
    }
  }
}

TEST_P(EveryLevelFlight, SeesItsTargetAndSharesViews) {
  const Level& level = LevelOf(GetParam());
  const std::map<std::string, std::pair<double, double>> least = {
      {"facade", {0.6, 40.0}}, {"orbit", {0.3, 80.0}}, {"street", {0.3, 60.0}}, {"room", {0.35, 8.0}}};
  const auto [least_share, within_m] = least.at(GetParam());
  std::map<int, size_t> previous;  // of each line
  std::vector<std::vector<Vector3d>> points;
  double overlap = 0.0;
  int n_pairs = 0;
  for (size_t i = 0; i < level.photos.size(); ++i) {
    const GridRays rays = RaysOf(level, level.photos[i]);
    EXPECT_GT(ShareWithin(rays, within_m), least_share) << level.photos[i].name;
    points.push_back(rays.points);
    const auto before = previous.find(level.photos[i].line);
    if (before != previous.end()) {
      const size_t j = before->second;
      overlap += 0.5 * (ShareInFrame(points[i], level, level.photos[j]) + ShareInFrame(points[j], level, level.photos[i]));
      ++n_pairs;
    }
    previous[level.photos[i].line] = i;
  }
  ASSERT_GT(n_pairs, 5);
  EXPECT_GT(overlap / n_pairs, 0.6);
}

TEST(LevelFlight, SkyIsInPhotosOutside) {
  for (const auto& [flight, least_share] : std::map<std::string, double>{{"facade", 0.25}, {"street", 0.8}, {"orbit", 0.8}}) {
    const Level& level = LevelOf(flight);
    const auto n = std::count_if(level.photos.begin(), level.photos.end(), [&](const PhotoPlan& photo) { return RaysOf(level, photo).sky > 0.01; });
    EXPECT_GE(static_cast<double>(n), least_share * static_cast<double>(level.photos.size())) << flight;
  }
}

TEST(LevelFlight, AFacadeIsPassedAtItsOverlap) {
  const Level& level = LevelOf("facade");
  std::vector<double> overlaps;
  int n_on_walls = 0;
  for (size_t i = 0; i < level.photos.size(); ++i) {
    const Vector3d centre = level.photos[i].cam_from_enu.OriginInSource();
    const std::optional<Sighting> ahead = LookAlong(level.world, centre, ViewOf(level.photos[i]));
    if (!ahead || ahead->tag.part != Part::kWall) continue;
    ++n_on_walls;
    if (i == 0) continue;
    const double step_m = (centre - level.photos[i - 1].cam_from_enu.OriginInSource()).head<2>().norm();
    overlaps.push_back(1.0 - step_m * level.place.camera.FocalX() / (ahead->distance_m * level.place.camera.width));
    EXPECT_GT(ViewOf(level.photos[i]).z(), 0.05);
  }
  EXPECT_GE(n_on_walls, 8);
  EXPECT_NEAR(base::Median(overlaps), 0.7, 0.08);
}

// At most a few rays of the photos end on a car or a tree nearer than half of the way to the wall.
TEST(LevelFlight, NoCarStandsBeforeTheLensAtAFacade) {
  const Level& level = LevelOf("facade");
  std::vector<double> to_wall_m;
  for (const PhotoPlan& photo : level.photos) {
    const std::optional<Sighting> ahead = LookAlong(level.world, photo.cam_from_enu.OriginInSource(), ViewOf(photo));
    if (ahead && ahead->tag.part == Part::kWall) to_wall_m.push_back(ahead->distance_m);
  }
  ASSERT_GE(to_wall_m.size(), 8U);
  const double near_m = 0.5 * base::Median(to_wall_m);
  for (const PhotoPlan& photo : level.photos) {
    int n_blocked = 0;
    for (int i = 0; i < 12 * 9; ++i) {
      const Eigen::Vector2d pixel(level.place.camera.width * (i % 12 + 0.5) / 12.0, level.place.camera.height * (i / 12 + 0.5) / 9.0);
      const Vector3d direction = photo.cam_from_enu.rotation.conjugate() * level.place.camera.RayFromImg(pixel);
      const std::optional<Sighting> seen = LookAlong(level.world, photo.cam_from_enu.OriginInSource(), direction);
      if (!seen || seen->distance_m > near_m) continue;
      const Part part = seen->tag.part;
      if (part == Part::kCarBody || part == Part::kCarGlass || part == Part::kCarTyre || part == Part::kLeaves) ++n_blocked;
    }
    EXPECT_LE(n_blocked, 5) << photo.name;
  }
}

TEST(LevelFlight, AnOrbitLooksAtOneBuildingFromTwoHeights) {
  const Level& level = LevelOf("orbit");
  std::map<int, std::vector<double>> heights;
  std::map<uint32_t, int> seen_outlines;
  for (const PhotoPlan& photo : level.photos) {
    const Vector3d centre = photo.cam_from_enu.OriginInSource();
    heights[photo.line].push_back(centre.z());
    const std::optional<Sighting> ahead = LookAlong(level.world, centre, ViewOf(photo));
    if (ahead && (ahead->tag.part == Part::kWall || ahead->tag.part == Part::kFlatRoof || ahead->tag.part == Part::kPitchedRoof)) {
      ++seen_outlines[level.world.buildings()[ahead->tag.object].outline];
    }
  }
  ASSERT_EQ(heights.size(), 2U);
  EXPECT_NEAR(base::Median(heights[1]) - base::Median(heights[0]), 10.0, 0.3);
  const auto most = std::max_element(seen_outlines.begin(), seen_outlines.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  ASSERT_NE(most, seen_outlines.end());
  EXPECT_GE(most->second, static_cast<int>(level.photos.size()) * 8 / 10);
}

TEST(LevelFlight, AStreetIsSeenAheadAndToBothSidesInTurn) {
  const Level& level = LevelOf("street");
  const Vector3d way = level.photos.back().cam_from_enu.OriginInSource() - level.photos.front().cam_from_enu.OriginInSource();
  EXPECT_GT(way.norm(), 40.0);
  for (size_t i = 0; i < level.photos.size(); ++i) {
    const Vector2d view = ViewOf(level.photos[i]).head<2>().normalized();
    const double left_deg = std::atan2(way.x() * view.y() - way.y() * view.x(), way.head<2>().dot(view)) * 180.0 / M_PI;
    EXPECT_NEAR(left_deg, i % 3 == 0 ? 0.0 : (i % 3 == 1 ? 60.0 : -60.0), 8.0) << i;
    const Vector3d centre = level.photos[i].cam_from_enu.OriginInSource();
    EXPECT_EQ(level.world.city()->Sample(static_cast<float>(centre.x()), static_cast<float>(centre.y())).kind, GroundKind::kRoad) << i;
  }
}

TEST(LevelFlight, TheRoomIsClosedButForItsWindow) {
  const Level& level = LevelOf("room");
  EXPECT_TRUE(level.world.buildings().empty());
  int n_out = 0, n_rays = 0;
  for (const double yaw_deg : {0.0,   15.0,  30.0,  45.0,  60.0,  75.0,  90.0,  105.0, 120.0, 135.0, 150.0, 165.0,
                               180.0, 195.0, 210.0, 225.0, 240.0, 255.0, 270.0, 285.0, 300.0, 315.0, 330.0, 345.0}) {
    for (const double pitch_deg : {-80.0, -50.0, -20.0, 0.0, 5.0, 20.0, 50.0, 80.0}) {
      const Vector3d direction = PoseFromGimbal(Vector3d::Zero(), yaw_deg, pitch_deg, 0.0).rotation.conjugate() * Vector3d::UnitZ();
      const std::optional<Sighting> seen = LookAlong(level.world, {0.0, 0.0, 1.5}, direction);
      ++n_rays;
      const bool outside = !seen || seen->tag.part == Part::kGround;
      // The window is in the middle of the wall to the south, which is turned by 20 degrees.
      if (outside) {
        EXPECT_LT(std::abs(std::remainder(yaw_deg - 160.0, 360.0)), 25.0) << yaw_deg << " " << pitch_deg;
        EXPECT_LT(std::abs(pitch_deg), 21.0);
        ++n_out;
      }
    }
  }
  EXPECT_GT(n_out, 0);
  EXPECT_LT(n_out, n_rays / 10);
  EXPECT_FALSE(IsFree(level.world, {0.0, 0.0, 2.8}, 0.1));    // in the ceiling
  EXPECT_FALSE(IsFree(level.world, {0.0, 0.0, -0.7}, 0.05));  // under the ground
}

TEST(LevelFlight, ExposuresDifferAndTagsAreNone) {
  for (const char* flight : {"facade", "orbit", "street", "room"}) {
    const Level& level = LevelOf(flight);
    double darkest = 1e9, brightest = 0.0;
    for (const PhotoPlan& photo : level.photos) {
      darkest = std::min(darkest, photo.development_gain);
      brightest = std::max(brightest, photo.development_gain);
    }
    EXPECT_GT(std::log2(brightest / darkest), 0.2) << flight;
    EXPECT_LT(std::log2(brightest / darkest), 2.0) << flight;
    EXPECT_FALSE(level.place.tag_faults.position_tags);
    EXPECT_FALSE(level.place.tag_faults.gimbal_tags);
  }
}

TEST(LevelFlight, TowersOfATownAreFlownRoundToo) {
  SimulateOptions options;
  options.flight = "orbit";
  options.photos = 10;
  options.tower_m = 60.0;  // higher than a survey of the town flies
  PlaceSpec place = ResolvePlace(options);
  place.ambient_voxel_m = 24.0;
  place.city.tree_detail = 0;
  base::ThreadPool threads(2);
  const World world(place, 1.0, threads);
  const std::vector<PhotoPlan> photos = PlanLevelFlight(place, world);
  EXPECT_GE(photos.size(), 6U);
  for (const PhotoPlan& photo : photos) EXPECT_LT(std::abs(ViewOf(photo).z()), 0.4);
}

std::string RefusalOf(const SimulateOptions& options) {
  try {
    ResolvePlace(options);
  } catch (const base::UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(LevelFlight, RefusesWhatItCannotDo) {
  const auto with = [](const char* flight, const char* place) {
    SimulateOptions options;
    options.flight = flight;
    options.place = place;
    return options;
  };
  EXPECT_NE(RefusalOf(with("street", "tidalflat")).find("place 'tidalflat' has no streets; choose hamlet"), std::string::npos);
  EXPECT_NE(RefusalOf(with("facade", "solar_farm")).find("has no houses"), std::string::npos);
  EXPECT_EQ(RefusalOf(with("room", "tidalflat")), "");
  SimulateOptions options = with("orbit", "hamlet");
  options.building_share = 0.0;
  EXPECT_NE(RefusalOf(options).find("simulate.flight = orbit"), std::string::npos);
  options.flight = "street";
  EXPECT_EQ(RefusalOf(options), "");
  options = with("facade", "hamlet");
  options.altitudes = {60.0};
  EXPECT_NE(RefusalOf(options).find("simulate.altitudes"), std::string::npos);
  options = with("survey", "hamlet");
  options.photos = 30;
  EXPECT_NE(RefusalOf(options).find("simulate.photos = 30"), std::string::npos);
  options = with("room", "hamlet");
  options.hillside_deg = 5.0;
  EXPECT_NE(RefusalOf(options).find("simulate.hillside_deg"), std::string::npos);
  EXPECT_THROW(PlanFlight(LevelOf("street").place, 0.0), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::simulate
