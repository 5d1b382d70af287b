#include "prepare/georeference/tags/tag_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/geo/enu_frame.h"
#include "prepare/georeference/georeference.h"
#include "tests/prepare/georeference/made_stations.h"
#include "tests/support/not_finite.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector3d;

std::vector<input::Station> WithHeights(const std::vector<double>& height_m, std::optional<double> relative_altitude_m = {}) {
  std::vector<input::Station> stations(height_m.size());
  for (size_t i = 0; i < stations.size(); ++i) {
    stations[i].gps = geo::Geodetic{47.0 + 1e-4 * static_cast<double>(i), 8.0, height_m[i]};
    stations[i].relative_altitude_m = relative_altitude_m;
  }
  return stations;
}

// Photos on a lawnmower around `origin` with tags that have the noise of a receiver.
std::vector<input::Station> Tagged(const geo::Geodetic& origin, uint64_t seed) {
  base::Random random(seed);
  std::vector<input::Station> stations = test::LawnmowerStations(40, test::RandomFrame(random));
  const geo::EnuFrame frame(origin);
  for (int i = 0; i < 40; ++i) {
    input::Station& station = stations[static_cast<size_t>(i)];
    station.name = "photo_" + std::to_string(i) + ".jpg";
    station.gps = frame.GeodeticFromEnu(test::OnLawnmower(i, 40) + Vector3d{random.Normal(), random.Normal(), random.Normal()});
    station.up_in_cam = input::UpInCamera(-90.0, 0.0);
  }
  return stations;
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
  std::vector<input::Station> half = WithHeights({kNan, kNan, kNan, kNan}, 60.0);
  half[0].relative_altitude_m.reset();
  half[1].relative_altitude_m.reset();
  EXPECT_EQ(JudgeHeights(half), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights({}), HeightTags::kUnknown);
}

std::vector<input::Station> AtOneSpot(const std::vector<double>& height_m, std::optional<double> relative_altitude_m = {}) {
  std::vector<input::Station> stations = WithHeights(height_m, relative_altitude_m);
  for (input::Station& station : stations) station.gps->latitude_deg = 47.0;
  return stations;
}

TEST(AllTagsEqual, AllowsAMetreInAllDirections) {
  EXPECT_FALSE(AllTagsEqual(WithHeights({0.0, 100.0, kNan, 0.0})));
  std::vector<input::Station> stations = AtOneSpot({400.0, 400.6, kNan, 399.7});
  EXPECT_TRUE(AllTagsEqual(stations));
  stations[1].gps->longitude_deg += 1e-6;  // 8 cm
  stations[2].gps.reset();
  EXPECT_TRUE(AllTagsEqual(stations));
  stations[3].gps->longitude_deg += 2e-5;  // 1.5 m
  EXPECT_FALSE(AllTagsEqual(stations));
  EXPECT_FALSE(TagsAboveOneAnother(stations));
  for (size_t i = 0; i < 4; ++i) stations[i].gps = geo::Geodetic{-17.0, i % 2 == 0 ? 180.0 : -180.0, 0.0};
  EXPECT_TRUE(AllTagsEqual(stations));
}

TEST(AllTagsEqual, TagsAboveOneAnotherDiffer) {
  EXPECT_FALSE(AllTagsEqual(AtOneSpot({400.0, 410.0, kNan, 420.0})));
  EXPECT_TRUE(TagsAboveOneAnother(AtOneSpot({400.0, 410.0, kNan, 420.0})));
  // Three exposures of each of three shots.
  EXPECT_FALSE(AllTagsEqual(AtOneSpot({400.0, 400.0, 400.0, 402.0, 402.0, 402.0, 404.0, 404.0, 404.0})));
  EXPECT_TRUE(AllTagsEqual(AtOneSpot({400.0, 400.0, 400.0})));
  // Heights above take-off count where tags have no other; not where these say nothing.
  std::vector<input::Station> relative = AtOneSpot({kNan, kNan, kNan}, 10.0);
  EXPECT_TRUE(AllTagsEqual(relative));
  relative[2].relative_altitude_m = 30.0;
  EXPECT_FALSE(AllTagsEqual(relative));
  for (input::Station& station : relative) station.gps->height_m = 0.0;
  EXPECT_FALSE(AllTagsEqual(relative));
  EXPECT_TRUE(AllTagsEqual(AtOneSpot({kNan, kNan, kNan})));
}

TEST(PossibleCoordinateFaults, RepairTheTagsAndStayOnEarth) {
  const std::vector<input::Station> stations = WithHeights({1.0, 2.0});
  const std::vector<CoordinateFault> faults = PossibleCoordinateFaults(stations);
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
  std::vector<input::Station> far_east = stations;
  for (input::Station& station : far_east) station.gps->longitude_deg = 151.0;  // no latitude
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
      std::vector<input::Station> stations = Tagged(origin, 2);
      for (input::Station& station : stations) station.gps = apply(*station.gps);
      const Georeference result = PlaceOnEarth(stations, {}, {});
      EXPECT_FALSE(result.ok) << code;
      ASSERT_EQ(result.problems.size(), 1U) << code;
      EXPECT_EQ(result.problems[0].code, code);
      EXPECT_TRUE(result.problems[0].about_place);
      EXPECT_EQ(result.fit.n_matches, 40);
    }
  }
}

TEST(PlaceOnEarth, SaysWhyThereIsNoPlace) {
  std::vector<input::Station> stations = Tagged({47.0, 8.0, 400.0}, 3);
  const geo::Geodetic first = *stations[0].gps;
  for (input::Station& station : stations) station.gps = first;
  const Georeference equal = PlaceOnEarth(stations, {}, {});
  EXPECT_FALSE(equal.ok);
  EXPECT_TRUE(Has(equal, "equal_tags"));
  for (size_t i = 3; i < stations.size(); ++i) stations[i].gps.reset();
  EXPECT_TRUE(Has(PlaceOnEarth(stations, {}, {}), "too_few_tags"));
  for (input::Station& station : stations) station.gps.reset();
  EXPECT_TRUE(Has(PlaceOnEarth(stations, {}, {}), "no_gps"));
  EXPECT_TRUE(Has(PlaceOnEarth({}, {}, {}), "no_gps"));

  base::Random random(4);
  stations = Tagged({47.0, 8.0, 400.0}, 5);
  for (input::Station& station : stations) {
    station.gps->latitude_deg += 0.1 * random.Normal();
    station.gps->longitude_deg += 0.1 * random.Normal();
  }
  const Georeference scattered = PlaceOnEarth(stations, {}, {});
  EXPECT_FALSE(scattered.ok);
  ASSERT_FALSE(scattered.problems.empty());
  EXPECT_TRUE(scattered.problems[0].about_place);
}

// Photos of a facade from twenty heights 2 m apart, level cameras, within `reach_m` of a vertical line. The tags have noise of `noise_m`.
std::vector<input::Station> Column(double reach_m, double noise_m, uint64_t seed) {
  base::Random random(seed);
  const geo::Similarity3d model_from_enu = test::RandomFrame(random);
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  std::vector<input::Station> stations;
  for (int i = 0; i < 20; ++i) {
    const Vector3d centre(i % 4 < 2 ? reach_m : -reach_m, i % 2 == 0 ? reach_m : -reach_m, 10.0 + 2.0 * i);
    stations.push_back(test::StationAt(centre, {.yaw_deg = 30.0, .pitch_deg = 0.0}, model_from_enu));
    stations.back().name = "facade_" + std::to_string(i) + ".jpg";
    stations.back().up_in_cam = input::UpInCamera(0.0, 0.0);
    const double east = noise_m * random.Normal(), north = noise_m * random.Normal(), up = noise_m * random.Normal();
    stations.back().gps = frame.GeodeticFromEnu(centre + Vector3d(east, north, up));
  }
  return stations;
}

TEST(PlaceOnEarth, PhotosAboveOneAnotherLeaveNorthOpen) {
  const auto expect_column = [](const std::vector<input::Station>& stations, const char* what) {
    const Georeference result = PlaceOnEarth(stations, {}, {});
    EXPECT_FALSE(result.ok) << what;
    ASSERT_EQ(result.problems.size(), 1U) << what;
    EXPECT_EQ(result.problems[0].code, "one_column") << what << ": " << result.problems[0].finding;
    EXPECT_TRUE(result.problems[0].about_place);
    EXPECT_EQ(result.fit.n_matches, static_cast<int>(stations.size()));
  };
  expect_column(Column(0.1, 0.1, 11), "tags within a metre of a line");
  expect_column(Column(0.1, 1.0, 12), "tags with the noise of a receiver");
  std::vector<input::Station> stations = Column(0.1, 0.1, 13);
  for (input::Station& station : stations) station.gps->height_m = kNan;
  expect_column(stations, "tags without heights");
  for (size_t i = 0; i < stations.size(); ++i) stations[i].relative_altitude_m = 2.0 * static_cast<double>(i);
  expect_column(stations, "heights above take-off");
}

TEST(PlaceOnEarth, AWallThatIsTakenForTheGroundDoesNotHideAColumn) {
  std::vector<input::Station> stations = Column(0.1, 0.1, 18);
  for (input::Station& station : stations) station.up_in_cam.reset();
  base::Random random(18), place(19);
  const geo::Similarity3d model_from_enu = test::RandomFrame(random);
  std::vector<Vector3d> wall;
  for (int i = 0; i < 300; ++i) {
    const double along = place.Uniform(-20.0, 20.0), up = place.Uniform(0.0, 60.0);
    // 25 m ahead of the cameras, at right angles to their view.
    wall.push_back(model_from_enu * Vector3d(12.5 + 0.866 * along, 21.65 - 0.5 * along, up));
  }
  const Georeference result = PlaceOnEarth(stations, wall, {});
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
  std::vector<input::Station> stations = Tagged({47.0, 8.0, 400.0}, 15);
  base::Random random(16);
  const geo::Geodetic first = *stations[0].gps;
  for (input::Station& station : stations)
    station.gps = geo::Geodetic{first.latitude_deg, first.longitude_deg, first.height_m + 3.0 * random.Normal()};
  const Georeference result = PlaceOnEarth(stations, {}, {});
  EXPECT_FALSE(result.ok);
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_EQ(result.problems[0].code, "equal_tags");
  EXPECT_NE(result.problems[0].finding.find("differ in height alone"), std::string::npos) << result.problems[0].finding;
  // Not even when the cameras are on one line.
  const Georeference line = PlaceOnEarth({stations.begin(), stations.begin() + test::kLine}, {}, {});
  EXPECT_FALSE(line.ok);
  EXPECT_TRUE(Has(line, "equal_tags"));
  // Tags with heights that all but agree are those of one place.
  std::vector<input::Station> hovering = Column(0.1, 0.1, 17);
  for (input::Station& station : hovering) station.gps->height_m = 400.0 + 0.1 * random.Normal();
  EXPECT_TRUE(Has(PlaceOnEarth(hovering, {}, {}), "equal_tags"));
}

TEST(PlaceOnEarth, NamesAStraightLineAndMissingHeights) {
  std::vector<input::Station> stations = Tagged({47.0, 8.0, 400.0}, 6);
  const std::vector<input::Station> line(stations.begin(), stations.begin() + test::kLine);
  const Georeference on_line = PlaceOnEarth(line, {}, {});
  EXPECT_TRUE(on_line.ok);
  EXPECT_TRUE(Has(on_line, "one_line"));

  for (input::Station& station : stations) station.gps->height_m = 0.0;
  const Georeference zero = PlaceOnEarth(stations, {}, {});
  EXPECT_TRUE(zero.ok);
  EXPECT_TRUE(Has(zero, "no_heights"));
  EXPECT_TRUE(std::isnan(zero.fit.accuracy.vertical_m));
  EXPECT_LT(zero.fit.accuracy.tilt_deg, 0.6);
  for (const input::Station& station : stations) EXPECT_NEAR((zero.enu_from_model * station.cam_from_model.OriginInSource()).z(), 0.0, 2.0);

  for (input::Station& station : stations) station.relative_altitude_m = 60.0;
  const Georeference relative = PlaceOnEarth(stations, {}, {});
  EXPECT_TRUE(Has(relative, "no_heights"));
  for (const input::Station& station : stations) EXPECT_NEAR((relative.enu_from_model * station.cam_from_model.OriginInSource()).z(), 60.0, 2.0);
}

TEST(PlaceOnEarth, SaysWhenFewTagsAgree) {
  std::vector<input::Station> stations = Tagged({47.0, 8.0, 400.0}, 7);
  base::Random random(8);
  for (size_t i = 0; i < stations.size(); ++i) {
    if (i % 5 >= 2) stations[i].gps->latitude_deg += random.Uniform(5e-4, 5e-3) * (i % 2 == 0 ? 1.0 : -1.0);
  }
  const Georeference result = PlaceOnEarth(stations, {}, {});
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(result.fit.n_inliers, 16);
  EXPECT_TRUE(Has(result, "few_tags_agree"));
  EXPECT_FALSE(Has(result, "tags_disagree"));
}

TEST(CoordinateFaults, NameTheFileThatThePositionsComeFrom) {
  std::vector<input::Station> stations = WithHeights({400.0, 401.0, 402.0});
  const std::vector<CoordinateFault> of_tags = PossibleCoordinateFaults(stations);
  ASSERT_FALSE(of_tags.empty());
  EXPECT_NE(of_tags[0].problem.advice.find("exiftool"), std::string::npos);
  for (size_t i = 0; i < 2; ++i) stations[i].position_file = "survey/geo.txt";
  for (const CoordinateFault& fault : PossibleCoordinateFaults(stations)) {
    EXPECT_NE(fault.problem.finding.find("survey/geo.txt"), std::string::npos) << fault.problem.finding;
    EXPECT_EQ(fault.problem.advice.find("exiftool"), std::string::npos) << fault.problem.advice;
  }
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
