#include "coordinator/planning/plan.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace skyquilt::coordinator {
namespace {

// Invented speeds, with which every reduction saves something.
struct InventedRates {
  double photo_s = 0.5;  // of poses
  double ray_s = 1e-6;
  double product_s = 5.0;  // of maps
};

WorkSize InventedSize(int photos) {
  WorkSize size;
  size.photos = photos;
  size.held_out = photos / 8;
  size.photo_pixels = 12e6;
  size.photo_width = 4000;
  size.surface_pixels = 1.2e6 * photos;
  size.photo_gsd_m = 0.0125;
  return size;
}

double InventedSeconds(const std::string& stage, const Settings& s, const WorkSize& size, const InventedRates& rates) {
  const double n = size.photos;
  const double pixels = size.PixelsAt(s.run.image_width);
  if (stage == "prepare") return n * rates.photo_s * s.prepare.max_features / 8192.0 * s.prepare.max_image_size / 1600.0;
  if (stage == "partition") return 0.5;
  if (stage == "merge") return 1.0;
  if (stage == "products") {
    const double cells = s.products.resolution_m > 0.0 ? std::min(1.0, std::pow(0.04 / s.products.resolution_m, 2.0)) : 1.0;
    return rates.product_s * cells + 1e5 * rates.ray_s * s.products.video_seconds * s.products.video_fps;
  }
  if (stage == "surface") {
    const double views = n * pixels * (s.surface.virtual_views ? 2.0 : 1.0) / std::pow(s.surface.view_gsd, 2.0);
    return s.surface.enabled ? rates.ray_s * views * (s.surface.obj ? 1.1 : 1.0) : 0.0;
  }
  if (stage == "buildings") return s.buildings.enabled && s.surface.enabled ? 0.05 * n : 0.0;
  if (stage == "evaluate") return rates.ray_s * pixels * (s.evaluate.max_photos > 0 ? std::min(s.evaluate.max_photos, size.held_out) : size.held_out);
  return 0.0;
}

PlanRequest Request(double within_s, int photos, const InventedRates& rates, double used_s = 0.0) {
  const WorkSize size = InventedSize(photos);
  PlanRequest request{.within_s = within_s,
                      .used_s = used_s,
                      .stages = {"prepare", "partition", "train", "merge", "products", "surface", "buildings", "tour", "evaluate"}};
  request.reductions = ReductionsOf(request.settings, size);
  request.seconds = [size, rates](const std::string& stage, const Settings& s) { return InventedSeconds(stage, s, size, rates); };
  return request;
}

InventedRates AnyRates() {
  return {0.01 * *rc::gen::inRange(1, 200), 1e-8 * *rc::gen::inRange(1, 1000), 0.1 * *rc::gen::inRange(0, 600)};
}

double SecondsBefore(const Plan& plan) {
  double seconds = 0.0;
  for (const char* name : {"prepare", "partition"}) seconds += plan.Find(name) == nullptr ? 0.0 : plan.Find(name)->seconds;
  return seconds;
}

RC_GTEST_PROP(PlanProperty, NeverPlansMoreThanTheTotalWhereFeasible, ()) {
  const InventedRates rates = AnyRates();
  const double within_s = *rc::gen::inRange(10, 20000), used_s = *rc::gen::inRange(0, 5000);
  const Plan plan = MakePlan(Request(within_s, *rc::gen::inRange(3, 1000), rates, used_s));
  if (plan.feasible) RC_ASSERT(plan.EndS() <= within_s);
  RC_ASSERT(plan.training_s > 0.0);
}

RC_GTEST_PROP(PlanProperty, TrainingGetsHalfOfWhatIsLeftAfterPoses, ()) {
  const InventedRates rates = AnyRates();
  const double within_s = *rc::gen::inRange(10, 20000);
  const Plan plan = MakePlan(Request(within_s, *rc::gen::inRange(3, 1000), rates));
  const double left_s = kPlannedShare * within_s - SecondsBefore(plan);
  RC_ASSERT(plan.training_s >= kTrainingShare * left_s - 1e-6);
}

// Nothing is left unused: what other stages do not need is for training.
RC_GTEST_PROP(PlanProperty, AFeasiblePlanUsesAllOfItsTime, ()) {
  const InventedRates rates = AnyRates();
  const double within_s = *rc::gen::inRange(10, 20000);
  const Plan plan = MakePlan(Request(within_s, *rc::gen::inRange(3, 1000), rates));
  if (plan.feasible) RC_ASSERT(std::abs(plan.EndS() - kPlannedShare * within_s) < 1e-6 * within_s);
}

RC_GTEST_PROP(PlanProperty, MoreTimeGivesUpNoMore, ()) {
  const InventedRates rates = AnyRates();
  const int photos = *rc::gen::inRange(3, 1000);
  const double less_s = *rc::gen::inRange(10, 20000), more_s = less_s + *rc::gen::inRange(0, 20000);
  const Plan less = MakePlan(Request(less_s, photos, rates)), more = MakePlan(Request(more_s, photos, rates));
  RC_ASSERT(more.reductions.size() <= less.reductions.size());
  for (size_t i = 0; i < more.reductions.size(); ++i) RC_ASSERT(more.reductions[i].text == less.reductions[i].text);
  if (less.feasible) {
    RC_ASSERT(more.feasible);
    RC_ASSERT(more.EndS() >= less.EndS() - 1e-6);
  }
}

// Without a training that is still to come, what is left is for the products alone.
RC_GTEST_PROP(PlanProperty, LaterStagesScaleDownByWhatIsLeftWhenTheyStart, ()) {
  const InventedRates rates = AnyRates();
  const int photos = *rc::gen::inRange(3, 1000);
  PlanRequest request = Request(1000.0, photos, rates, *rc::gen::inRange(0, 1500));
  request.stages = {"merge", "products", "surface", "buildings", "tour", "evaluate"};
  std::erase_if(request.reductions, [](const Reduction& r) { return r.stage == "prepare" || r.stage == "partition" || r.stage == "train"; });
  const Plan plan = MakePlan(request);
  RC_ASSERT(plan.training_s == 0.0);
  if (plan.feasible) RC_ASSERT(plan.EndS() <= 1000.0);
  Settings all = request.settings;
  for (const Reduction& reduction : request.reductions) Apply(reduction, &all);
  double least = 0.0;
  for (const std::string& stage : request.stages) least += request.seconds(stage, all);
  // Only what could not be helped is called too short.
  if (!plan.feasible)
    RC_ASSERT(least > kPlannedShare * std::max(0.0, 1000.0 - request.used_s) - 0.05 * static_cast<double>(request.reductions.size()));
}

TEST(Plan, GivesUpTheVideoFirst) {
  const InventedRates rates;
  const Plan whole = MakePlan(Request(36000.0, 100, rates));
  EXPECT_TRUE(whole.feasible && whole.reductions.empty());
  double within_s = 36000.0;
  Plan plan = whole;
  while (plan.reductions.empty()) plan = MakePlan(Request(within_s *= 0.98, 100, rates));
  EXPECT_EQ(plan.reductions.front().what, "video");
  EXPECT_EQ(plan.reductions.front().stage, "products");
}

TEST(Plan, WhatSavesNothingStays) {
  PlanRequest request = Request(60.0, 100, {});
  request.seconds = [](const std::string& stage, const Settings& s) {
    if (stage == "surface") return s.surface.enabled ? 1000.0 : 0.0;
    return 1.0;
  };
  const Plan plan = MakePlan(request);
  ASSERT_EQ(plan.reductions.size(), 1U);
  EXPECT_EQ(plan.reductions.front().what, "surface");
  EXPECT_EQ(plan.Find("surface"), nullptr);
}

TEST(Plan, PosesThatUsedUpEverythingLeaveALittleTraining) {
  const Plan plan = MakePlan(Request(100.0, 100, {}, 150.0));
  EXPECT_FALSE(plan.feasible);
  EXPECT_GT(plan.training_s, 0.0);
  EXPECT_LE(plan.training_s, 10.0);
}

TEST(Plan, AGivenTrainingTimeIsKept) {
  PlanRequest request = Request(100.0, 20, {});
  request.fixed_training_s = 80.0;
  const Plan plan = MakePlan(request);
  EXPECT_EQ(plan.training_s, 80.0);
  EXPECT_FALSE(plan.reductions.empty());
}

TEST(Reductions, AreAllowedValuesAndNameTheStageWhoseOptionsTheyChange) {
  const WorkSize size = InventedSize(200);
  Settings settings;
  const std::vector<Reduction> list = ReductionsOf(settings, size);
  std::set<std::string> kinds;
  for (const Reduction& reduction : list) {
    Settings one;
    Apply(reduction, &one);
    EXPECT_NO_THROW(one.Check()) << reduction.text;
    EXPECT_NE(one.Flat(), settings.Flat()) << reduction.text;
    kinds.insert(reduction.what);
  }
  for (const char* what : {"video", "gap views", "maps", "surface detail", "scores", "width", "previews", "features", "buildings", "surface"}) {
    EXPECT_TRUE(kinds.contains(what)) << what;
  }
}

TEST(Reductions, MapsGetCoarserStepByStep) {
  const auto cells_at = [](int photo_width, int image_width, const std::string& source) {
    WorkSize size = InventedSize(200);
    size.photo_width = photo_width;
    size.photo_gsd_m = 100.0 / photo_width;
    Settings settings;
    settings.run.image_width = image_width;
    settings.products.ortho_source = source;
    std::vector<std::string> cells;
    for (const Reduction& reduction : ReductionsOf(settings, size)) {
      if (reduction.what == "maps") cells.push_back(reduction.changes.front().value);
    }
    return cells;
  };
  using Cells = std::vector<std::string>;
  EXPECT_EQ(cells_at(4000, 1000, "photos"), (Cells{"0.0375", "0.05", "0.1", "0.2", "0.3"}));
  EXPECT_EQ(cells_at(2000, 1000, "photos"), (Cells{"0.075", "0.1", "0.2", "0.3"}));
  EXPECT_EQ(cells_at(1000, 0, "photos"), (Cells{"0.1", "0.2", "0.3"}));
  EXPECT_EQ(cells_at(4000, 1000, "field"), (Cells{"0.1", "0.2", "0.3"}));
}

TEST(Reductions, OfferNothingThatIsNotMade) {
  WorkSize size = InventedSize(4);
  size.poses_given = true;
  Settings settings;
  settings.products.video_seconds = 0.0;
  settings.products.ortho = settings.products.dsm = settings.products.preview = false;
  settings.surface.enabled = false;
  settings.run.image_width = 320;
  EXPECT_TRUE(ReductionsOf(settings, size).empty());
}

TEST(Reductions, TellOnlyTheLastOfAKind) {
  const std::vector<Reduction> list = {
      {"video", "products", "shorter", {}}, {"gap views", "surface", "no gaps", {}}, {"video", "products", "none", {}}};
  EXPECT_EQ(TextsOf(list), (std::vector<std::string>{"no gaps", "none"}));
}

}  // namespace
}  // namespace skyquilt::coordinator
