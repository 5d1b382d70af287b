#include <gtest/gtest.h>

#include <cmath>

#include "buildings/files/building_files.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "evaluate/buildings/detection.h"
#include "evaluate/buildings/measure_errors.h"
#include "tests/evaluate/buildings/buildings_sample.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::buildings {
namespace {

BuildingScores Scored(BuildingSet set, TrueBuildings truth) {
  base::ThreadPool threads(2);
  return ScoreBuildings(Compared(std::move(set), std::move(truth)), threads);
}

const BuildingErrors* Find(const BuildingRoofScores& scores, const std::string& measure) {
  for (const BuildingErrors& one : scores.errors) {
    if (one.measure == measure) return &one;
  }
  return nullptr;
}

TEST(BuildingScores, APerfectSetHasNoErrors) {
  const BuildingSet set = MadeTown(9);
  const BuildingScores scores = Scored(set, TruthOf(set));
  EXPECT_EQ(scores.found, 9);
  EXPECT_EQ(scores.solids_rejected, 0);
  ASSERT_TRUE(scores.truth.has_value());
  ASSERT_EQ(scores.truth->detection.size(), 3U);
  for (const BuildingDetection& one : scores.truth->detection) {
    EXPECT_GT(one.outlines, 0) << one.size;
    for (const double share : {one.completeness, one.correctness, one.quality, one.completeness_area, one.correctness_area, one.quality_area}) {
      EXPECT_NEAR(share, 1.0, 1e-6) << one.size;
    }
  }
  ASSERT_EQ(scores.truth->roofs.size(), 4U);
  for (const BuildingRoofScores& roof : scores.truth->roofs) {
    EXPECT_EQ(roof.roof_right, 1.0);
    for (const BuildingErrors& errors : roof.errors) {
      EXPECT_NEAR(errors.rmse, 0.0, 1e-6) << errors.measure;
      EXPECT_NEAR(errors.p90_abs, 0.0, 1e-6) << errors.measure;
    }
  }
  EXPECT_EQ(scores.truth->corners, 4 * 9);
  EXPECT_EQ(scores.truth->corners_found, 1.0);
  EXPECT_NEAR(scores.truth->corner_rmse_m, 0.0, 1e-9);
}

// Which of two houses that share a wall is larger may be a matter of centimetres.
TEST(BuildingScores, AnyOfNearlyEqualPartsMayBeTheLargest) {
  const BuildingSet set = MadeTown(9);
  TrueBuildings truth = TruthOf(set);
  const auto eaves = [&] { return Find(Scored(set, truth).truth->roofs.front(), "eave")->rmse; };
  for (TrueBuilding& building : truth.outlines) building.eave_z_m += 4.0;
  EXPECT_NEAR(eaves(), 4.0, 1e-6);
  for (TrueBuilding& building : truth.outlines) building.other_eaves_z_m = {building.eave_z_m, building.eave_z_m - 3.9, building.eave_z_m + 1.0};
  EXPECT_NEAR(eaves(), 0.1, 1e-6);
}

TEST(BuildingScores, PitchedRoofsHaveEavesAndRidgesAndFlatOnesDecks) {
  const BuildingSet set = MadeTown(9);
  const std::vector<BuildingRoofScores> roofs = Scored(set, TruthOf(set)).truth->roofs;
  ASSERT_EQ(roofs.size(), 4U);
  EXPECT_EQ(Find(roofs[0], "eave")->n, 6);
  EXPECT_EQ(Find(roofs[0], "deck")->n, 3);
  EXPECT_EQ(Find(roofs[0], "height")->n, 9);
  EXPECT_EQ(roofs[1].roof, "flat");
  EXPECT_EQ(Find(roofs[1], "eave"), nullptr);
  EXPECT_EQ(Find(roofs[1], "deck")->n, 3);
  EXPECT_EQ(Find(roofs[2], "deck"), nullptr);
}

TEST(BuildingScores, MissingAndInventedBuildingsGiveTheExpectedShares) {
  BuildingSet set = MadeTown(8);
  const TrueBuildings truth = TruthOf(set);
  double missed_m2 = 0.0, all_m2 = 0.0;
  for (size_t i = 0; i < truth.outlines.size(); ++i) {
    all_m2 += truth.outlines[i].area_m2;
    if (i < 2) missed_m2 += truth.outlines[i].area_m2;
  }
  set.buildings.erase(set.buildings.begin(), set.buildings.begin() + 2);
  skyquilt::buildings::HousePlan elsewhere;
  elsewhere.origin = {1000.0, 0.0};
  set.buildings.push_back(skyquilt::buildings::MadeHouse(elsewhere, 99));
  const double invented_m2 = set.buildings.back().measures.footprint_m2.value;
  const BuildingDetection all = Scored(set, truth).truth->detection.front();
  EXPECT_EQ(all.size, "all");
  EXPECT_EQ(all.outlines, 8);
  EXPECT_EQ(all.matched, 6);
  EXPECT_EQ(all.missed, 2);
  EXPECT_EQ(all.invented, 1);
  EXPECT_DOUBLE_EQ(all.completeness, 6.0 / 8.0);
  EXPECT_DOUBLE_EQ(all.correctness, 6.0 / 7.0);
  EXPECT_DOUBLE_EQ(all.quality, 6.0 / 9.0);
  const double shared_m2 = all_m2 - missed_m2;
  EXPECT_NEAR(all.completeness_area, shared_m2 / all_m2, 1e-6);
  EXPECT_NEAR(all.correctness_area, shared_m2 / (shared_m2 + invented_m2), 1e-6);
  EXPECT_NEAR(all.quality_area, shared_m2 / (all_m2 + invented_m2), 1e-6);
}

TEST(BuildingScores, SizesAddUp) {
  BuildingSet set = MadeTown(12);
  const TrueBuildings truth = TruthOf(set);
  set.buildings.erase(set.buildings.begin() + 3);
  set.buildings.front().footprint = Square(2000, 0, 3);  // 9 m2: invented, smaller than any outline that counts
  const std::vector<BuildingDetection> sizes = Scored(set, truth).truth->detection;
  ASSERT_EQ(sizes.size(), 3U);
  EXPECT_EQ(sizes[1].outlines, 3) << "sheds of 35 m2";
  EXPECT_EQ(sizes[1].missed, 1);
  EXPECT_EQ(sizes[1].invented, 1);
  for (int64_t BuildingDetection::*count :
       {&BuildingDetection::outlines, &BuildingDetection::matched, &BuildingDetection::missed, &BuildingDetection::invented}) {
    EXPECT_EQ(sizes[0].*count, sizes[1].*count + sizes[2].*count);
  }
}

// Objects punish a wrong division, areas do not.
TEST(BuildingScores, ASplitBuildingIsFoundOnceAndInventedOnce) {
  const BuildingSet whole = MadeTown(1);
  BuildingSet split = whole;
  split.buildings.push_back(split.buildings.front());
  const auto part = [&](double from, double to) {
    const skyquilt::buildings::Shape& shape = whole.buildings.front().shape;
    const double length = shape.u.back(), width = shape.v.back();
    Polygon polygon;
    for (const Eigen::Vector2d& uv : {Eigen::Vector2d(from * length, 0), Eigen::Vector2d(to * length, 0), Eigen::Vector2d(to * length, width),
                                      Eigen::Vector2d(from * length, width)}) {
      polygon.outer.push_back(skyquilt::buildings::EnuOf(shape, uv));
    }
    return polygon;
  };
  split.buildings[0].footprint = part(0.0, 0.6);
  split.buildings[1].footprint = part(0.6, 1.0);
  const BuildingDetection all = Scored(split, TruthOf(whole)).truth->detection.front();
  EXPECT_EQ(all.matched, 1);
  EXPECT_EQ(all.missed, 0);
  EXPECT_EQ(all.invented, 1);
  EXPECT_DOUBLE_EQ(all.correctness, 0.5);
  EXPECT_NEAR(all.quality_area, 1.0, 1e-6);
}

TEST(BuildingScores, WhatIsFoundOverOutlinesThatDoNotCountIsCutOff) {
  TrueBuildings truth;
  BuildingSet set = MadeTown(2);
  truth = TruthOf(set);
  truth.outlines[1].inside = false;
  for (Eigen::Vector2d& point : set.buildings[1].footprint.outer) point.x() += 1.0;
  const BuildingScores scores = Scored(set, truth);
  EXPECT_EQ(scores.truth->outlines_not_counted, 1);
  EXPECT_EQ(scores.truth->found_not_counted, 1);
  EXPECT_EQ(scores.truth->detection.front().quality, 1.0);
  EXPECT_EQ(scores.truth->roofs.front().matched, 1);
}

TEST(SummariseErrors, GivesTheKnownFigures) {
  const std::vector<MeasureError> errors = {
      {1.0, 1.0}, {-1.0, 0.1}, {3.0, skyquilt::buildings::kUnknown}, {5.0, 10.0}, {skyquilt::buildings::kUnknown, 1.0}};
  const BuildingErrors summary = SummariseErrors("length", errors);
  EXPECT_EQ(summary.n, 4);
  EXPECT_DOUBLE_EQ(summary.bias, 2.0);
  EXPECT_DOUBLE_EQ(summary.rmse, 3.0);
  EXPECT_DOUBLE_EQ(summary.nmad, 1.4826 * 2.0);
  EXPECT_DOUBLE_EQ(summary.median_abs, 2.0);
  EXPECT_NEAR(summary.p90_abs, 4.4, 1e-12);
  EXPECT_EQ(summary.with_sigma, 3);
  EXPECT_DOUBLE_EQ(summary.within_sigma, 2.0 / 3.0);
  const BuildingErrors nothing = SummariseErrors("length", {});
  EXPECT_EQ(nothing.n, 0);
  EXPECT_TRUE(std::isnan(nothing.rmse) && std::isnan(nothing.within_sigma));
}

TEST(SummariseErrors, RightUncertaintiesHoldNineteenOfTwenty) {
  base::Random random(3);
  std::vector<MeasureError> right, too_small;
  for (int i = 0; i < 4000; ++i) {
    const double sigma = random.Uniform(0.05, 0.5), error = sigma * random.Normal();
    right.push_back({error, sigma});
    too_small.push_back({error, 0.5 * sigma});
  }
  EXPECT_NEAR(SummariseErrors("eave", right).within_sigma, 0.95, 0.012);
  EXPECT_NEAR(SummariseErrors("eave", too_small).within_sigma, 0.673, 0.025);
}

TEST(YawError, IsModuloHalfATurnOrAQuarter) {
  EXPECT_NEAR(YawError(179.0, 1.0, false), -2.0, 1e-12);
  EXPECT_NEAR(YawError(1.0, -179.0, false), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(YawError(90.0, 0.0, false)), 90.0, 1e-12);
  EXPECT_NEAR(YawError(91.0, 0.0, true), 1.0, 1e-12);
}

TEST(ScoreMeasures, SquareBuildingsMayBeTurnedByAQuarter) {
  skyquilt::buildings::HousePlan plan;
  plan.length_m = plan.width_m = 10.0;
  BuildingSet set;
  set.buildings = {skyquilt::buildings::MadeHouse(plan)};
  const TrueBuildings truth = TruthOf(set);
  set.buildings[0].measures.yaw_deg.value += 91.0;
  EXPECT_NEAR(Find(Scored(set, truth).truth->roofs.front(), "yaw")->bias, 1.0, 1e-9);
}

TEST(ScoreMeasures, ErrorsAreFoundMinusTrueAndWrongRoofsAreSeen) {
  BuildingSet set = MadeTown(6);
  const TrueBuildings truth = TruthOf(set);
  for (Building& building : set.buildings) {
    building.measures.ridge_m.value += 0.25;
    building.measures.width_m.value -= 0.5;
    building.measures.width_m.sigma = 0.3;
  }
  set.buildings[0].roof = RoofKind::kOther;  // a gable
  const std::vector<BuildingRoofScores> roofs = Scored(set, truth).truth->roofs;
  EXPECT_NEAR(Find(roofs[0], "ridge")->bias, 0.25, 1e-9);
  EXPECT_NEAR(Find(roofs[0], "deck")->bias, 0.25, 1e-9);
  EXPECT_NEAR(Find(roofs[0], "width")->bias, -0.5, 1e-9);
  EXPECT_NEAR(Find(roofs[0], "width")->nmad, 0.0, 1e-9);
  EXPECT_EQ(Find(roofs[0], "width")->within_sigma, 1.0);
  EXPECT_DOUBLE_EQ(roofs[0].roof_right, 5.0 / 6.0);
  EXPECT_EQ(roofs[2].roof, "gable");
  EXPECT_DOUBLE_EQ(roofs[2].roof_right, 0.5);
}

TEST(ListOutcomes, AgreesWithTheFiguresOfTheWholeSet) {
  BuildingSet set = MadeTown(9);
  const TrueBuildings truth = TruthOf(set);
  set.buildings.erase(set.buildings.begin() + 2);
  set.buildings[3].footprint = Square(2000, 0, 4);
  for (size_t i = 0; i < set.buildings.size(); ++i) set.buildings[i].measures.length_m.value += 0.1 * static_cast<double>(i);
  const BuildingTruthScores scores = *Scored(set, truth).truth;
  int64_t matched = 0, missed = 0, invented = 0;
  std::vector<MeasureError> lengths;
  for (const BuildingOutcome& one : scores.each) {
    matched += one.fate == BuildingOutcome::Fate::kMatched ? 1 : 0;
    missed += one.fate == BuildingOutcome::Fate::kMissed ? 1 : 0;
    invented += one.fate == BuildingOutcome::Fate::kInvented ? 1 : 0;
    EXPECT_EQ(one.truth_id < 0, one.fate == BuildingOutcome::Fate::kInvented);
    EXPECT_EQ(one.found_id < 0, one.fate == BuildingOutcome::Fate::kMissed);
    EXPECT_EQ(one.errors.empty(), one.fate != BuildingOutcome::Fate::kMatched);
    for (const BuildingOutcome::Error& error : one.errors) {
      if (error.measure == "length") lengths.push_back({error.error, error.sigma});
    }
  }
  EXPECT_EQ(matched, scores.detection.front().matched);
  EXPECT_EQ(missed, scores.detection.front().missed);
  EXPECT_EQ(invented, scores.detection.front().invented);
  EXPECT_EQ(missed, 2);
  EXPECT_EQ(invented, 1);
  EXPECT_NEAR(scores.each.back().area_m2, 16.0, 1e-9);
  EXPECT_NEAR(SummariseErrors("length", lengths).rmse, Find(scores.roofs.front(), "length")->rmse, 1e-12);
}

TEST(ScoreCorners, ShiftsAreMeasuredAndPointsOnWallsAreNoCorners) {
  BuildingSet set = MadeTown(1);
  TrueBuildings truth = TruthOf(set);
  std::vector<Eigen::Vector2d>& ring = truth.outlines[0].walls.outer;
  ring.insert(ring.begin() + 1, 0.5 * (ring[0] + ring[1]));
  for (Eigen::Vector2d& point : set.buildings[0].footprint.outer) point += Eigen::Vector2d(0.6, -0.8);
  const BuildingTruthScores near = *Scored(set, truth).truth;
  EXPECT_EQ(near.corners, 4);
  EXPECT_EQ(near.corners_found, 1.0);
  EXPECT_NEAR(near.corner_rmse_m, 1.0, 1e-9);
  // A corner that is far away is not found, and does not spoil the others.
  set.buildings[0].footprint.outer[2] += 5.0 * (set.buildings[0].footprint.outer[2] - set.buildings[0].footprint.outer[1]).normalized();
  const BuildingTruthScores far = *Scored(set, truth).truth;
  EXPECT_EQ(far.corners_found, 0.75);
  EXPECT_NEAR(far.corner_rmse_m, 1.0, 1e-9);
}

TEST(BuildingScores, WithoutTruthThereAreCountsAndSums) {
  ComparedBuildings compared;
  compared.set = MadeTown(3);
  double footprint_m2 = 0.0;
  for (const Building& building : compared.set.buildings) footprint_m2 += building.measures.footprint_m2.value;
  compared.set.buildings[0].accepted = false;
  compared.set.buildings[1].lod22_valid = false;
  compared.set.buildings[1].measures.volume_m3.value = skyquilt::buildings::kUnknown;
  compared.set.buildings[2].lod22.face.pop_back();  // no longer closed
  compared.set.metric = false;
  base::ThreadPool threads(1);
  const BuildingScores scores = ScoreBuildings(compared, threads);
  EXPECT_FALSE(scores.truth.has_value());
  EXPECT_FALSE(scores.metric);
  EXPECT_EQ(scores.found, 3);
  EXPECT_EQ(scores.accepted, 2);
  EXPECT_EQ(scores.blocks_instead, 1);
  EXPECT_EQ(scores.solids_rejected, 1);
  EXPECT_EQ(scores.blocks_rejected, 0);
  EXPECT_NEAR(scores.footprint_m2, footprint_m2, 1e-9);
  EXPECT_TRUE(std::isfinite(scores.volume_m3));
}

TEST(LoadBuildingsOf, ReadsWhatTheStageWroteAndTheTruthOfGeoReferencedSurveys) {
  const TemporaryFolder folder;
  survey::Survey survey;
  EXPECT_FALSE(LoadBuildingsOf(folder.path(), survey).has_value());
  std::filesystem::create_directories(folder / "buildings");
  skyquilt::buildings::SaveBuildings(MadeTown(2), skyquilt::surface::MapFrame(scene::SceneInfo()), folder / "buildings/buildings.json");
  const auto alone = LoadBuildingsOf(folder.path(), survey);
  ASSERT_TRUE(alone.has_value());
  EXPECT_EQ(alone->set.buildings.size(), 2U);
  EXPECT_FALSE(alone->truth.has_value());

  std::filesystem::create_directories(folder / "truth");
  base::WriteFileAtomically(folder / "truth/buildings.json", R"({"outlines": []})");
  survey.truth.emplace().buildings_json = folder / "truth/buildings.json";
  EXPECT_FALSE(LoadBuildingsOf(folder.path(), survey)->truth.has_value()) << "a local frame cannot be compared";
  survey.georeferenced = true;
  const auto compared = LoadBuildingsOf(folder.path(), survey);
  ASSERT_TRUE(compared->truth.has_value());
  EXPECT_EQ(compared->matches.found, (std::vector<FoundFate>{FoundFate::kInvented, FoundFate::kInvented}));
  base::WriteFileAtomically(folder / "buildings/buildings.json", "{");
  EXPECT_THROW(LoadBuildingsOf(folder.path(), survey), base::InputError);
}

}  // namespace
}  // namespace skyquilt::evaluate::buildings
