#include "evaluate/metrics/warnings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace skyquilt::evaluate::metrics {
namespace {

bool Mentions(const std::vector<Warning>& warnings, const std::string& text) {
  return std::any_of(warnings.begin(), warnings.end(), [&](const Warning& warning) { return warning.finding.find(text) != std::string::npos; });
}

struct Case {
  survey::Survey survey;
  partition::BlockSet blocks;
  std::optional<scene::TrainReport> training = scene::TrainReport();
  Metrics metrics;

  Case() {
    survey.georeferenced = true;
    partition::Block block;
    block.name = "r0c0";
    blocks.blocks = {block};
    scene::FieldTraining field;
    field.name = "r0c0";
    field.ok = true;
    training->fields = {field};
    metrics.photos.resize(1);
    metrics.n_test = 1;
    metrics.coverage = 0.9;
  }
  std::vector<Warning> Collect() const { return CollectWarnings(survey, blocks, training ? &*training : nullptr, metrics); }
};

class CollectWarningsTest : public ::testing::Test, protected Case {};

TEST_F(CollectWarningsTest, NothingToSayAboutAGoodRun) {
  EXPECT_TRUE(Case().Collect().empty());
}

TEST_F(CollectWarningsTest, NamesUnregisteredPhotos) {
  survey.unregistered = {"lost.jpg"};
  EXPECT_TRUE(Mentions(Collect(), "lost.jpg"));
}

TEST_F(CollectWarningsTest, WhatPrepareSaysOfThePlaceComesFirst) {
  survey.georeferenced = false;
  survey.unregistered = {"lost.jpg"};
  survey.problems = {{"smear", "The picture is smeared", "Fly slower", false},
                     {"swapped", "Latitude and longitude are swapped", "Swap them", true},
                     {"doming", "The model may be bent", "Add oblique photos", false},
                     {"lag", "The tags lag", "Nothing", true}};
  const std::vector<Warning> warnings = Collect();
  ASSERT_EQ(warnings.size(), 5U) << "each problem once, and the photo that was not placed";
  EXPECT_EQ(warnings[0], (Warning{"Latitude and longitude are swapped", "Swap them"}));
  EXPECT_EQ(warnings[1], (Warning{"The tags lag", "Nothing"}));
  EXPECT_EQ(warnings[2].finding, "The picture is smeared");
  EXPECT_EQ(warnings[3].finding, "The model may be bent");
  EXPECT_NE(warnings[4].finding.find("lost.jpg"), std::string::npos);
}

TEST_F(CollectWarningsTest, LongListsAreCutShort) {
  for (int i = 0; i < 100; ++i) survey.unregistered.push_back("photo" + std::to_string(i));
  EXPECT_TRUE(Mentions(Collect(), "100 of 100 photos"));
  EXPECT_TRUE(Mentions(Collect(), "92 more"));
}

TEST_F(CollectWarningsTest, NamesEmptyFailedAndUntrainedBlocks) {
  training->fields[0].ok = false;
  training->fields[0].reason = "diverged";
  partition::Block empty, untrained;
  empty.name = "r0c1";
  empty.empty = true;
  empty.empty_reason = "no photo sees it";
  untrained.name = "r0c2";
  blocks.blocks.push_back(empty);
  blocks.blocks.push_back(untrained);
  const std::vector<Warning> warnings = Collect();
  EXPECT_TRUE(Mentions(warnings, "diverged"));
  EXPECT_TRUE(Mentions(warnings, "no photo sees it"));
  EXPECT_TRUE(Mentions(warnings, "r0c2"));
}

TEST_F(CollectWarningsTest, SaysWhatFellAndWhereTheContextIsShown) {
  training->fields[0].falls = {{.step = 5223, .best_psnr_db = 23.6, .psnr_db = 15.9, .restored_step = 4992}};
  training->fields[0].shows_context = true;
  training->fields[0].block_psnr_db = 15.6;
  training->fields[0].context_psnr_db = 19.5;
  const std::vector<Warning> warnings = Collect();
  EXPECT_TRUE(Mentions(warnings, "fell apart once"));
  EXPECT_TRUE(Mentions(warnings, "from 23.6 dB to 15.9 dB"));
  EXPECT_TRUE(Mentions(warnings, "taken back to step 4992"));
  EXPECT_TRUE(Mentions(warnings, "15.60 dB instead of 19.50 dB"));
}

TEST_F(CollectWarningsTest, SaysWhichGivenHeightsWereNotFlown) {
  blocks.blocks[0].flown_agl_m = 45.0;
  blocks.blocks[0].altitude_agl_m = 4.0;
  EXPECT_TRUE(Mentions(Collect(), "given as 4 m above ground, but its photos were taken from 45 m"));
}

TEST_F(CollectWarningsTest, EmptyBlocksOfOneReasonAreOneWarning) {
  for (int i = 1; i <= 30; ++i) {
    partition::Block& block = blocks.blocks.emplace_back();
    block.name = "r0c" + std::to_string(i);
    block.empty = true;
    block.empty_reason = i % 2 == 0 ? "no training photo sees it" : "no sparse point lies in it";
  }
  EXPECT_EQ(Collect().size(), 2U);
}

TEST_F(CollectWarningsTest, SaysWhenTrainingRecordOrScoresAreMissing) {
  training.reset();
  metrics.photos.clear();
  const auto warnings = Collect();
  EXPECT_TRUE(Mentions(warnings, "train.json"));
  EXPECT_TRUE(Mentions(warnings, "No held-out photo"));
}

TEST_F(CollectWarningsTest, LowCoverageAndPartialScoringAreSaid) {
  metrics.coverage = 0.2;
  metrics.n_test = 10;
  EXPECT_TRUE(Mentions(Collect(), "20 %"));
  EXPECT_TRUE(Mentions(Collect(), "1 of 10"));
}

TEST_F(CollectWarningsTest, EachSaysWhatToDoAndLeavesTheFullStopToOthers) {
  Case poor, bare;
  poor.survey.unregistered = {"lost.jpg"};
  partition::Block empty, untrained;
  empty.empty = true;
  untrained.name = "r0c2";
  poor.blocks.blocks.insert(poor.blocks.blocks.end(), {empty, untrained});
  poor.training->fields[0].dropped_steps = 1;
  poor.training->fields[0].falls = {{.step = 5223, .best_psnr_db = 23.6, .psnr_db = 15.9, .restored_step = 4992}};
  poor.training->fields[0].shows_context = true;
  poor.blocks.blocks[0].flown_agl_m = 45.0;
  poor.blocks.blocks[0].altitude_agl_m = 4.0;
  scene::FieldTraining failed;
  failed.name = "r0c3";
  poor.training->fields.push_back(failed);
  poor.metrics.coverage = 0.2;
  poor.metrics.n_test = 10;
  bare.training.reset();
  bare.metrics.photos.clear();
  std::vector<Warning> warnings = poor.Collect();
  EXPECT_EQ(warnings.size(), 10U);
  for (const Warning& warning : bare.Collect()) warnings.push_back(warning);
  EXPECT_EQ(warnings.size(), 12U) << "every kind there is";
  for (const Warning& warning : warnings) {
    EXPECT_GE(warning.finding.size(), 20U) << warning.advice;
    EXPECT_GE(warning.advice.size(), 20U) << warning.finding;
    EXPECT_FALSE(warning.finding.ends_with('.')) << warning.finding;
    EXPECT_FALSE(warning.advice.ends_with('.')) << warning.advice;
  }
}

}  // namespace
}  // namespace skyquilt::evaluate::metrics
