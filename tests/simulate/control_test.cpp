// Ground control of simulated surveys: the targets show where the files say, and the files of all programs say the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/pattern.h"
#include "core/base/progress.h"
#include "core/geo/crs.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "simulate/control_writer.h"
#include "simulate/simulate.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::simulate {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d Pair(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>()};
}

Vector3d Triple(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::vector<std::vector<std::string>> Fields(const fs::path& file, char separator) {
  std::istringstream text(base::ReadFile(file));
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(text, line);) {
    std::istringstream stream(line);
    std::vector<std::string>& fields = lines.emplace_back();
    for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  }
  return lines;
}

class ControlSurvey : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    base::Progress::SetQuiet(true);
    folder_ = new TemporaryFolder;
    SimulateOptions options;
    options.place = "hamlet";
    options.seed = 5;
    options.control_points = 6;
    options.check_points = 3;
    options.test_every = 3;
    base::ThreadPool threads(2);
    summary_ = Simulate(options, Root(), threads);
    truth_ = base::ParseJson(base::ReadFile(Root() / "control/truth.json"));
    model_ = survey::ReadColmapModel(Root() / "sparse/0");
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path Root() { return folder_->path(); }
  static const camera::Camera& Lens() { return model_.cameras.begin()->second; }
  static const survey::ColmapImage& Photo(const std::string& name) {
    return *std::find_if(model_.images.begin(), model_.images.end(), [&](const survey::ColmapImage& image) { return image.name == name; });
  }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline SimulateSummary summary_;
  static inline nlohmann::json truth_;
  static inline survey::ColmapModel model_;
};

// Brightness between pixels, 0 to 255; the centre of the top-left pixel is (0.5, 0.5).
double Brightness(const image::Image8& image, const Vector2d& at) {
  const double x = std::clamp(at.x() - 0.5, 0.0, image.width - 1.001), y = std::clamp(at.y() - 0.5, 0.0, image.height - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = x - i, v = y - j;
  const auto grey = [&](int column, int row) {
    const uint8_t* rgb = image.At(column, row);
    return (rgb[0] + rgb[1] + rgb[2]) / 3.0;
  };
  return (1 - v) * ((1 - u) * grey(i, j) + u * grey(i + 1, j)) + v * ((1 - u) * grey(i, j + 1) + u * grey(i + 1, j + 1));
}

// Where opposite fields are most alike and neighbours differ most, within 4 pixels. A quarter turn about that place turns black into white.
Vector2d CrossNear(const image::Image8& image, const Vector2d& guess) {
  Vector2d best = guess;
  double best_score = -1.0;
  for (double dy = -4.0; dy <= 4.0; dy += 0.25) {
    for (double dx = -4.0; dx <= 4.0; dx += 0.25) {
      const Vector2d centre = guess + Vector2d(dx, dy);
      double score = 0.0;
      for (int k = 0; k < 12; ++k) {
        const double angle = k * std::numbers::pi / 12.0;
        const Vector2d d = 2.5 * Vector2d(std::cos(angle), std::sin(angle)), turned(-d.y(), d.x());
        const double difference =
            Brightness(image, centre + d) + Brightness(image, centre - d) - Brightness(image, centre + turned) - Brightness(image, centre - turned);
        score += difference * difference;
      }
      if (score <= best_score) continue;
      best_score = score;
      best = centre;
    }
  }
  return best;
}

TEST_F(ControlSurvey, TargetsShowWhereTheTruthSaysTheyDo) {
  std::map<std::string, image::Image8> photos;
  int n = 0, n_found = 0;
  for (const auto& point : truth_["points"]) {
    for (const auto& mark : point["marks"]) {
      const std::string name = mark["photo"];
      if (!photos.contains(name)) photos[name] = image::LoadRgb8(Root() / "images" / name);
      const Vector2d expected = Pair(mark["true_pixel"]);
      n_found += (CrossNear(photos[name], expected) - expected).norm() < 1.0 ? 1 : 0;
      ++n;
    }
  }
  EXPECT_EQ(n, 9 * 5);
  // A shadow's edge across a target can mislead the search.
  EXPECT_GE(n_found, n - 2);
}

TEST_F(ControlSurvey, MarksAreProjectionsOfVisiblePoints) {
  int n_depths = 0;
  for (const auto& point : truth_["points"]) {
    EXPECT_EQ(point["wrong"], false);
    EXPECT_EQ(point["given_enu_m"], point["enu_m"]);
    for (const auto& mark : point["marks"]) {
      const std::string name = mark["photo"];
      const Vector3d in_cam = Photo(name).cam_from_world * Triple(point["enu_m"]);
      const auto pixel = Lens().ImgFromCam(in_cam);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - Pair(mark["true_pixel"])).norm(), 1e-2);
      EXPECT_EQ(mark["wrong"], false);
      EXPECT_LT((Pair(mark["pixel"]) - *pixel).norm(), 0.5 * 5.0);
      const fs::path depth_file = Root() / "truth/depth" / (fs::path(name).stem().string() + ".tiff");
      if (!fs::exists(depth_file)) continue;
      const image::ImageF depth = image::LoadFloatTiff(depth_file);
      EXPECT_NEAR(static_cast<double>(*depth.At(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()))), in_cam.z(), 0.15);
      ++n_depths;
    }
  }
  EXPECT_GT(n_depths, 5);
}

TEST_F(ControlSurvey, PointsSpreadAndCheckPointsTakeTurns) {
  EXPECT_EQ(summary_.n_control, 9);
  std::vector<Vector3d> all;
  std::string order;
  for (const auto& point : truth_["points"]) {
    all.push_back(Triple(point["enu_m"]));
    order += point["check"].get<bool>() ? 'c' : 'g';
  }
  EXPECT_EQ(order, "ggcggcggc");
  const auto place = ResolvePlace([] {
    SimulateOptions options;
    options.place = "hamlet";
    return options;
  }());
  const double side_m = std::sqrt((place.area_max - place.area_min).prod());
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t j = 0; j < i; ++j) EXPECT_GT((all[i] - all[j]).head<2>().norm(), 0.12 * side_m) << i << " " << j;
  }
  EXPECT_EQ(base::ReadFile(Root() / "control/check_points.txt"), "check1\ncheck2\ncheck3\n");
}

TEST_F(ControlSurvey, AllProgramsGetTheSamePointsAndMarks) {
  const auto size = static_cast<double>(std::max(Lens().width, Lens().height));
  std::map<std::string, Vector3d> utm;
  for (const auto& fields : Fields(Root() / "control/pix4d.csv", ',')) {
    ASSERT_EQ(fields.size(), 4U);
    utm[fields[0]] = {std::stod(fields[1]), std::stod(fields[2]), std::stod(fields[3])};
  }
  ASSERT_EQ(utm.size(), 9U);
  const geo::Crs crs(truth_["crs"].get<std::string>());
  EXPECT_EQ(truth_["crs"], "EPSG:32632");
  std::map<std::pair<std::string, std::string>, Vector2d> marks;
  for (const auto& point : truth_["points"]) {
    const Vector3d x = crs.FromGeodetic({point["latitude_deg"], point["longitude_deg"], point["height_m"]});
    EXPECT_LT((x - utm.at(point["label"])).norm(), 1e-3);
    for (const auto& mark : point["marks"]) marks[{mark["photo"], point["label"]}] = Pair(mark["pixel"]);
  }
  for (const auto& fields : Fields(Root() / "control/pix4d_marks.csv", ',')) {
    EXPECT_LT((Vector2d(std::stod(fields[2]), std::stod(fields[3])) - marks.at({fields[0], fields[1]})).norm(), 1e-2);
  }
  const auto list = Fields(Root() / "control/gcp_list.txt", ' ');
  ASSERT_EQ(list.size(), 1 + marks.size());
  EXPECT_EQ(list[0], std::vector<std::string>{"EPSG:32632"});
  for (size_t i = 1; i < list.size(); ++i) {
    ASSERT_EQ(list[i].size(), 7U);
    EXPECT_LT((Vector3d(std::stod(list[i][0]), std::stod(list[i][1]), std::stod(list[i][2])) - utm.at(list[i][6])).norm(), 1e-3);
    EXPECT_LT((Vector2d(std::stod(list[i][3]) + 0.5, std::stod(list[i][4]) + 0.5) - marks.at({list[i][5], list[i][6]})).norm(), 1e-2);
  }
  const auto opensfm = base::ParseJson(base::ReadFile(Root() / "control/ground_control_points.json"));
  ASSERT_EQ(opensfm["points"].size(), 9U);
  for (const auto& point : opensfm["points"]) {
    const auto& at = point["position"];
    EXPECT_LT((crs.FromGeodetic({at["latitude"], at["longitude"], at["altitude"]}) - utm.at(point["id"])).norm(), 1e-3);
    for (const auto& seen : point["observations"]) {
      const Vector2d pixel = size * Pair(seen["projection"]) + 0.5 * Vector2d(Lens().width, Lens().height);
      EXPECT_LT((pixel - marks.at({seen["shot_id"], point["id"]})).norm(), 1e-2);
    }
  }
  const auto metashape = Fields(Root() / "control/metashape.csv", ',');
  EXPECT_EQ(metashape[0], (std::vector<std::string>{"label", "x", "y", "z"}));
  EXPECT_EQ(metashape.size(), 10U);
  const std::string xml = base::ReadFile(Root() / "control/metashape_marks.xml");
  EXPECT_EQ(base::FindAll(xml, "<location camera_id=\"(\\d+)\" pinned=\"true\" x=\"([^\"]+)\" y=\"([^\"]+)\"/>").size(), marks.size());
}

// Targets in the middle of a made-up photo that looks down from 50 m.
struct Invented {
  camera::Camera camera;
  std::vector<PhotoPlan> photos;
  std::vector<ControlTarget> targets;

  explicit Invented(int n_targets) {
    camera.model = camera::CameraModel::kSimplePinhole;
    camera.width = 640;
    camera.height = 480;
    camera.params = {500.0, 320.0, 240.0};
    for (int i = 0; i < 8; ++i) {
      PhotoPlan photo;
      photo.name = "IMG_000" + std::to_string(i) + ".jpg";
      photo.cam_from_enu = PoseFromGimbal({0.5 * i, 0.0, 50.0}, 10.0 * i, -90.0, 0.0);
      photos.push_back(photo);
    }
    for (int i = 0; i < n_targets; ++i) {
      ControlTarget target;
      target.check = i % 2 == 1;
      target.label = (target.check ? "check" : "gcp") + std::to_string(i / 2 + 1);
      target.position = {0.02 * i, 3.0, 1.0};
      target.photos = {0, 1, 2, 3, 4, 5, 6, 7};
      targets.push_back(target);
    }
  }
};

TEST(ControlMarks, NoiseHasTheStandardDeviationAskedFor) {
  const Invented made(400);
  SimulateOptions options;
  options.control_mark_noise_px = 0.8;
  double sum2 = 0.0;
  Vector2d sum = Vector2d::Zero();
  int n = 0;
  for (const SurveyedTarget& point : SurveyTargets(made.targets, options, made.camera, made.photos, 3)) {
    ASSERT_EQ(point.marks.size(), 5U);
    for (size_t i = 1; i < 5; ++i) EXPECT_LT(point.marks[i - 1].photo, point.marks[i].photo);
    for (const TargetMark& mark : point.marks) {
      const Vector2d error = mark.pixel - mark.true_pixel;
      sum += error;
      sum2 += error.squaredNorm();
      n += 2;
    }
  }
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.8, 0.04);
  EXPECT_LT((2.0 * sum / n).norm(), 0.08);
}

TEST(ControlMarks, WrongPointsAndMarksAreWrongByAsMuchAsAskedFor) {
  const Invented made(20);
  SimulateOptions options;
  options.control_wrong_points = 2;
  options.control_wrong_m = 5.0;
  options.control_wrong_marks = 3;
  const std::vector<SurveyedTarget> points = SurveyTargets(made.targets, options, made.camera, made.photos, 3);
  int n_points = 0, n_marks = 0;
  for (const SurveyedTarget& point : points) {
    EXPECT_NEAR((point.given - point.target.position).norm(), point.wrong ? 5.0 : 0.0, 1e-9);
    n_points += point.wrong ? 1 : 0;
    int here = 0;
    for (const TargetMark& mark : point.marks) {
      const double error_px = (mark.pixel - mark.true_pixel).norm();
      if (mark.wrong) {
        EXPECT_GE(error_px, 0.03 * 640 - 1e-9);
        EXPECT_LE(error_px, 0.08 * 640 + 1e-9);
        ++here;
      } else {
        EXPECT_LT(error_px, 3.5);
      }
    }
    EXPECT_LE(here, 1);
    EXPECT_TRUE(here == 0 || (!point.wrong && !point.target.check));
    EXPECT_FALSE(point.wrong && point.target.check);
    n_marks += here;
  }
  EXPECT_EQ(n_points, 2);
  EXPECT_EQ(n_marks, 3);
}

// US survey feet in New York: heights too, as the system has no heights of its own.
TEST(ControlWriter, FeetAreFeetInAllThreeDirections) {
  const TemporaryFolder folder;
  const Invented made(4);
  const geo::EnuFrame frame({40.7, -74.0, 30.0});
  ControlFiles files{SurveyTargets(made.targets, SimulateOptions(), made.camera, made.photos, 1), {}, made.camera, "EPSG:2263"};
  for (const PhotoPlan& photo : made.photos) files.photos.push_back(photo.name);
  WriteControlFiles(files, frame, folder.path());
  const auto table = Fields(folder.path() / "control/pix4d.csv", ',');
  ASSERT_EQ(table.size(), 4U);
  // Longitude 74 W is the central meridian, at 300 km; latitude 40.7 N is 59 km north of the origin.
  constexpr double kFoot_m = 1200.0 / 3937.0;
  EXPECT_NEAR(std::stod(table[0][1]) * kFoot_m, 300000.0, 1.0);
  EXPECT_NEAR(std::stod(table[0][2]) * kFoot_m, 59220.0, 200.0);
  EXPECT_NEAR(std::stod(table[0][3]) * kFoot_m, 31.0, 1e-3);
}

TEST(ControlOptions, CoordinateSystemsThatCannotBeUsedAreRefused) {
  SimulateOptions options;
  options.control_crs = "EPSG:2263";
  EXPECT_NO_THROW(options.Check());
  for (const char* bad : {"EPSG:1", "EPSG:32632\nx"}) {
    options.control_crs = bad;
    EXPECT_THROW(options.Check(), base::UsageError) << bad;
  }
}

}  // namespace
}  // namespace skyquilt::simulate
