#include "simulate/simulate.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/progress.h"
#include "core/geo/enu_frame.h"
#include "core/image/image.h"
#include "core/image/normal_image.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"
#include "core/survey/surface_class.h"
#include "simulate/world.h"

namespace skyquilt::simulate {
namespace {

namespace fs = std::filesystem;

SimulateOptions Hamlet() {
  SimulateOptions options;
  options.place = "hamlet";
  options.seed = 5;
  return options;
}

std::map<std::string, std::string> ReadTree(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = base::ReadFile(entry.path());
  }
  return files;
}

class HamletSurvey : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    base::Progress::SetQuiet(true);
    root_ = fs::temp_directory_path() / ("skyquilt_simulate_test_" + std::to_string(getpid()));
    base::ThreadPool threads(2);
    summary_ = Simulate(Hamlet(), root_ / "two", threads);
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static nlohmann::json Json(const std::string& name) { return base::ParseJson(base::ReadFile(root_ / "two" / name)); }
  static bool IsTest(size_t index) { return index % 8 == 0; }

  static fs::path root_;
  static SimulateSummary summary_;
};
fs::path HamletSurvey::root_;
SimulateSummary HamletSurvey::summary_;

TEST_F(HamletSurvey, SameSeedSameBytesForAnyNumberOfThreads) {
  base::ThreadPool one(1);
  base::ThreadPool three(3);
  const auto files = ReadTree(root_ / "two");
  EXPECT_GT(files.size(), 30U);
  Simulate(Hamlet(), root_ / "again", one);
  EXPECT_TRUE(files == ReadTree(root_ / "again"));
  // Replaces an earlier, different simulation completely.
  SimulateOptions other = Hamlet();
  other.seed = 6;
  other.samples_per_pixel = 1;
  other.test_every = 2;
  Simulate(other, root_ / "again", three);
  const auto changed = ReadTree(root_ / "again");
  EXPECT_NE(files.at("images/IMG_0001.jpg"), changed.at("images/IMG_0001.jpg"));
  Simulate(Hamlet(), root_ / "again", three);
  EXPECT_TRUE(files == ReadTree(root_ / "again"));
}

TEST_F(HamletSurvey, LayoutIsComplete) {
  const auto summary = Json("simulate.json");
  EXPECT_EQ(summary["place"], "hamlet");
  EXPECT_EQ(summary["photos"], summary_.n_photos);
  EXPECT_EQ(summary["city_yaw_deg"], ResolvePlace(Hamlet()).city.yaw_deg);
  ASSERT_EQ(summary["district_yaw_deg"].size(), 2U);
  // As before there were other flights.
  for (const char* key : {"flight", "photos", "tags", "lights", "lights_every", "marsh"}) EXPECT_FALSE(summary["options"].contains(key)) << key;
  EXPECT_FALSE(summary.contains("flight"));
  EXPECT_EQ(summary["district_yaw_deg"][0], summary["city_yaw_deg"]);
  EXPECT_EQ(summary["blocks"]["rows"].get<size_t>() * summary["blocks"]["columns"].get<size_t>(), summary["blocks"]["altitudes_agl_m"].size());
  EXPECT_GE(summary_.n_photos, 20);
  EXPECT_LE(summary_.n_photos, 30);
  EXPECT_GE(summary_.n_buildings, 5);
  EXPECT_EQ(Json("truth/buildings.json")["buildings"].size(), static_cast<size_t>(summary_.n_buildings));
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  ASSERT_EQ(model.images.size(), static_cast<size_t>(summary_.n_photos));
  EXPECT_EQ(model.points.size(), static_cast<size_t>(summary_.n_points));
  for (size_t i = 0; i < model.images.size(); ++i) {
    const fs::path name = model.images[i].name;
    EXPECT_TRUE(fs::exists(root_ / "two/images" / name));
    EXPECT_EQ(fs::exists(root_ / "two/truth/depth" / (name.stem().string() + ".tiff")), IsTest(i));
    const std::string png = name.stem().string() + ".png";
    EXPECT_EQ(fs::exists(root_ / "two/truth/normals" / png), IsTest(i));
    EXPECT_EQ(fs::exists(root_ / "two/truth/classes" / png), IsTest(i));
  }
}

TEST_F(HamletSurvey, TagsTellPositionAndExposure) {
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  const auto summary = Json("simulate.json");
  const auto& origin = summary["origin"];
  const geo::EnuFrame frame({origin["latitude_deg"], origin["longitude_deg"], origin["height_m"]});
  const auto truth = Json("truth/exposure.json")["photos"];
  ASSERT_EQ(truth.size(), model.images.size());
  double previous_time = -1.0;
  double first_ratio = 0.0;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const survey::PhotoTags tags = survey::ReadPhotoTags(root_ / "two/images" / model.images[i].name);
    ASSERT_TRUE(tags.gps && tags.relative_altitude_m && tags.absolute_altitude_m && tags.gimbal_pitch_deg && tags.gimbal_yaw_deg &&
                tags.capture_time_s);
    const Eigen::Vector3d centre = model.images[i].cam_from_world.OriginInSource();
    EXPECT_LT((frame.EnuFromGeodetic(*tags.gps) - centre).norm(), 6.0 * 0.3 * 1.5);
    EXPECT_NEAR(*tags.relative_altitude_m, 45.0, 2.5);
    EXPECT_NEAR(*tags.gimbal_pitch_deg, -90.0, 4.0);
    EXPECT_FALSE(tags.rtk);
    EXPECT_EQ(tags.make, "Skyquilt");
    EXPECT_GT(*tags.capture_time_s, previous_time);
    previous_time = *tags.capture_time_s;
    ASSERT_TRUE(tags.exposure.time_s && tags.exposure.f_number && tags.exposure.iso);
    EXPECT_EQ(truth[i]["name"], model.images[i].name);
    const double exposure = *tags.exposure.time_s * *tags.exposure.iso / (*tags.exposure.f_number * *tags.exposure.f_number);
    const double ratio = exposure / truth[i]["gain"].get<double>();
    if (i == 0) first_ratio = ratio;
    EXPECT_NEAR(ratio / first_ratio, 1.0, 1e-4);
  }
}

// The files hold what the renderer saw: where there is depth there is a normal and a class, at the size of the photo.
TEST_F(HamletSurvey, NormalsAndClassesAreWhereDepthIs) {
  const image::ImageF depth = image::LoadFloatTiff(root_ / "two/truth/depth/IMG_0009.tiff");
  const image::ImageF normals = image::LoadNormals(root_ / "two/truth/normals/IMG_0009.png");
  const image::Image8 classes = image::LoadLabels(root_ / "two/truth/classes/IMG_0009.png");
  ASSERT_EQ(normals.width, depth.width);
  ASSERT_EQ(normals.height, depth.height);
  ASSERT_EQ(classes.data.size(), depth.data.size());
  size_t n_roof = 0, n_roof_up = 0;
  for (size_t i = 0; i < depth.data.size(); ++i) {
    const auto seen = static_cast<survey::SurfaceClass>(classes.data[i]);
    ASSERT_EQ(std::isfinite(depth.data[i]), std::isfinite(normals.data[3 * i]));
    ASSERT_EQ(std::isfinite(depth.data[i]), seen != survey::SurfaceClass::kNone);
    if (seen != survey::SurfaceClass::kRoof) continue;
    ++n_roof;
    if (normals.data[3 * i + 2] > 0.5F) ++n_roof_up;
  }
  EXPECT_GT(n_roof, 100U);
  EXPECT_GT(n_roof_up, n_roof * 8 / 10);
}

// Sparse points are within a few centimetres of the surface, so where a photo's track has them its depth must agree,
// except beside edges, where a pixel's centre can be on the other side.
TEST_F(HamletSurvey, DepthAgreesWithThePoints) {
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  std::vector<double> differences;
  for (size_t i = 0; i < model.images.size(); ++i) {
    if (!IsTest(i)) continue;
    const survey::ColmapImage& image = model.images[i];
    const camera::Camera& camera = model.cameras.at(image.camera_id);
    const image::ImageF depth = image::LoadFloatTiff(root_ / "two/truth/depth" / (fs::path(image.name).stem().string() + ".tiff"));
    ASSERT_EQ(depth.width, camera.width);
    ASSERT_EQ(depth.height, camera.height);
    for (const survey::ColmapPoint& point : model.points) {
      EXPECT_GE(point.image_ids.size(), 3U);
      if (std::find(point.image_ids.begin(), point.image_ids.end(), image.id) == point.image_ids.end()) continue;
      const Eigen::Vector3d in_cam = image.cam_from_world * point.x_in_world;
      const auto pixel = camera.ImgFromCam(in_cam);
      ASSERT_TRUE(pixel.has_value());
      const int x = static_cast<int>(pixel->x());
      const int y = static_cast<int>(pixel->y());
      ASSERT_TRUE(x >= 0 && x < depth.width && y >= 0 && y < depth.height);
      differences.push_back(std::abs(static_cast<double>(*depth.At(x, y)) - in_cam.z()));
    }
  }
  ASSERT_GT(differences.size(), 1000U);
  std::sort(differences.begin(), differences.end());
  EXPECT_LT(differences[differences.size() / 2], 0.10);
  EXPECT_LT(differences[differences.size() * 8 / 10], 0.6);
}

TEST_F(HamletSurvey, TheModelIsThatOfThePlan) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(root_ / "two/sparse/0")) names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"cameras.bin", "images.bin", "points3D.bin"}));
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  PlaceSpec place = ResolvePlace(Hamlet());
  // The flight depends on the terrain alone.
  place.city.tree_detail = 0;
  place.ambient_voxel_m = 24.0;
  base::ThreadPool threads(2);
  const World world(place, Hamlet().light_intensity, threads);
  const std::vector<PhotoPlan> plan = PlanFlight(place, world.TakeoffHeight(place));
  ASSERT_EQ(model.images.size(), plan.size());
  EXPECT_EQ(model.cameras.at(1).params, place.camera.params);
  for (size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(model.images[i].name, plan[i].name);
    const geo::Rigid3d& pose = model.images[i].cam_from_world;
    EXPECT_TRUE(pose.translation == plan[i].cam_from_enu.translation);
    // The reader normalizes it.
    EXPECT_LT((pose.rotation.coeffs() - plan[i].cam_from_enu.rotation.coeffs()).norm(), 1e-15);
  }
}

// What COLMAP's tools and prepare need: each photo of a track has the point among its observations, inside the frame, and no other point.
TEST_F(HamletSurvey, TracksAndObservationsAgree) {
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  const survey::ColmapObservations observations = survey::ReadColmapObservations(root_ / "two/sparse/0");
  std::map<std::pair<uint32_t, uint64_t>, Eigen::Vector2d> pixels;
  for (const auto& [image_id, list] : observations) {
    for (const survey::ColmapObservation& o : list) EXPECT_TRUE(pixels.emplace(std::pair(image_id, o.point_id), o.pixel).second);
  }
  size_t n = 0;
  for (const survey::ColmapPoint& point : model.points) {
    for (const uint32_t image_id : point.image_ids) {
      const survey::ColmapImage& image = model.images[image_id - 1];
      ASSERT_EQ(image.id, image_id);
      const camera::Camera& camera = model.cameras.at(image.camera_id);
      const auto found = pixels.find({image_id, point.id});
      ASSERT_NE(found, pixels.end());
      EXPECT_LT((found->second - *camera.ImgFromCam(image.cam_from_world * point.x_in_world)).norm(), 1e-6);
      EXPECT_TRUE(found->second.minCoeff() > 0.0 && found->second.x() < camera.width && found->second.y() < camera.height);
      ++n;
    }
  }
  EXPECT_EQ(n, pixels.size());
}

// Heights of flat and pitched roofs in the depth images of the test photos: the highest point of each building.
TEST_F(HamletSurvey, DepthShowsTheBuildingsAtTheirHeights) {
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  int n_checked = 0;
  int n_agree = 0;
  const nlohmann::json truth = Json("truth/buildings.json");
  for (const nlohmann::json& b : truth["buildings"]) {
    const double yaw = b["yaw_deg"].get<double>() * M_PI / 180.0;
    // On the ridge, or off the centre of a flat roof's deck.
    const double along = -0.1 * b["length_m"].get<double>();
    const Eigen::Vector3d top(b["east_m"].get<double>() + along * std::cos(yaw), b["north_m"].get<double>() + along * std::sin(yaw),
                              b["ground_z_m"].get<double>() + b["ridge_height_m"].get<double>());
    for (size_t i = 0; i < model.images.size(); ++i) {
      if (!IsTest(i)) continue;
      const survey::ColmapImage& image = model.images[i];
      const camera::Camera& camera = model.cameras.at(image.camera_id);
      const Eigen::Vector3d in_cam = image.cam_from_world * top;
      const auto pixel = camera.ImgFromCam(in_cam);
      if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() >= camera.width || pixel->y() >= camera.height) continue;
      const image::ImageF depth = image::LoadFloatTiff(root_ / "two/truth/depth" / (fs::path(image.name).stem().string() + ".tiff"));
      const double seen = static_cast<double>(*depth.At(static_cast<int>(pixel->x()), static_cast<int>(pixel->y())));
      ++n_checked;
      // One pixel is 0.4 m; a roof of 42 degrees falls by that much beside its ridge.
      if (std::abs(seen - in_cam.z()) < 0.45) ++n_agree;
    }
  }
  ASSERT_GT(n_checked, 10);
  // Trees, chimneys and roof boxes hide some.
  EXPECT_GT(n_agree, n_checked * 8 / 10);
}

TEST_F(HamletSurvey, PhotosAreNeitherFlatNorClipped) {
  const survey::ColmapModel model = survey::ReadColmapModel(root_ / "two/sparse/0");
  for (const survey::ColmapImage& image : model.images) {
    const image::Image8 pixels = image::LoadRgb8(root_ / "two/images" / image.name);
    double sum = 0.0;
    double squares = 0.0;
    size_t n_clipped = 0;
    for (const uint8_t value : pixels.data) {
      sum += value;
      squares += static_cast<double>(value) * value;
      n_clipped += value == 255 || value == 0 ? 1U : 0U;
    }
    const auto n = static_cast<double>(pixels.data.size());
    EXPECT_GT(sum / n, 60.0);
    EXPECT_LT(sum / n, 180.0);
    EXPECT_GT(std::sqrt(squares / n - sum / n * sum / n), 20.0);
    EXPECT_LT(static_cast<double>(n_clipped), 0.02 * n);
  }
}

TEST_F(HamletSurvey, APlanChoosesPhotosDepthAndPoints) {
  base::ThreadPool threads(2);
  SimulateOptions options = Hamlet();
  options.samples_per_pixel = 1;
  const SimulateSummary summary = Simulate(options, root_ / "planned", threads, [](const PlaceSpec& place, const World& world) {
    std::vector<PhotoPlan> photos = PlanFlight(place, world.TakeoffHeight(place));
    photos.resize(5);
    for (PhotoPlan& photo : photos) photo.finds_points = false;
    photos[1].true_depth = true;
    return photos;
  });
  EXPECT_EQ(summary.n_photos, 5);
  EXPECT_EQ(summary.n_test, 1);
  EXPECT_EQ(summary.n_points, 0);
  EXPECT_TRUE(fs::exists(root_ / "planned/truth/depth/IMG_0002.tiff"));
  EXPECT_TRUE(fs::exists(root_ / "planned/truth/normals/IMG_0002.png"));
  EXPECT_EQ(base::ReadFile(root_ / "planned/truth/buildings.json"), base::ReadFile(root_ / "two/truth/buildings.json"));
}

// The same survey in a frame of structure from motion, with errors in the tags.
TEST_F(HamletSurvey, FaultsAreInModelAndTagsOnly) {
  SimulateOptions options = Hamlet();
  options.exact_frame = false;
  options.tag_height_offset_m = 50.0;
  options.tag_lag_s = 2.0;
  options.gimbal_tags = false;
  options.speed_tags = true;
  base::ThreadPool threads(2);
  Simulate(options, root_ / "faults", threads);
  EXPECT_TRUE(ReadTree(root_ / "faults/truth") == ReadTree(root_ / "two/truth"));
  EXPECT_FALSE(Json("simulate.json").contains("truth"));
  const auto summary = base::ParseJson(base::ReadFile(root_ / "faults/simulate.json"));
  EXPECT_EQ(summary["exact_frame"], false);
  const auto& stored = summary["truth"]["enu_from_model"];
  const auto q = stored["rotation_wxyz"].get<std::vector<double>>();
  const auto t = stored["translation_m"].get<std::vector<double>>();
  const geo::Similarity3d enu_from_model{stored["scale"].get<double>(), Eigen::Quaterniond(q[0], q[1], q[2], q[3]), {t[0], t[1], t[2]}};
  const survey::ColmapModel exact = survey::ReadColmapModel(root_ / "two/sparse/0");
  const survey::ColmapModel moved = survey::ReadColmapModel(root_ / "faults/sparse/0");
  ASSERT_EQ(moved.images.size(), exact.images.size());
  ASSERT_EQ(moved.points.size(), exact.points.size());
  for (size_t i = 0; i < exact.points.size(); ++i) {
    EXPECT_LT((enu_from_model * moved.points[i].x_in_world - exact.points[i].x_in_world).norm(), 1e-6);
  }
  for (size_t i = 0; i < exact.images.size(); ++i) {
    const geo::Rigid3d back = geo::TransformCameraWorld(moved.images[i].cam_from_world, enu_from_model);
    EXPECT_LT((back.OriginInSource() - exact.images[i].cam_from_world.OriginInSource()).norm(), 1e-6);
    EXPECT_LT(back.rotation.angularDistance(exact.images[i].cam_from_world.rotation), 1e-9);
    const fs::path name = exact.images[i].name;
    EXPECT_TRUE(image::LoadRgb8(root_ / "faults/images" / name).data == image::LoadRgb8(root_ / "two/images" / name).data);
    const survey::PhotoTags tags = survey::ReadPhotoTags(root_ / "faults/images" / name);
    EXPECT_FALSE(tags.gimbal_pitch_deg);
    ASSERT_TRUE(tags.gps && tags.speed_mps);
    EXPECT_NEAR(tags.gps->height_m, 408.0 + 45.0 + 50.0, 4.0);
    EXPECT_NEAR(*tags.speed_mps, 4.8, 1.0);
  }
}

TEST(Simulate, LeavesForeignPhotosAlone) {
  const fs::path root = fs::temp_directory_path() / ("skyquilt_simulate_foreign_" + std::to_string(getpid()));
  fs::create_directories(root / "images");
  base::WriteFileAtomically(root / "images/holiday.jpg", "not ours");
  base::ThreadPool threads(1);
  EXPECT_THROW(Simulate(Hamlet(), root, threads), base::InputError);
  EXPECT_EQ(base::ReadFile(root / "images/holiday.jpg"), "not ours");
  fs::remove_all(root);
}

TEST(Simulate, BadOptionsLeaveNoFolder) {
  const fs::path root = fs::temp_directory_path() / ("skyquilt_simulate_bad_" + std::to_string(getpid()));
  SimulateOptions options;
  options.place = "nowhere";
  base::ThreadPool threads(1);
  EXPECT_THROW(Simulate(options, root, threads), base::UsageError);
  EXPECT_FALSE(fs::exists(root));
}

}  // namespace
}  // namespace skyquilt::simulate
