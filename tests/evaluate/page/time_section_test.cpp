#include <gtest/gtest.h>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {
namespace {

TEST(TimeSection, IsOnlyThereForARunWithinATotal) {
  metrics::Metrics metrics;
  EXPECT_EQ(TimeSection(metrics), "");
  metrics.times = metrics::RunTimes{.within_s = 1200.0, .used_s = 900.0, .stages = {}, .given_up = {}};
  EXPECT_NE(TimeSection(metrics).find("Nothing was given up"), std::string::npos);
}

TEST(TimeSection, ComparesWhatWasPredictedWithWhatHappened) {
  metrics::Metrics metrics;
  metrics.times = metrics::RunTimes{.within_s = 1200.0,
                                    .used_s = 900.0,
                                    .stages = {{.stage = "train", .planned_s = 500.0, .predicted_s = 600.0, .took_s = 480.0}, {.stage = "evaluate"}},
                                    .given_up = {"no video (products.video_seconds)", "<cells>"}};
  const std::string html = TimeSection(metrics);
  EXPECT_NE(html.find(ShownDuration(1200.0)), std::string::npos) << html;
  EXPECT_NE(html.find(ShownDuration(900.0)), std::string::npos) << html;
  for (const char* part : {"train", "+25 %", "evaluate", "no video (products.video_seconds)", "&lt;cells&gt;"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part << "\n" << html;
  }
}

}  // namespace
}  // namespace skyquilt::evaluate::page
