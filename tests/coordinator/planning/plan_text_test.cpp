#include "coordinator/planning/plan_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"

namespace skyquilt::coordinator {
namespace {

TEST(PlanText, NamesEveryStageAndWhatIsGivenUp) {
  const Plan plan{.within_s = 1200.0,
                  .used_s = 60.0,
                  .stages = {{"train", 600.0}, {"evaluate", 90.0}},
                  .training_s = 600.0,
                  .reductions = {{"video", "products", "no video", {}}},
                  .feasible = false};
  const std::string text = PlanText(plan);
  for (const char* part : {"20m", "1m00s are used", "train", "10m", "evaluate", "for this: no video", "too short"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  const nlohmann::ordered_json json = PlanJson(plan);
  EXPECT_EQ(json.at("stages").at("train"), 600.0);
  EXPECT_EQ(json.at("given_up").at(0), "no video");
  EXPECT_EQ(json.at("end_s"), 750.0);
}

TEST(PlanText, TimesThatAreNotKnownAreNull) {
  const evaluate::metrics::RunTimes times{.within_s = 60.0, .used_s = 30.0, .stages = {{.stage = "train", .predicted_s = 20.0}}, .given_up = {}};
  const nlohmann::json json = base::ParseJson(TimesJson(times));
  EXPECT_TRUE(json.at("stages").at(0).at("took_s").is_null());
  EXPECT_EQ(json.at("stages").at(0).at("predicted_s"), 20.0);
  EXPECT_TRUE(json.at("given_up").empty());
}

TEST(UsualTotals, AreAboutTheLeastThatNeedsNoReduction) {
  const auto needs = [](double least_s) {
    return [least_s](double within_s) {
      Plan plan{.within_s = within_s};
      if (within_s < least_s) plan.reductions.push_back({"video", "products", "no video", {}});
      return plan;
    };
  };
  EXPECT_EQ(UsualTotals(needs(700.0)), (std::vector<double>{300.0, 900.0, 2700.0}));
  EXPECT_EQ(UsualTotals(needs(1.0)), (std::vector<double>{60.0, 180.0}));
  EXPECT_FALSE(UsualTotals(needs(1e9)).empty());
}

}  // namespace
}  // namespace skyquilt::coordinator
