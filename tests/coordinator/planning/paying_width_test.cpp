#include "coordinator/planning/paying_width.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>

namespace skyquilt::coordinator {
namespace {

constexpr double kSamplesPerSecond = 2e6;
const Room kMuchRoom = {.memory_limit = 1e12, .disk = 1e15};

WorkSize SizeOf(int photos, int width) {
  WorkSize size;
  size.photos = photos;
  size.held_out = photos / 8;
  size.photo_width = width;
  size.photo_pixels = 0.75 * width * width;
  return size;
}

// A plan whose stages after training take so long for each pixel of the photos.
Plan PlanOf(const WorkSize& size, const Settings& settings, double within_s, double seconds_per_pixel) {
  PlanRequest request{.within_s = within_s, .stages = {"train", "surface"}, .settings = settings};
  request.reductions = ReductionsOf(settings, size);
  request.seconds = [&](const std::string& stage, const Settings& s) {
    return stage == "surface" ? seconds_per_pixel * size.TrainingPhotos() * size.PixelsAt(s.run.image_width) : 0.0;
  };
  return MakePlan(request);
}

Settings AutoSettings() {
  Settings settings;
  settings.run.image_width = kAutoWidth;
  return settings;
}

Plan PlanWithin(const WorkSize& size, double within_s, double seconds_per_pixel = 0.0, const Settings& settings = AutoSettings()) {
  const Predictor predictor(size, {.samples = kSamplesPerSecond});
  return PlanWithPayingWidth(predictor, settings, kMuchRoom, [&](const Settings& s) { return PlanOf(size, s, within_s, seconds_per_pixel); });
}

int WidthFor(const WorkSize& size, double samples, const Room& room = kMuchRoom) {
  return PayingWidth(size, Settings(), samples, room);
}

TEST(PayingWidth, IsTheLeastWithoutATime) {
  const WorkSize size = SizeOf(50, 4000);
  EXPECT_EQ(WidthFor(size, std::numeric_limits<double>::infinity()), kLeastAutoWidth);
  EXPECT_EQ(WidthFor(size, 0.0), kLeastAutoWidth);
}

TEST(PayingWidth, IsThatOfThePhotosInALongTraining) {
  const WorkSize size = SizeOf(50, 4000);
  EXPECT_EQ(WidthFor(size, 1e12), 4000);
  EXPECT_EQ(WidthFor(size, 1e12, {.memory_limit = 3.0 * 50 * size.PixelsAt(4000), .disk = 1e15}), 2560) << "decoded photos take half of the memory";
  Settings settings;
  settings.run.image_width = 3200;
  EXPECT_EQ(WidthFor(size, 1e12, {.memory_limit = 1e12, .disk = NeedsOf(size, settings).disk}), 3200) << "and there is the disk";
  EXPECT_EQ(WidthFor(SizeOf(50, 640), 1e12), kLeastAutoWidth) << "which changes nothing";
}

RC_GTEST_PROP(PayingWidthProperty, MoreTimeAndFewerPhotosAreNeverNarrower, ()) {
  const int photos = *rc::gen::inRange(3, 3000), width = *rc::gen::inRange(100, 9000);
  const double samples = 1e6 * *rc::gen::inRange(1, 1'000'000);
  const int chosen = WidthFor(SizeOf(photos, width), samples);
  RC_ASSERT(chosen >= kLeastAutoWidth && chosen <= std::max(kLeastAutoWidth, width));
  RC_ASSERT(WidthFor(SizeOf(photos, width), 2.0 * samples) >= chosen);
  RC_ASSERT(WidthFor(SizeOf(2 * photos, width), samples) <= chosen);
  const std::vector<int> widths = WidthsToChooseFrom(width);
  RC_ASSERT(std::find(widths.begin(), widths.end(), chosen) != widths.end());
}

RC_GTEST_PROP(PayingWidthProperty, APlanIsNoWiderThanItsTrainingPaysFor, ()) {
  const WorkSize size = SizeOf(*rc::gen::inRange(3, 500), *rc::gen::inRange(300, 6000));
  const double within_s = *rc::gen::inRange(60, 20'000);
  const Plan plan = PlanWithin(size, within_s, 1e-8 * *rc::gen::inRange(0, 300));
  const double samples = (1.0 - Settings().run.context_share) * kSamplesPerSecond * plan.training_s;
  RC_ASSERT(plan.image_width <= kLeastAutoWidth || plan.image_width <= WidthFor(size, samples));
  RC_ASSERT(plan.image_width <= kLeastAutoWidth || plan.feasible);
}

TEST(PayingWidth, GrowsWithTheTotal) {
  const WorkSize size = SizeOf(50, 4000);
  EXPECT_EQ(PlanWithin(size, 60.0).image_width, kLeastAutoWidth);
  EXPECT_EQ(PlanWithin(size, 1e6).image_width, 4000);
  const int between = PlanWithin(size, 3600.0).image_width;
  EXPECT_GT(between, kLeastAutoWidth);
  EXPECT_LT(between, 4000);
  // Where wider photos cost detail of the surface, it is not given up for them.
  const Plan costly = PlanWithin(size, 3600.0, 5e-6);
  EXPECT_LT(costly.image_width, between);
  EXPECT_TRUE(costly.reductions.empty());
}

TEST(PayingWidth, AGivenWidthIsKept) {
  const WorkSize size = SizeOf(50, 4000);
  Settings settings;
  settings.run.image_width = 1600;
  EXPECT_EQ(PlanWithin(size, 1e6, 0.0, settings).image_width, 1600);
}

}  // namespace
}  // namespace skyquilt::coordinator
