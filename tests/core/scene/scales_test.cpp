// Which footprints a scene was trained with, and the warning of renderings far beyond them.
#include "core/scene/scales.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/scene/scene_file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::scene {
namespace {

struct Trained {
  int multisample;
  double min_m, max_m;
};

class GetScalesOf : public ::testing::Test {
 protected:
  // Of a scene with these blocks; without a value: points.
  Scales Of(const std::vector<std::optional<Trained>>& blocks, const std::optional<Trained>& context = {}) const {
    checkpoint::ArchiveWriter writer(kSceneKind, kSceneVersion);
    writer.SetAttribute("blocks", static_cast<int64_t>(blocks.size()));
    const auto put = [&](const std::string& prefix, const std::optional<Trained>& field) {
      if (!field) return;
      writer.SetAttribute(prefix + "multisample", field->multisample);
      writer.SetAttribute(prefix + "footprint_min_m", field->min_m);
      writer.SetAttribute(prefix + "footprint_max_m", field->max_m);
    };
    for (size_t i = 0; i < blocks.size(); ++i) put(BlockPrefix(static_cast<int64_t>(i)), blocks[i]);
    put(kContextPrefix, context);
    writer.Commit(folder_ / "scene.h5");
    return GetScales(OpenScene(folder_ / "scene.h5"));
  }
  TemporaryFolder folder_;
};

TEST_F(GetScalesOf, PointsAreNone) {
  const Scales scales = Of({{}, {}});
  EXPECT_FALSE(scales.Cones());
  EXPECT_EQ(scales.multisample, 0);
  EXPECT_EQ(scales.footprint_max_m, 0.0);
}

TEST_F(GetScalesOf, BlocksAreTheirRangeTogether) {
  const Scales scales = Of({Trained{1, 0.2, 0.5}, Trained{6, 0.1, 0.3}, Trained{1, 0.4, 0.9}});
  EXPECT_TRUE(scales.Cones());
  EXPECT_EQ(scales.multisample, 6);
  EXPECT_EQ(scales.footprint_min_m, 0.1);
  EXPECT_EQ(scales.footprint_max_m, 0.9);
}

// The context is seen from farther away than the blocks and says nothing about how sharp they are.
TEST_F(GetScalesOf, BlocksDoNotIncludeTheContext) {
  const Scales scales = Of({Trained{1, 0.2, 0.5}}, Trained{4, 0.01, 50.0});
  EXPECT_EQ(scales.multisample, 1);
  EXPECT_EQ(scales.footprint_min_m, 0.2);
  EXPECT_EQ(scales.footprint_max_m, 0.5);
}

class ScaleWarning : public ::testing::Test {
 protected:
  void SetUp() override { base::InitLog(false); }
  void TearDown() override { base::InitLog(false); }
  // What is logged about `n` pixels of this width and some of 0.3 m, at a depth of 10 m.
  static std::string Logged(ScaleCheck& check, double width_m, size_t n, size_t others = 0, float depth = 10.0F) {
    std::vector<render::Ray> rays(n + others);
    std::vector<render::RayColor> colors(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
      rays[i].pixel_pitch = static_cast<float>(0.1 * (i < n ? width_m : 0.3));
      colors[i].depth_median = depth;
    }
    testing::internal::CaptureStderr();
    base::InitLog(false);
    check.Check(rays, colors);
    return testing::internal::GetCapturedStderr();
  }
  static bool Warns(const std::string& logged) { return logged.find("warning") != std::string::npos; }
  const Scales trained_{.multisample = 1, .footprint_min_m = 0.2, .footprint_max_m = 0.5};
};

TEST_F(ScaleWarning, ComesOnceWhenPixelsAreFarWider) {
  ScaleCheck check(trained_);
  const std::string logged = Logged(check, 2.0, 50);
  EXPECT_TRUE(Warns(logged)) << logged;
  EXPECT_NE(logged.find("pixels of about 2 m"), std::string::npos) << logged;
  EXPECT_NE(logged.find("0.2 to 0.5 m per pixel"), std::string::npos) << logged;
  EXPECT_NE(logged.find("train.pyramid"), std::string::npos) << logged;
  EXPECT_EQ(Logged(check, 2.0, 50), "");
  EXPECT_EQ(Logged(check, 0.001, 50), "");
}

TEST_F(ScaleWarning, ComesWhenPixelsAreFarNarrower) {
  ScaleCheck check(trained_);
  const std::string logged = Logged(check, 0.05, 50);
  EXPECT_TRUE(Warns(logged)) << logged;
  EXPECT_NE(logged.find("no more detail"), std::string::npos) << logged;
  EXPECT_EQ(logged.find("aliasing"), std::string::npos) << logged;
}

TEST_F(ScaleWarning, DoesNotComeWithinTwiceTheTrainedRange) {
  ScaleCheck check(trained_);
  for (const double width_m : {0.11, 0.2, 0.5, 0.99}) EXPECT_EQ(Logged(check, width_m, 50), "") << width_m;
  EXPECT_TRUE(Warns(Logged(check, 1.05, 50)));
}

// Rays at the horizon, or close to a roof.
TEST_F(ScaleWarning, NeedsMoreThanAFewPixels) {
  ScaleCheck check(trained_);
  EXPECT_EQ(Logged(check, 100.0, 24, 76), "");
  EXPECT_TRUE(Warns(Logged(check, 100.0, 26, 74)));
}

TEST_F(ScaleWarning, IgnoresLinesAndRaysThatMeetNothing) {
  ScaleCheck check(trained_);
  EXPECT_EQ(Logged(check, 0.0, 50), "");
  EXPECT_EQ(Logged(check, 100.0, 50, 0, std::nanf("")), "");
  check.Check({}, {});
  EXPECT_TRUE(Warns(Logged(check, 100.0, 50)));
}

TEST_F(ScaleWarning, NeverComesForPoints) {
  ScaleCheck check{Scales()};
  EXPECT_EQ(Logged(check, 100.0, 50), "");
}

}  // namespace
}  // namespace skyquilt::scene
