#include "prepare/tag_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/geo/enu_frame.h"
#include "prepare/georeference.h"
#include "tests/prepare/made_stations.h"
#include "tests/support/not_finite.h"

namespace skyquilt::prepare {
namespace {

using Eigen::Vector3d;

std::vector<Station> WithHeights(const std::vector<double>& height_m, std::optional<double> relative_altitude_m = {}) {
  std::vector<Station> stations(height_m.size());
  for (size_t i = 0; i < stations.size(); ++i) {
    stations[i].gps = geo::Geodetic{47.0 + 1e-4 * static_cast<double>(i), 8.0, height_m[i]};
    stations[i].relative_altitude_m = relative_altitude_m;
  }
  return stations;
}

// Photos on a lawnmower around `origin` with tags that have the noise of a receiver.
std::vector<Station> Tagged(const geo::Geodetic& origin, uint64_t seed) {
  base::Random random(seed);
  std::vector<Station> stations = test::LawnmowerStations(40, test::RandomFrame(random));
  const geo::EnuFrame frame(origin);
  for (int i = 0; i < 40; ++i) {
    Station& station = stations[static_cast<size_t>(i)];
    station.name = "photo_" + std::to_string(i) + ".jpg";
    station.gps = frame.GeodeticFromEnu(test::OnLawnmower(i, 40) + Vector3d{random.Normal(), random.Normal(), random.Normal()});
    station.up_in_cam = UpInCamera(-90.0, 0.0);
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
  std::vector<Station> half = WithHeights({kNan, kNan, kNan, kNan}, 60.0);
  half[0].relative_altitude_m.reset();
  half[1].relative_altitude_m.reset();
  EXPECT_EQ(JudgeHeights(half), HeightTags::kUnknown);
  EXPECT_EQ(JudgeHeights({}), HeightTags::kUnknown);
}

TEST(AllTagsEqual, AllowsAMetreAndIgnoresHeights) {
  std::vector<Station> stations = WithHeights({0.0, 100.0, kNan, 0.0});
  EXPECT_FALSE(AllTagsEqual(stations));
  for (Station& station : stations) station.gps->latitude_deg = 47.0;
  EXPECT_TRUE(AllTagsEqual(stations));
  stations[1].gps->longitude_deg += 1e-6;  // 8 cm
  stations[2].gps.reset();
  EXPECT_TRUE(AllTagsEqual(stations));
  stations[3].gps->longitude_deg += 2e-5;  // 1.5 m
  EXPECT_FALSE(AllTagsEqual(stations));
  for (size_t i = 0; i < 4; ++i) stations[i].gps = geo::Geodetic{-17.0, i % 2 == 0 ? 180.0 : -180.0, 0.0};
  EXPECT_TRUE(AllTagsEqual(stations));
}

TEST(PossibleCoordinateFaults, RepairTheTagsAndStayOnEarth) {
  const std::vector<Station> stations = WithHeights({1.0, 2.0});
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
  std::vector<Station> far_east = stations;
  for (Station& station : far_east) station.gps->longitude_deg = 151.0;  // no latitude
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
      std::vector<Station> stations = Tagged(origin, 2);
      for (Station& station : stations) station.gps = apply(*station.gps);
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
  std::vector<Station> stations = Tagged({47.0, 8.0, 400.0}, 3);
  const geo::Geodetic first = *stations[0].gps;
  for (Station& station : stations) station.gps = first;
  const Georeference equal = PlaceOnEarth(stations, {}, {});
  EXPECT_FALSE(equal.ok);
  EXPECT_TRUE(Has(equal, "equal_tags"));
  for (size_t i = 3; i < stations.size(); ++i) stations[i].gps.reset();
  EXPECT_TRUE(Has(PlaceOnEarth(stations, {}, {}), "too_few_tags"));
  for (Station& station : stations) station.gps.reset();
  EXPECT_TRUE(Has(PlaceOnEarth(stations, {}, {}), "no_gps"));
  EXPECT_TRUE(Has(PlaceOnEarth({}, {}, {}), "no_gps"));

  base::Random random(4);
  stations = Tagged({47.0, 8.0, 400.0}, 5);
  for (Station& station : stations) {
    station.gps->latitude_deg += 0.1 * random.Normal();
    station.gps->longitude_deg += 0.1 * random.Normal();
  }
  const Georeference scattered = PlaceOnEarth(stations, {}, {});
  EXPECT_FALSE(scattered.ok);
  ASSERT_FALSE(scattered.problems.empty());
  EXPECT_TRUE(scattered.problems[0].about_place);
}

TEST(PlaceOnEarth, NamesAStraightLineAndMissingHeights) {
  std::vector<Station> stations = Tagged({47.0, 8.0, 400.0}, 6);
  const std::vector<Station> line(stations.begin(), stations.begin() + test::kLine);
  const Georeference on_line = PlaceOnEarth(line, {}, {});
  EXPECT_TRUE(on_line.ok);
  EXPECT_TRUE(Has(on_line, "one_line"));

  for (Station& station : stations) station.gps->height_m = 0.0;
  const Georeference zero = PlaceOnEarth(stations, {}, {});
  EXPECT_TRUE(zero.ok);
  EXPECT_TRUE(Has(zero, "no_heights"));
  EXPECT_TRUE(std::isnan(zero.fit.accuracy.vertical_m));
  EXPECT_LT(zero.fit.accuracy.tilt_deg, 0.6);
  for (const Station& station : stations) EXPECT_NEAR((zero.enu_from_model * station.cam_from_model.OriginInSource()).z(), 0.0, 2.0);

  for (Station& station : stations) station.relative_altitude_m = 60.0;
  const Georeference relative = PlaceOnEarth(stations, {}, {});
  EXPECT_TRUE(Has(relative, "no_heights"));
  for (const Station& station : stations) EXPECT_NEAR((relative.enu_from_model * station.cam_from_model.OriginInSource()).z(), 60.0, 2.0);
}

TEST(PlaceOnEarth, SaysWhenFewTagsAgree) {
  std::vector<Station> stations = Tagged({47.0, 8.0, 400.0}, 7);
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
  std::vector<Station> stations = WithHeights({400.0, 401.0, 402.0});
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
}  // namespace skyquilt::prepare
