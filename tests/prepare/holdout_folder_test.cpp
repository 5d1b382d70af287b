// The whole preparation with prepare.holdout_poses, of photos and a COLMAP model in a folder.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "core/image/image.h"
#include "core/survey/exif.h"
#include "prepare/prepare.h"
#include "tests/prepare/control/fit/made_control.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

// 20 photos. Every fifth is held out: images 1, 6, 11 and 16, photo_100.jpg, photo_105.jpg, photo_110.jpg and photo_115.jpg.
const test::MadeControl& MadeFolder() {
  static base::ThreadPool threads(2);
  static const test::MadeControl made =
      test::MakeControl({.survey = {.strips = 4, .per_strip = 5, .gps_noise_m = 0.3, .gps_height_noise_m = 0.3, .gimbal_tags = false},
                         .control = 8,
                         .check = 4,
                         .marks = 6},
                        threads);
  return made;
}

const std::set<uint32_t>& HeldOutImages() {
  static const std::set<uint32_t> ids = {1, 6, 11, 16};
  return ids;
}

bool IsHeldOut(const std::string& name) {
  for (const uint32_t id : HeldOutImages()) {
    if (name == fmt::format("photo_{}.jpg", 99 + id)) return true;
  }
  return false;
}

// What held-out photos could do to the others: other features, poses, tags and marks of control points.
void ChangeHeldOut(test::MadeControl& made) {
  const geo::EnuFrame frame(test::kMadeOrigin);
  for (size_t i = 0; i < made.model.images.size(); ++i) {
    survey::ColmapImage& image = made.model.images[i];
    if (!HeldOutImages().contains(image.id)) continue;
    image.cam_from_world.translation += Eigen::Vector3d(3.0, -2.0, 5.0);
    made.photos[i].gps = frame.GeodeticFromEnu(frame.EnuFromGeodetic(*made.photos[i].gps) + Eigen::Vector3d(4.0, 3.0, 2.0));
    double k = 0.0;
    for (survey::ColmapObservation& seen : made.observations.at(image.id)) {
      k += 1.0;
      seen.pixel += Eigen::Vector2d(12.0 + std::sin(k), -9.0 + std::cos(k));
    }
  }
  for (control::ControlPoint& point : made.control.points) {
    for (control::ControlMark& mark : point.marks) {
      if (IsHeldOut(mark.photo)) mark.pixel += Eigen::Vector2d(2.0, 2.0);
    }
  }
}

// The photo is left with so many observations.
void Blind(uint32_t id, size_t n_left, test::MadeControl& made) {
  std::vector<survey::ColmapObservation>& seen = made.observations.at(id);
  ASSERT_GT(seen.size(), n_left);
  seen.resize(n_left);
  std::set<uint64_t> points;
  for (const survey::ColmapObservation& one : seen) points.insert(one.point_id);
  for (survey::ColmapPoint& point : made.model.points) {
    if (!points.contains(point.id)) std::erase(point.image_ids, id);
  }
  std::erase_if(made.model.points, [](const survey::ColmapPoint& point) { return point.image_ids.size() < 2; });
  points.clear();
  for (const survey::ColmapPoint& point : made.model.points) points.insert(point.id);
  for (auto& [image, observations] : made.observations) {
    std::erase_if(observations, [&](const survey::ColmapObservation& one) { return !points.contains(one.point_id); });
  }
}

class HoldoutFolder : public ::testing::Test {
 protected:
  HoldoutFolder() {
    options_.holdout = "every:5";
    options_.holdout_poses = "resected";
  }

  void Write(const test::MadeControl& made, const fs::path& folder) const {
    fs::create_directories(folder / "images");
    fs::create_directories(folder / "sparse/0");
    const image::Image8 pixels(1600, 1200, 3, 100);
    for (size_t i = 0; i < made.photos.size(); ++i) {
      const fs::path file = folder / "images" / made.photos[i].file.name;
      image::SaveJpeg(pixels, file, 50);
      survey::PhotoTags tags;
      tags.gps = made.photos[i].gps;
      tags.absolute_altitude_m = tags.gps->height_m;
      tags.capture_time_s = 1466699519.0 + 5.0 * static_cast<double>(i);
      survey::WritePhotoTags(tags, file);
    }
    survey::WriteColmapBinary(made.model, made.observations, folder / "sparse/0");
    std::string list = "EPSG:4326\n";
    for (const control::ControlPoint& point : made.control.points) {
      for (const control::ControlMark& mark : point.marks) {
        list += fmt::format("{:.12f} {:.12f} {:.6f} {:.6f} {:.6f} {} {}\n", point.place.longitude_deg, point.place.latitude_deg, point.place.height_m,
                            mark.pixel.x() - 0.5, mark.pixel.y() - 0.5, mark.photo, point.label);
      }
    }
    base::WriteFileAtomically(folder / "gcp_list.txt", list);
  }
  survey::Survey Run(const test::MadeControl& made, const std::string& name) {
    const fs::path folder = folder_ / name;
    Write(made, folder);
    if (by_control_) options_.gcp = (folder / "gcp_list.txt").string();
    return Prepare({folder / "images", folder / "sparse/0", folder / "out"}, options_, threads_);
  }

  TemporaryFolder folder_;
  PrepareOptions options_;
  bool by_control_ = false;
  base::ThreadPool threads_{2};
};

// Everything that leads to a scene.
void ExpectSameTraining(const survey::Survey& a, const survey::Survey& b) {
  ASSERT_EQ(a.photos.size(), b.photos.size());
  for (size_t i = 0; i < a.photos.size(); ++i) {
    EXPECT_EQ(a.photos[i].is_test, IsHeldOut(a.photos[i].name));
    EXPECT_EQ(a.photos[i].is_test, b.photos[i].is_test);
    if (a.photos[i].is_test) continue;
    EXPECT_EQ(a.photos[i].cam_from_enu.rotation.coeffs(), b.photos[i].cam_from_enu.rotation.coeffs()) << a.photos[i].name;
    EXPECT_EQ(a.photos[i].cam_from_enu.translation, b.photos[i].cam_from_enu.translation) << a.photos[i].name;
    EXPECT_EQ(a.photos[i].agl_m, b.photos[i].agl_m);
    EXPECT_EQ(a.photos[i].gps_residual_m, b.photos[i].gps_residual_m);
  }
  ASSERT_EQ(a.cameras.size(), 1U);
  EXPECT_EQ(a.cameras[0].params, b.cameras[0].params);
  ASSERT_EQ(a.points.size(), b.points.size());
  ASSERT_EQ(a.kept_points.size(), b.kept_points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].x_in_enu, b.points[i].x_in_enu);
    EXPECT_EQ(a.points[i].error_px, b.points[i].error_px);
  }
  EXPECT_EQ(a.tracks, b.tracks);
}

size_t CountHeldOut(const survey::Survey& survey, const survey::PointTracks& tracks) {
  size_t n = 0;
  for (size_t i = 0; i < tracks.points(); ++i) {
    for (const int32_t photo : tracks.PhotosOf(i)) n += survey.photos[static_cast<size_t>(photo)].is_test ? 1 : 0;
  }
  return n;
}

TEST_F(HoldoutFolder, PlacedByTagsHeldOutPhotosChangeNothingElse) {
  test::MadeControl changed = MadeFolder();
  ChangeHeldOut(changed);
  const survey::Survey survey = Run(MadeFolder(), "as_found"), other = Run(changed, "changed");
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_EQ(survey.photos.size(), 20U);
  EXPECT_GT(survey.points.size(), 300U);
  ExpectSameTraining(survey, other);
  EXPECT_NE(survey.photos[5].cam_from_enu.translation, other.photos[5].cam_from_enu.translation);

  EXPECT_TRUE(survey.resected_holdout);
  EXPECT_TRUE(survey::LoadSurvey(folder_ / "as_found/out").resected_holdout);
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) continue;
    EXPECT_FALSE(photo.gps_inlier);
    EXPECT_LT(photo.gps_residual_m, 3.0) << photo.name;
    EXPECT_NEAR(photo.agl_m, 80.0, 20.0);
  }
  // Scores compare the kept points from held-out photos, too.
  EXPECT_EQ(CountHeldOut(survey, survey.tracks), 0U);
  EXPECT_GT(CountHeldOut(survey, survey.kept_tracks), 10U);

  // Where the given poses are kept, the same changes are seen.
  options_.holdout_poses = "given";
  const survey::Survey given = Run(MadeFolder(), "given"), given_changed = Run(changed, "given_changed");
  EXPECT_FALSE(given.resected_holdout);
  EXPECT_NE(given.photos[1].cam_from_enu.translation, given_changed.photos[1].cam_from_enu.translation);
}

TEST_F(HoldoutFolder, PlacedByControlPointsTheirMarksDoNotCount) {
  test::MadeControl changed = MadeFolder();
  ChangeHeldOut(changed);
  by_control_ = true;
  const survey::Survey survey = Run(MadeFolder(), "as_found"), other = Run(changed, "changed");
  ASSERT_TRUE(survey.control.placed && survey.control.adjusted);
  ExpectSameTraining(survey, other);
  ASSERT_EQ(survey.control.points.size(), other.control.points.size());
  size_t n_held_out = 0;
  for (size_t i = 0; i < survey.control.points.size(); ++i) {
    const survey::ControlPointFit& point = survey.control.points[i];
    if (std::isfinite(point.error_px)) EXPECT_EQ(point.error_px, other.control.points[i].error_px);
    for (const survey::ControlMarkFit& mark : point.marks) {
      if (!IsHeldOut(mark.photo)) continue;
      ++n_held_out;
      EXPECT_FALSE(mark.used);
      EXPECT_TRUE(std::isnan(mark.error_px));
    }
  }
  EXPECT_GT(n_held_out, 3U);

  options_.holdout_poses = "given";
  const survey::Survey given = Run(MadeFolder(), "given"), given_changed = Run(changed, "given_changed");
  EXPECT_NE(given.photos[1].cam_from_enu.translation, given_changed.photos[1].cam_from_enu.translation);
}

TEST_F(HoldoutFolder, AHeldOutPhotoThatSeesTooLittleIsNotUsedAndTheOthersStayHeldOut) {
  test::MadeControl made = MadeFolder();
  Blind(6, 20, made);
  const survey::Survey survey = Run(made, "one");
  EXPECT_EQ(survey.unregistered, std::vector<std::string>{"photo_105.jpg"});
  ASSERT_EQ(survey.photos.size(), 19U);
  for (const survey::Photo& photo : survey.photos) EXPECT_EQ(photo.is_test, IsHeldOut(photo.name)) << photo.name;

  for (const uint32_t id : {1U, 11U, 16U}) Blind(id, 20, made);
  const std::string message = UsageErrorOf([&] { Run(made, "all"); });
  EXPECT_NE(message.find("none of the 4 held-out photos"), std::string::npos) << message;
  EXPECT_NE(message.find("prepare.holdout_poses"), std::string::npos) << message;
}

TEST_F(HoldoutFolder, WithoutObservationsOrInAnExactFrameTheGivenPosesStay) {
  // A model without observations of its points.
  test::MadeControl blind = MadeFolder();
  for (auto& [image, seen] : blind.observations) seen.clear();
  for (survey::ColmapPoint& point : blind.model.points) point.image_ids.clear();
  Write(blind, folder_ / "blind");
  const auto run = [&](const PrepareInput& input, const std::string& poses) {
    options_.holdout_poses = poses;
    return Prepare(input, options_, threads_);
  };
  const auto expect_given = [&](const fs::path& photos, const fs::path& model) {
    const survey::Survey given = run({photos, model, folder_ / "given"}, "given");
    const survey::Survey survey = run({photos, model, folder_ / "resected"}, "resected");
    EXPECT_FALSE(survey.resected_holdout);
    ASSERT_EQ(survey.photos.size(), 20U);
    for (size_t i = 0; i < survey.photos.size(); ++i) {
      EXPECT_EQ(survey.photos[i].is_test, i % 5 == 0);
      EXPECT_EQ(survey.photos[i].cam_from_enu.translation, given.photos[i].cam_from_enu.translation);
    }
    EXPECT_EQ(survey.points.size(), given.points.size());
  };
  expect_given(folder_ / "blind/images", folder_ / "blind/sparse/0");
  // A simulated survey, whose poses are the true ones.
  Write(MadeFolder(), folder_ / "exact");
  base::WriteFileAtomically(folder_ / "exact/simulate.json",
                            R"({"origin":{"latitude_deg":47.3,"longitude_deg":8.5,"height_m":500.0},"exact_frame":true})");
  expect_given(folder_ / "exact", {});
}

}  // namespace
}  // namespace skyquilt::prepare
