#include "core/base/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace skyquilt::base {
namespace {

TEST(Progress, FinalLineShowsWhatWasDone) {
  testing::internal::CaptureStderr();
  {
    Progress progress("decode", 40.0, "photos");
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&progress] {
        for (int k = 0; k < 10; ++k) progress.Advance();
      });
    }
    for (std::thread& thread : threads) thread.join();
    progress.Finish("all read");
    progress.Finish("ignored");
  }
  const std::string text = testing::internal::GetCapturedStderr();
  for (const char* part : {"decode", "100 %", "photos/s", "all read"}) EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(text.find("ignored"), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

TEST(Progress, AListenerHearsSharesUpToTheEnd) {
  std::vector<std::pair<std::string, double>> heard;
  Progress::SetListener([&heard](const std::string& label, double share) { heard.emplace_back(label, share); });
  Progress::SetQuiet(true);
  {
    Progress progress("decode", 40.0, "photos");
    progress.Advance(10.0);  // too soon after the start to be told
    progress.Finish();
    Progress unknown("count", 0.0, "rays");
    unknown.Finish();
  }
  Progress::SetListener({});
  Progress("ignored", 1.0, "photos").Finish();
  Progress::SetQuiet(false);
  ASSERT_FALSE(heard.empty());
  EXPECT_EQ(heard.back(), (std::pair<std::string, double>("decode", 1.0)));
  for (const auto& [label, share] : heard) EXPECT_TRUE(label == "decode" && share >= 0.25 && share <= 1.0) << label << " " << share;
}

TEST(Progress, UnknownTotalShowsTheCount) {
  testing::internal::CaptureStderr();
  {
    Progress progress("train", 0.0, "rays");
    progress.Update(1500.0);
    progress.Finish();
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("1.50 k rays"), std::string::npos) << text;
  EXPECT_EQ(text.find('%'), std::string::npos) << text;
}

TEST(Progress, NeverShowsMoreThan100Percent) {
  testing::internal::CaptureStderr();
  {
    Progress progress("over", 10.0, "steps");
    progress.Update(25.0);
    progress.Finish();
  }
  EXPECT_NE(testing::internal::GetCapturedStderr().find("100 %"), std::string::npos);
}

TEST(Progress, WhatAnEarlierRunDidCountsInTheBarOnly) {
  testing::internal::CaptureStderr();
  {
    Progress progress("continued", 1000.0, "photos", 900.0);
    progress.Advance(0.0, "begun");
    progress.Finish();
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find(" 90 %  0 photos/s"), std::string::npos) << text;
}

TEST(Progress, QuietIsSilent) {
  testing::internal::CaptureStderr();
  Progress::SetQuiet(true);
  {
    Progress progress("quiet", 1.0, "steps");
    progress.Advance();
    progress.Finish();
  }
  Progress::SetQuiet(false);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace skyquilt::base
