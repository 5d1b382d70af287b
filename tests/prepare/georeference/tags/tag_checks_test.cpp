#include "prepare/georeference/tags/tag_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/geo/enu_frame.h"
#include "prepare/georeference/georeference.h"
#include "tests/prepare/georeference/lawnmower_photos.h"
#include "tests/support/not_finite.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector3d;

std::vector<input::PreparedPhoto> WithHeights(const std::vector<double>& height_m, std::optional<double> relative_altitude_m = {}) {
  std::vector<input::PreparedPhoto> photos(height_m.size());
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].gps = geo::Geodetic{47.0 + 1e-4 * static_cast<double>(i), 8.0, height_m[i]};
    photos[i].file.tags.relative_altitude_m = relative_altitude_m;
  }
  return photos;
}

// Photos on a lawnmower around `origin` with tags that have the noise of a receiver.
std::vector<input::PreparedPhoto> Tagged(const geo::Geodetic& origin, uint64_t seed) {
  base::Random random(seed);
  std::vector<input::PreparedPhoto> photos = test::LawnmowerPhotos(40, test::RandomFrame(random));
  const geo::EnuFrame frame(origin);
  for (int i = 0; i < 40; ++i) {
    input::PreparedPhoto& photo = photos[static_cast<size_t>(i)];
    photo.file.name = "photo_" + std::to_string(i) + ".jpg";
    photo.gps = frame.GeodeticFromEnu(test::OnLawnmower(i, 40) + Vector3d{random.Normal(), random.Normal(), random.Normal()});
    photo.up_in_cam = input::UpInCamera(-90.0, 0.0);
  }
  return photos;
}

bool Has(const Georeference& result, const std::string& code) {
  for (const survey::Problem& problem : result.problems) {
    if (problem.code == code) return true;
  }
  return false;
}

TEST(JudgeHeights, TellsTaggedFromRelativeAndUnknown) {
  EXPECT_EQ(JudgeHeights(WithHeights({400.0, 400.3, 399.9})), HeightTags::kTagged);
  EXPECT_EQ(JudgeHeights(WithHeights({400.0, kNan, 399.9})), HeightTags::kTagged);
  EXPECT_EQ(JudgeHeights(WithHeights({0.0, 0.0, 0.0})), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights(WithHeights({120.0, 120.0, 120.0})), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights(WithHeights({kNan, kNan, kNan})), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights(WithHeights({kNan, kNan, kNan}, 60.0)), HeightTags::kRelative);
  EXPECT_EQ(JudgeHeights(WithHeights({0.0, 0.0, 0.0}, 60.0)), HeightTags::kRelative);
  EXPECT_EQ(JudgeHeights(WithHeights({kNan, kNan, kNan}, 0.0)), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights(WithHeights({400.0, 401.0, 402.0}, 60.0)), HeightTags::kTagged);
  std::vector<input::PreparedPhoto> half = WithHeights({kNan, kNan, kNan, kNan}, 60.0);
  half[0].file.tags.relative_altitude_m.reset();
  half[1].file.tags.relative_altitude_m.reset();
  EXPECT_EQ(JudgeHeights(half), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights({}), HeightTags::kUnknown);
}

std::vector<input::PreparedPhoto> AtOneSpot(const std::vector<double>& height_m, std::optional<double> relative_altitude_m = {}) {
  std::vector<input::PreparedPhoto> photos = WithHeights(height_m, relative_altitude_m);
  for (input::PreparedPhoto& photo : photos) photo.gps->latitude_deg = 47.0;
  return photos;
}

TEST(AllTagsEqual, AllowsAMetreInAllDirections) {
  EXPECT_FALSE(AllTagsEqual(WithHeights({0.0, 100.0, kNan, 0.0})));
  std::vector<input::PreparedPhoto> photos = AtOneSpot({400.0, 400.6, kNan, 399.7});
  EXPECT_TRUE(AllTagsEqual(photos));
  photos[1].gps->longitude_deg += 1e-6;  // 8 cm
  photos[2].gps.reset();
  EXPECT_TRUE(AllTagsEqual(photos));
  photos[3].gps->longitude_deg += 2e-5;  // 1.5 m
  EXPECT_FALSE(AllTagsEqual(photos));
  EXPECT_FALSE(TagsAboveOneAnother(photos));
  for (size_t i = 0; i < 4; ++i) photos[i].gps = geo::Geodetic{-17.0, i % 2 == 0 ? 180.0 : -180.0, 0.0};
  EXPECT_TRUE(AllTagsEqual(photos));
}

TEST(AllTagsEqual, TagsAboveOneAnotherDiffer) {
  EXPECT_FALSE(AllTagsEqual(AtOneSpot({400.0, 410.0, kNan, 420.0})));
  EXPECT_TRUE(TagsAboveOneAnother(AtOneSpot({400.0, 410.0, kNan, 420.0})));
  // Three exposures of each of three shots.
  EXPECT_FALSE(AllTagsEqual(AtOneSpot({400.0, 400.0, 400.0, 402.0, 402.0, 402.0, 404.0, 404.0, 404.0})));
  EXPECT_TRUE(AllTagsEqual(AtOneSpot({400.0, 400.0, 400.0})));
  // Heights above take-off count where tags have no other; not where these say nothing.
  std::vector<input::PreparedPhoto> relative = AtOneSpot({kNan, kNan, kNan}, 10.0);
  EXPECT_TRUE(AllTagsEqual(relative));
  relative[2].file.tags.relative_altitude_m = 30.0;
  EXPECT_FALSE(AllTagsEqual(relative));
  for (input::PreparedPhoto& photo : relative) photo.gps->height_m = 0.0;
  EXPECT_FALSE(AllTagsEqual(relative));
  EXPECT_TRUE(AllTagsEqual(AtOneSpot({kNan, kNan, kNan})));
}

TEST(PossibleCoordinateFaults, RepairTheTagsAndStayOnEarth) {
  const std::vector<input::PreparedPhoto> photos = WithHeights({1.0, 2.0});
  const std::vector<CoordinateFault> faults = PossibleCoordinateFaults(photos);
  ASSERT_EQ(faults.size(), 2U);
  const geo::Geodetic expected[] = {{8.0, 47.0, 1.0}, {47.0, -8.0, 1.0}};
  const char* const codes[] = {"swapped_coordinates", "mirrored_coordinates"};
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(faults[i].problem.code, codes[i]);
    EXPECT_TRUE(faults[i].problem.about_place);
    EXPECT_FALSE(faults[i].problem.finding.ends_with("."));
    EXPECT_FALSE(faults[i].problem.advice.ends_with("."));
    EXPECT_EQ(faults[i].repaired[0].gps->latitude_deg, expected[i].latitude_deg);
    EXPECT_EQ(faults[i].repaired[0].gps->longitude_deg, expected[i].longitude_deg);
    EXPECT_EQ(faults[i].repaired[0].gps->height_m, expected[i].height_m);
  }
  std::vector<input::PreparedPhoto> far_east = photos;
  for (input::PreparedPhoto& photo : far_east) photo.gps->longitude_deg = 151.0;  // no latitude
  far_east[0].gps.reset();
  const std::vector<CoordinateFault> possible = PossibleCoordinateFaults(far_east);
  ASSERT_EQ(possible.size(), 1U);
  EXPECT_EQ(possible[0].problem.code, "mirrored_coordinates");
}

TEST(PlaceOnEarth, NamesCoordinatesWrittenWrongly) {
  const std::pair<const char*, geo::Geodetic (*)(const geo::Geodetic&)> faults[] = {
      {"swapped_coordinates",
       [](const geo::Geodetic& p) {
         return geo::Geodetic{p.longitude_deg, p.latitude_deg, p.height_m};
       }},
      {"mirrored_coordinates",
       [](const geo::Geodetic& p) {
         return geo::Geodetic{p.latitude_deg, -p.longitude_deg, p.height_m};
       }},
      {"mirrored_coordinates", [](const geo::Geodetic& p) {
         return geo::Geodetic{-p.latitude_deg, p.longitude_deg, p.height_m};
       }}};
  // Near the equator a swap differs little from a mirror image.
  for (const geo::Geodetic& origin : {geo::Geodetic{37.0, -60.0, 400.0}, geo::Geodetic{10.0, 20.0, 400.0}}) {
    EXPECT_TRUE(PlaceOnEarth(Tagged(origin, 1), {}, {}).problems.empty());
    for (const auto& [code, apply] : faults) {
      std::vector<input::PreparedPhoto> photos = Tagged(origin, 2);
      for (input::PreparedPhoto& photo : photos) photo.gps = apply(*photo.gps);
      const Georeference result = PlaceOnEarth(photos, {}, {});
      EXPECT_FALSE(result.ok) << code;
      ASSERT_EQ(result.problems.size(), 1U) << code;
      EXPECT_EQ(result.problems[0].code, code);
      EXPECT_TRUE(result.problems[0].about_place);
      EXPECT_EQ(result.fit.n_matches, 40);
    }
  }
}

TEST(PlaceOnEarth, SaysWhyThereIsNoPlace) {
  std::vector<input::PreparedPhoto> photos = Tagged({47.0, 8.0, 400.0}, 3);
  const geo::Geodetic first = *photos[0].gps;
  for (input::PreparedPhoto& photo : photos) photo.gps = first;
  const Georeference equal = PlaceOnEarth(photos, {}, {});
  EXPECT_FALSE(equal.ok);
  EXPECT_TRUE(Has(equal, "equal_tags"));
  for (size_t i = 3; i < photos.size(); ++i) photos[i].gps.reset();
  EXPECT_TRUE(Has(PlaceOnEarth(photos, {}, {}), "too_few_tags"));
  for (input::PreparedPhoto& photo : photos) photo.gps.reset();
  EXPECT_TRUE(Has(PlaceOnEarth(photos, {}, {}), "no_gps"));
  EXPECT_TRUE(Has(PlaceOnEarth({}, {}, {}), "no_gps"));

  base::Random random(4);
  photos = Tagged({47.0, 8.0, 400.0}, 5);
  for (input::PreparedPhoto& photo : photos) {
    photo.gps->latitude_deg += 0.1 * random.Normal();
    photo.gps->longitude_deg += 0.1 * random.Normal();
  }
  const Georeference scattered = PlaceOnEarth(photos, {}, {});
  EXPECT_FALSE(scattered.ok);
  ASSERT_FALSE(scattered.problems.empty());
  EXPECT_TRUE(scattered.problems[0].about_place);
}

// Photos of a facade from twenty heights 2 m apart, level cameras, within `reach_m` of a vertical line. The tags have noise of `noise_m`.
std::vector<input::PreparedPhoto> Column(double reach_m, double noise_m, uint64_t seed) {
  base::Random random(seed);
  const geo::Similarity3d model_from_enu = test::RandomFrame(random);
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  std::vector<input::PreparedPhoto> photos;
  for (int i = 0; i < 20; ++i) {
    const Vector3d centre(i % 4 < 2 ? reach_m : -reach_m, i % 2 == 0 ? reach_m : -reach_m, 10.0 + 2.0 * i);
    photos.push_back(test::PreparedAt(centre, {.yaw_deg = 30.0, .pitch_deg = 0.0}, model_from_enu));
    photos.back().file.name = "facade_" + std::to_string(i) + ".jpg";
    photos.back().up_in_cam = input::UpInCamera(0.0, 0.0);
    const double east = noise_m * random.Normal(), north = noise_m * random.Normal(), up = noise_m * random.Normal();
    photos.back().gps = frame.GeodeticFromEnu(centre + Vector3d(east, north, up));
  }
  return photos;
}

TEST(PlaceOnEarth, PhotosAboveOneAnotherLeaveNorthOpen) {
  const auto expect_column = [](const std::vector<input::PreparedPhoto>& photos, const char* what) {
    const Georeference result = PlaceOnEarth(photos, {}, {});
    EXPECT_FALSE(result.ok) << what;
    ASSERT_EQ(result.problems.size(), 1U) << what;
    EXPECT_EQ(result.problems[0].code, "one_column") << what << ": " << result.problems[0].finding;
    EXPECT_TRUE(result.problems[0].about_place);
    EXPECT_EQ(result.fit.n_matches, static_cast<int>(photos.size()));
  };
  expect_column(Column(0.1, 0.1, 11), "tags within a metre of a line");
  expect_column(Column(0.1, 1.0, 12), "tags with the noise of a receiver");
  std::vector<input::PreparedPhoto> photos = Column(0.1, 0.1, 13);
  for (input::PreparedPhoto& photo : photos) photo.gps->height_m = kNan;
  expect_column(photos, "tags without heights");
  for (size_t i = 0; i < photos.size(); ++i) photos[i].file.tags.relative_altitude_m = 2.0 * static_cast<double>(i);
  expect_column(photos, "heights above take-off");
}

TEST(PlaceOnEarth, AWallThatIsTakenForTheGroundDoesNotHideAColumn) {
  std::vector<input::PreparedPhoto> photos = Column(0.1, 0.1, 18);
  for (input::PreparedPhoto& photo : photos) photo.up_in_cam.reset();
  base::Random random(18), place(19);
  const geo::Similarity3d model_from_enu = test::RandomFrame(random);
  std::vector<Vector3d> wall;
  for (int i = 0; i < 300; ++i) {
    const double along = place.Uniform(-20.0, 20.0), up = place.Uniform(0.0, 60.0);
    // 25 m ahead of the cameras, at right angles to their view.
    wall.push_back(model_from_enu * Vector3d(12.5 + 0.866 * along, 21.65 - 0.5 * along, up));
  }
  const Georeference result = PlaceOnEarth(photos, wall, {});
  EXPECT_FALSE(result.ok);
  EXPECT_TRUE(Has(result, "one_column"));
}

TEST(PlaceOnEarth, AColumnWhoseTagsAreMoreExactThanItsWidthHasAPlace) {
  const Georeference result = PlaceOnEarth(Column(2.0, 0.02, 14), {}, {});
  EXPECT_TRUE(result.ok);
  EXPECT_LT(result.fit.accuracy.yaw_deg, 1.0);
  EXPECT_FALSE(Has(result, "one_column"));
}

TEST(PlaceOnEarth, APositionThatStandsStillWhileTheBarometerGoesOnIsNoColumn) {
  std::vector<input::PreparedPhoto> photos = Tagged({47.0, 8.0, 400.0}, 15);
  base::Random random(16);
  const geo::Geodetic first = *photos[0].gps;
  for (input::PreparedPhoto& photo : photos)
    photo.gps = geo::Geodetic{first.latitude_deg, first.longitude_deg, first.height_m + 3.0 * random.Normal()};
  const Georeference result = PlaceOnEarth(photos, {}, {});
  EXPECT_FALSE(result.ok);
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_EQ(result.problems[0].code, "equal_tags");
  EXPECT_NE(result.problems[0].finding.find("differ in height alone"), std::string::npos) << result.problems[0].finding;
  // Not even when the cameras are on one line.
  const Georeference line = PlaceOnEarth({photos.begin(), photos.begin() + test::kLine}, {}, {});
  EXPECT_FALSE(line.ok);
  EXPECT_TRUE(Has(line, "equal_tags"));
  // Tags with heights that all but agree are those of one place.
  std::vector<input::PreparedPhoto> hovering = Column(0.1, 0.1, 17);
  for (input::PreparedPhoto& photo : hovering) photo.gps->height_m = 400.0 + 0.1 * random.Normal();
  EXPECT_TRUE(Has(PlaceOnEarth(hovering, {}, {}), "equal_tags"));
}

TEST(PlaceOnEarth, NamesAStraightLineAndMissingHeights) {
  std::vector<input::PreparedPhoto> photos = Tagged({47.0, 8.0, 400.0}, 6);
  const std::vector<input::PreparedPhoto> line(photos.begin(), photos.begin() + test::kLine);
  const Georeference on_line = PlaceOnEarth(line, {}, {});
  EXPECT_TRUE(on_line.ok);
  EXPECT_TRUE(Has(on_line, "one_line"));

  for (input::PreparedPhoto& photo : photos) photo.gps->height_m = 0.0;
  const Georeference zero = PlaceOnEarth(photos, {}, {});
  EXPECT_TRUE(zero.ok);
  EXPECT_TRUE(Has(zero, "no_heights"));
  EXPECT_TRUE(std::isnan(zero.fit.accuracy.vertical_m));
  EXPECT_LT(zero.fit.accuracy.tilt_deg, 0.6);
  for (const input::PreparedPhoto& photo : photos) EXPECT_NEAR((zero.enu_from_model * photo.cam_from_model.OriginInSource()).z(), 0.0, 2.0);

  for (input::PreparedPhoto& photo : photos) photo.file.tags.relative_altitude_m = 60.0;
  const Georeference relative = PlaceOnEarth(photos, {}, {});
  EXPECT_TRUE(Has(relative, "no_heights"));
  for (const input::PreparedPhoto& photo : photos) EXPECT_NEAR((relative.enu_from_model * photo.cam_from_model.OriginInSource()).z(), 60.0, 2.0);
}

TEST(PlaceOnEarth, SaysWhenFewTagsAgree) {
  std::vector<input::PreparedPhoto> photos = Tagged({47.0, 8.0, 400.0}, 7);
  base::Random random(8);
  for (size_t i = 0; i < photos.size(); ++i) {
    if (i % 5 >= 2) photos[i].gps->latitude_deg += random.Uniform(5e-4, 5e-3) * (i % 2 == 0 ? 1.0 : -1.0);
  }
  const Georeference result = PlaceOnEarth(photos, {}, {});
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(result.fit.n_inliers, 16);
  EXPECT_TRUE(Has(result, "few_tags_agree"));
  EXPECT_FALSE(Has(result, "tags_disagree"));
}

TEST(CoordinateFaults, NameTheFileThatThePositionsComeFrom) {
  std::vector<input::PreparedPhoto> photos = WithHeights({400.0, 401.0, 402.0});
  const std::vector<CoordinateFault> of_tags = PossibleCoordinateFaults(photos);
  ASSERT_FALSE(of_tags.empty());
  EXPECT_NE(of_tags[0].problem.advice.find("exiftool"), std::string::npos);
  for (size_t i = 0; i < 2; ++i) photos[i].file.tags.position_file = "survey/geo.txt";
  for (const CoordinateFault& fault : PossibleCoordinateFaults(photos)) {
    EXPECT_NE(fault.problem.finding.find("survey/geo.txt"), std::string::npos) << fault.problem.finding;
    EXPECT_EQ(fault.problem.advice.find("exiftool"), std::string::npos) << fault.problem.advice;
  }
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
