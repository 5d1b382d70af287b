#include "coordinator/planning/predictor.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace skyquilt::coordinator {
namespace {

WorkSize Flight(int photos) {
  WorkSize size;
  size.photos = photos;
  size.held_out = photos / 8;
  size.photo_pixels = 12e6;
  size.photo_width = 4000;
  size.surface_pixels = 1.4e6 * photos;
  size.blocks = 4;
  size.photo_gsd_m = 0.025;
  size.threads = 2;
  return size;
}

const char* const kAll[] = {"prepare", "partition", "train", "merge", "products", "surface", "buildings", "tour", "evaluate"};

// Within a factor of two of the figures in docs/benchmarks.md, on two threads: poses of Brighton Beach 16 s, of Seneca 3 min 45 s; surface of Seneca
// 5 min 45 s.
TEST(Predictor, UsualRatesGiveTheTimesThatWereMeasured) {
  const Settings settings;
  const double brighton_s = Predictor(Flight(18), Rates::Usual(2)).Seconds("prepare", settings);
  EXPECT_GT(brighton_s, 8.0);
  EXPECT_LT(brighton_s, 32.0);
  const Predictor seneca(Flight(167), Rates::Usual(2));
  EXPECT_GT(seneca.Seconds("prepare", settings), 113.0);
  EXPECT_LT(seneca.Seconds("prepare", settings), 450.0);
  EXPECT_GT(seneca.Seconds("surface", settings), 173.0);
  EXPECT_LT(seneca.Seconds("surface", settings), 690.0);
}

// Not for "products": the surface below the orthophoto is finer where it is small.
RC_GTEST_PROP(PredictorProperty, MorePhotosTakeLonger, ()) {
  const int few = *rc::gen::inRange(3, 2000), more = few + *rc::gen::inRange(1, 2000);
  Settings settings;
  settings.tour.auto_stops = 3;
  for (const char* stage : kAll) {
    if (std::string(stage) == "products") continue;
    const double a = Predictor(Flight(few), Rates::Usual(2)).Seconds(stage, settings),
                 b = Predictor(Flight(more), Rates::Usual(2)).Seconds(stage, settings);
    RC_ASSERT(a > 0.0);
    RC_ASSERT(b >= a);
  }
}

RC_GTEST_PROP(PredictorProperty, AFasterMachineIsNeverSlower, ()) {
  const int photos = *rc::gen::inRange(3, 2000);
  Rates slow = Rates::Usual(2);
  Rates fast = slow;
  for (double Rates::*rate : {&Rates::decoded_pixels, &Rates::feature_pixels, &Rates::matched_pairs, &Rates::samples, &Rates::rays,
                              &Rates::scored_pixels, &Rates::painted_pixels, &Rates::fused_pixels, &Rates::texels}) {
    fast.*rate *= 0.1 * *rc::gen::inRange(10, 50);
  }
  for (const char* stage : kAll) RC_ASSERT(Predictor(Flight(photos), fast).Seconds(stage, {}) <= Predictor(Flight(photos), slow).Seconds(stage, {}));
}

TEST(Predictor, EveryReductionSavesTimeOfSomeStage) {
  WorkSize size = Flight(200);
  Settings settings;
  settings.tour.auto_stops = 3;
  const Predictor predictor(size, Rates::Usual(2));
  const auto all = [&](const Settings& s) {
    double seconds = 0.0;
    for (const char* stage : kAll) {
      if (std::string(stage) != "train") seconds += predictor.Seconds(stage, s);
    }
    return seconds;
  };
  EXPECT_LT(predictor.Seconds("products",
                              [&] {
                                Settings s = settings;
                                s.products.video_seconds = 0.0;
                                return s;
                              }()),
            predictor.Seconds("products", settings));
  for (const char* change : {"surface.virtual_views=false", "surface.view_gsd=3", "products.resolution_m=0.2", "evaluate.max_photos=6", "tour.auto=0",
                             "run.image_width=640", "products.preview=false", "prepare.max_features=2048", "prepare.max_image_size=1200",
                             "buildings.enabled=false", "surface.enabled=false"}) {
    Settings less = settings;
    less.Set(config::ParseOverride(change));
    EXPECT_LT(all(less), all(settings)) << change;
  }
}

TEST(Predictor, LearnsFromWhatStagesTook) {
  Predictor predictor(Flight(100), Rates::Usual(2));
  const Settings settings;
  const double surface_s = predictor.Seconds("surface", settings), prepare_s = predictor.Seconds("prepare", settings);
  predictor.Correct("evaluate", 100.0, 200.0);
  EXPECT_NEAR(predictor.Seconds("surface", settings) / surface_s, std::pow(2.0, 0.7), 1e-9);
  EXPECT_NEAR(predictor.Seconds("prepare", settings) / prepare_s, std::pow(2.0, 0.3), 1e-9);
  for (int i = 0; i < 20; ++i) predictor.Correct("products", 1.0, 1000.0);
  EXPECT_LT(predictor.Seconds("surface", settings), 10.0 * surface_s);
  predictor.Correct("products", 0.2, 5.0);  // says little
  predictor.TakeRays(predictor.rates().rays);
  EXPECT_NEAR(predictor.Seconds("surface", settings), surface_s, 1e-9);
}

TEST(Predictor, RanksOnOtherMachinesShareTheWork) {
  WorkSize size = Flight(400);
  const double alone = Predictor(size, Rates::Usual(2)).Seconds("surface", {});
  size.ranks = 9;
  size.machines = 4;
  EXPECT_LT(Predictor(size, Rates::Usual(2)).Seconds("surface", {}), 0.6 * alone);
}

TEST(WorkSize, ReducedPhotosHaveFewerPixels) {
  const WorkSize size = Flight(10);
  EXPECT_DOUBLE_EQ(size.PixelsAt(1000), 12e6 / 16.0);
  EXPECT_DOUBLE_EQ(size.PixelsAt(0), 12e6);
  EXPECT_DOUBLE_EQ(size.PixelsAt(9000), 12e6);
  EXPECT_DOUBLE_EQ(size.SurfacePixelsAt(2000), 14e6 / 4.0);
}

}  // namespace
}  // namespace skyquilt::coordinator
