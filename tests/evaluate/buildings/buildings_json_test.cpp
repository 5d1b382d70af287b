#include "evaluate/buildings/buildings_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "evaluate/metrics/metrics.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::buildings {
namespace {

BuildingScores SampleScores() {
  BuildingScores scores;
  scores.found = 12;
  scores.accepted = 10;
  scores.footprint_m2 = 1234.5;
  scores.volume_m3 = 9876.25;
  scores.solids_rejected = 1;
  scores.blocks_instead = 2;
  BuildingTruthScores& truth = scores.truth.emplace();
  truth.outlines_not_counted = 4;
  truth.found_not_counted = 3;
  truth.detection = {
      {"all", 10, 8, 2, 1, 0.8, 0.875, 0.75, 0.9375, 0.96875, 0.90625}, {.size = "10 to 50 m2", .outlines = 0}, {.size = "over 50 m2"}};
  truth.roofs = {{.roof = "all", .matched = 8, .roof_right = 0.875, .errors = {{"length", 8, 0.125, 0.25, 0.1875, 0.0625, 0.5, 7, 0.95}}},
                 {.roof = "flat", .matched = 3, .roof_right = 1.0, .errors = {{.measure = "deck", .n = 3, .bias = -0.5}}}};
  truth.corners = 40;
  truth.corners_found = 0.75;
  truth.corner_rmse_m = 0.375;
  scores.gsd_m = 0.125;
  using Fate = BuildingOutcome::Fate;
  truth.each = {{Fate::kMatched, 3, 7, "gable", "hip", 80.0, 0.75, {{"length", -0.25, 0.125}, {"yaw", 0.5}}},
                {.fate = Fate::kMissed, .truth_id = 4, .roof = "flat", .area_m2 = 12.5},
                {.fate = Fate::kInvented, .found_id = 2, .roof_found = "other", .area_m2 = 11.0}};
  return scores;
}

TEST(BuildingsJson, HasThePromisedKeys) {
  metrics::Metrics metrics;
  EXPECT_FALSE(base::ParseJson(metrics::MetricsJson(metrics)).contains("buildings"));
  metrics.buildings = SampleScores();
  const auto json = base::ParseJson(metrics::MetricsJson(metrics)).at("buildings");
  EXPECT_EQ(json.at("building_completeness"), 0.8);
  EXPECT_EQ(json.at("building_correctness"), 0.875);
  EXPECT_EQ(json.at("building_quality"), 0.75);
  EXPECT_EQ(json.at("building_completeness_area"), 0.9375);
  EXPECT_EQ(json.at("building_correctness_area"), 0.96875);
  EXPECT_EQ(json.at("building_quality_area"), 0.90625);
  EXPECT_EQ(json.at("invented"), 1);
  EXPECT_TRUE(json.at("by_size").at("over 50 m2").at("building_quality").is_null());
  EXPECT_EQ(json.at("errors").at("length").at("within_sigma"), 0.95);
  EXPECT_EQ(json.at("by_roof").at("flat").at("errors").at("deck").at("bias"), -0.5);
  EXPECT_EQ(json.at("corner_rmse_m"), 0.375);
  EXPECT_EQ(json.at("metric"), true);
  EXPECT_EQ(json.at("gsd_m"), 0.125);
  ASSERT_EQ(json.at("each").size(), 3U);
  EXPECT_EQ(json.at("each")[0].at("errors").at("length"), (std::vector<double>{-0.25, 0.125}));
  EXPECT_TRUE(json.at("each")[0].at("errors").at("yaw")[1].is_null());
  EXPECT_EQ(json.at("each")[1].at("fate"), "missed");
  EXPECT_EQ(json.at("each")[2].at("found_id"), 2);
}

TEST(BuildingsJson, IsReadBackAsItWasWritten) {
  const TemporaryFolder folder;
  for (const bool with_truth : {true, false}) {
    metrics::Metrics metrics;
    metrics.buildings = SampleScores();
    metrics.buildings->metric = with_truth;
    if (!with_truth) metrics.buildings->truth.reset();
    const std::string text = metrics::MetricsJson(metrics);
    base::WriteFileAtomically(folder.path() / "metrics.json", text);
    const metrics::Metrics back = metrics::ReadMetrics(folder.path() / "metrics.json");
    ASSERT_TRUE(back.buildings.has_value());
    EXPECT_EQ(back.buildings->truth.has_value(), with_truth);
    EXPECT_EQ(metrics::MetricsJson(back), text);
  }
}

TEST(BuildingsJson, WrongTypesAreNotMeasured) {
  const BuildingScores scores = BuildingScoresFromJson(base::ParseOrderedJson(
      R"({"found": "many", "metric": 3, "outlines_not_counted": 1, "building_quality": [], "by_size": 7, "by_roof": {"flat": null}, "errors": "no",
          "each": [7, {"fate": "lost"}, {"fate": "matched", "truth_id": "x", "errors": {"length": [null, 1], "width": [0.5, "?"]}}]})"));
  EXPECT_EQ(scores.found, 0);
  EXPECT_TRUE(scores.metric);
  ASSERT_TRUE(scores.truth.has_value());
  EXPECT_TRUE(std::isnan(scores.truth->detection.front().quality));
  EXPECT_EQ(scores.truth->detection.size(), 1U);
  EXPECT_TRUE(scores.truth->roofs.front().errors.empty());
  ASSERT_EQ(scores.truth->each.size(), 1U);
  EXPECT_EQ(scores.truth->each[0].truth_id, -1);
  ASSERT_EQ(scores.truth->each[0].errors.size(), 1U);
  EXPECT_EQ(scores.truth->each[0].errors[0].measure, "width");
  EXPECT_TRUE(std::isnan(scores.truth->each[0].errors[0].sigma));
}

}  // namespace
}  // namespace skyquilt::evaluate::buildings
