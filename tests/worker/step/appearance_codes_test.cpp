// Codes of photos on their own: steps, mean, files. What they do to a training: tests/worker/appearance_test.cpp.
#include "worker/step/appearance_codes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

namespace fs = std::filesystem;

std::vector<float> CodeOf(const AppearanceCodes& codes, int photo) {
  return {codes.Of(photo), codes.Of(photo) + codes.numbers()};
}

TEST(AppearanceCodes, StartAtZeroAndAreNothingWhenOff) {
  AppearanceCodes codes(3, 5);
  EXPECT_TRUE(codes.On());
  EXPECT_EQ(CodeOf(codes, 2), std::vector<float>(5, 0.0F));
  EXPECT_FALSE(AppearanceCodes(3, 0).On());
  EXPECT_TRUE(AppearanceCodes(3, 0).state().codes.empty());
}

TEST(AppearanceCodes, AreSharedByPhotosOfAFolder) {
  survey::Survey survey;
  for (const char* name : {"noon/1.jpg", "morning/1.jpg", "noon/2.jpg", "3.jpg"}) survey.photos.emplace_back().name = name;
  const CodeGroups groups = GroupPhotos(survey, "folder");
  EXPECT_EQ(groups.of_photo, (std::vector<int>{0, 1, 0, 2}));
  EXPECT_EQ(groups.names, (std::vector<std::string>{"noon", "morning", ""}));
  EXPECT_EQ(GroupPhotos(survey, "photo").of_photo, (std::vector<int>{0, 1, 2, 3}));
  AppearanceCodes codes(groups, 2);
  const std::vector<float> gradient = {1.0F, -1.0F};
  codes.Add(2, gradient.data());
  codes.Add(1, std::vector<float>{-1.0F, 1.0F}.data());
  codes.Step(0.1);
  EXPECT_EQ(CodeOf(codes, 0), CodeOf(codes, 2));
  EXPECT_LT(CodeOf(codes, 0)[0], 0.0F);
  EXPECT_GT(CodeOf(codes, 1)[0], 0.0F);
  EXPECT_EQ(CodeOf(codes, 3), std::vector<float>(2, 0.0F));
  EXPECT_EQ(codes.state().steps, (std::vector<int64_t>{1, 1, 0}));
}

// Adam's first step is the learning rate, whatever the gradient's size; the gradients of a photo's rays are summed.
TEST(AppearanceCodes, MoveAgainstTheSumOfTheirGradients) {
  AppearanceCodes codes(3, 2);
  codes.Add(0, std::vector<float>{3.0F, -1.0F}.data());
  codes.Add(0, std::vector<float>{-4.0F, -1.0F}.data());
  codes.Add(2, std::vector<float>{1.0F, 1e-6F}.data());
  codes.Step(0.1);
  // Before the mean is taken away: (0.1, 0.1) and (-0.1, -0.1).
  EXPECT_NEAR(CodeOf(codes, 0)[0], 0.1F, 1e-6F);
  EXPECT_NEAR(CodeOf(codes, 0)[1], 0.1F, 1e-6F);
  EXPECT_NEAR(CodeOf(codes, 2)[0], -0.1F, 1e-6F);
  EXPECT_NEAR(CodeOf(codes, 2)[1], -0.1F, 1e-6F);
  EXPECT_EQ(codes.state().steps, (std::vector<int64_t>{1, 0, 1}));
  const std::vector<float> before = codes.state().codes;
  codes.Step(0.1);
  EXPECT_EQ(codes.state().codes, before) << "gradients of the last step count once";
}

// The mean of those that were drawn becomes zero in every step; the others stay at zero.
TEST(AppearanceCodes, HaveAZeroMeanOverThePhotosThatWereDrawn) {
  AppearanceCodes codes(6, 3);
  for (int step = 0; step < 40; ++step) {
    const int photo = step % 4;
    codes.Add(photo, std::vector<float>{1.0F, 0.5F * static_cast<float>(photo) - 0.2F, -2.0F}.data());
    codes.Step(0.05);
    for (size_t k = 0; k < 3; ++k) {
      double sum = 0.0;
      for (int drawn = 0; drawn < 4; ++drawn) sum += static_cast<double>(CodeOf(codes, drawn)[k]);
      EXPECT_NEAR(sum, 0.0, 1e-6) << step;
    }
    for (const int never : {4, 5}) EXPECT_EQ(CodeOf(codes, never), std::vector<float>(3, 0.0F));
  }
  EXPECT_GT(std::abs(CodeOf(codes, 3)[1]), 0.05F);
}

TEST(AppearanceCodes, KeepACodeWhoseGradientIsNotFinite) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
    AppearanceCodes codes(2, 3);
    codes.Add(0, std::vector<float>{1.0F, 1.0F, 1.0F}.data());
    codes.Add(1, std::vector<float>{-1.0F, -1.0F, -1.0F}.data());
    codes.Step(0.1);
    const AppearanceCodes::State before = codes.state();
    codes.Add(1, std::vector<float>{1.0F, bad, 1.0F}.data());
    codes.Step(0.1);
    EXPECT_EQ(codes.state().codes, before.codes);
    EXPECT_EQ(codes.state().steps, before.steps);
    codes.Step(0.1);
    EXPECT_EQ(codes.state().codes, before.codes) << "the gradient is gone";
  }
}

class AppearanceFile : public ::testing::Test {
 protected:
  fs::path Write(const AppearanceCodes& codes) const {
    checkpoint::ArchiveWriter writer("block", 1);
    writer.SetAttribute("name", "r0c0");
    codes.Put(writer);
    writer.Commit(folder_ / "codes.h5");
    return folder_ / "codes.h5";
  }
  static void Read(const fs::path& file, AppearanceCodes& codes) { codes.Get(checkpoint::ArchiveReader(file), file); }
  // After some steps.
  static AppearanceCodes Trained() {
    AppearanceCodes codes(4, 5);
    for (int step = 0; step < 7; ++step) Train(step, codes);
    return codes;
  }
  static void Train(int step, AppearanceCodes& codes) {
    for (const int photo : {0, step % 3}) {
      std::vector<float> gradient(5);
      for (size_t k = 0; k < 5; ++k) gradient[k] = std::sin(static_cast<float>(3 * step + photo) + 7.0F * static_cast<float>(k));
      codes.Add(photo, gradient.data());
    }
    codes.Step(0.03);
  }

  TemporaryFolder folder_;
};

TEST_F(AppearanceFile, BringsBackAllThatStepsDependOn) {
  AppearanceCodes whole = Trained(), resumed(4, 5);
  Read(Write(whole), resumed);
  for (int step = 7; step < 12; ++step) {
    Train(step, whole);
    Train(step, resumed);
  }
  EXPECT_EQ(resumed.state().codes, whole.state().codes);
  EXPECT_EQ(resumed.state().moment1, whole.state().moment1);
  EXPECT_EQ(resumed.state().moment2, whole.state().moment2);
  EXPECT_EQ(resumed.state().steps, whole.state().steps);
}

TEST_F(AppearanceFile, OfAnotherShapeOrWithoutCodesIsRefused) {
  const fs::path file = Write(Trained());
  AppearanceCodes photos(5, 5), numbers(4, 4), off(4, 0);
  EXPECT_THROW(Read(file, photos), base::InputError);
  EXPECT_THROW(Read(file, numbers), base::InputError);
  EXPECT_NO_THROW(Read(file, off));
  const fs::path without = Write(off);
  EXPECT_TRUE(checkpoint::ArchiveReader(without).Names().empty()) << "a field without codes has no arrays of them";
  AppearanceCodes codes(4, 5);
  EXPECT_THROW(Read(without, codes), base::InputError);
}

}  // namespace
}  // namespace skyquilt::worker
