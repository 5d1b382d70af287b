// Rules of the options of training that concern cones and photos of several sizes.
#include "worker/train_options.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/support/error_of.h"

namespace skyquilt::worker {
namespace {

std::string Refusal(const TrainOptions& options, const std::string& section = "train") {
  return UsageErrorOf([&] { options.Check(section); });
}

TEST(TrainOptions, TakeOneToFourSharesOfPhotoSizes) {
  for (const std::vector<double>& shares : {std::vector<double>{1.0}, {0.6, 0.2, 0.12, 0.08}, {0.0, 0.0, 1.0}, {3.0, 1.0}}) {
    TrainOptions options;
    options.pyramid = shares;
    EXPECT_EQ(Refusal(options), "");
    options.pyramid_start = shares;
    EXPECT_EQ(Refusal(options), "");
  }
}

TEST(TrainOptions, RefuseImpossibleSharesByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<double>> impossible = {{0.0}, {0.0, 0.0}, {0.2, 0.2, 0.2, 0.2, 0.2}, {-0.1, 1.0}, {nan}, {1e9}};
  for (const std::vector<double>& shares : impossible) {
    TrainOptions options;
    options.pyramid = shares;
    EXPECT_NE(Refusal(options).find("train.pyramid"), std::string::npos) << shares.size() << ": " << Refusal(options);
    options = {};
    options.pyramid_start = shares;
    EXPECT_NE(Refusal(options, "context").find("context.pyramid_start"), std::string::npos) << shares.size() << ": " << Refusal(options);
  }
}

// Without shares at the start, training begins with those of the end; at the end there must be some.
TEST(TrainOptions, MayLackSharesAtTheStartOnly) {
  TrainOptions options;
  options.pyramid_start = {};
  EXPECT_EQ(Refusal(options), "");
  options.pyramid = {};
  EXPECT_NE(Refusal(options).find("train.pyramid"), std::string::npos) << Refusal(options);
}

TEST(TrainOptions, TakeNoOtherNumbersOfPositions) {
  TrainOptions options;
  for (const int positions : {0, 1, 4, 6}) {
    options.multisample = positions;
    EXPECT_EQ(Refusal(options), "") << positions;
  }
  for (const int positions : {-1, 2, 3, 5, 7}) {
    options.multisample = positions;
    EXPECT_NE(Refusal(options).find("train.multisample"), std::string::npos) << positions;
  }
}

TEST(TrainOptions, MayAskForScaleFeaturesOfPointsWhichHaveNone) {
  TrainOptions options;
  options.scale_features = true;
  for (const int positions : {0, 1, 4, 6}) {
    options.multisample = positions;
    EXPECT_EQ(Refusal(options), "") << positions;
  }
}

TEST(TrainOptions, KnowThreeActivationsOfDensity) {
  TrainOptions options;
  for (const char* name : {"exp", "softplus", "relu"}) {
    options.density_activation = name;
    EXPECT_EQ(Refusal(options), "") << name;
  }
  options.density_activation = "square";
  EXPECT_EQ(Refusal(options, "context"), "context.density_activation = \"square\" is not allowed: it must be exp, softplus or relu");
}

TEST(TrainOptions, TakeCodesOfUpTo32Numbers) {
  TrainOptions options;
  EXPECT_EQ(options.appearance_codes, 0);
  for (const int numbers : {0, 1, 3, 32}) {
    options.appearance_codes = numbers;
    EXPECT_EQ(Refusal(options), "") << numbers;
  }
  for (const int numbers : {-1, 33}) {
    options.appearance_codes = numbers;
    EXPECT_NE(Refusal(options).find("train.appearance_codes"), std::string::npos) << numbers;
  }
  options.appearance_codes = 4;
  options.appearance_of = "folder";
  EXPECT_EQ(Refusal(options), "");
  options.appearance_of = "flight";
  EXPECT_NE(Refusal(options).find("train.appearance_of"), std::string::npos);
}

TEST(TrainOptions, RefinePosesOnlyWithAnEncodingThatHasSlopes) {
  TrainOptions options;
  EXPECT_FALSE(options.refine_poses);
  options.refine_poses = true;
  for (const char* encoding : {"hash", "voxels", "planes", "frequency"}) {
    options.encoding = encoding;
    const bool has_slopes = options.encoding == "hash" || options.encoding == "voxels";
    EXPECT_EQ(Refusal(options).empty(), has_slopes) << encoding;
    if (!has_slopes) {
      EXPECT_NE(Refusal(options).find("train.refine_poses"), std::string::npos) << Refusal(options);
    }
  }
  options.encoding = "hash";
  options.pose_sigma_px = 0.0;
  EXPECT_NE(Refusal(options, "context").find("context.pose_sigma_px"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::worker
