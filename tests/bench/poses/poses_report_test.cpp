#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/poses/poses_bench.h"
#include "core/base/json_text.h"

namespace skyquilt::bench {
namespace {

PosesRow Row(PhotoSet set, const std::string& way, size_t n, size_t registered, double seconds, const std::string& used) {
  PosesRow row{.set = set, .way = way, .n_files = n, .used = used, .failure = {}, .score = {}, .seconds = seconds};
  row.score.n_photos = n;
  row.score.registered = row.score.right = registered;
  return row;
}

bool Says(const BenchPage& page, const std::string& text) {
  return std::any_of(page.verdicts.begin(), page.verdicts.end(), [&](const std::string& verdict) { return verdict.find(text) != std::string::npos; });
}

TEST(UsedWay, IsReadFromTheFolderOfTheModel) {
  EXPECT_EQ(UsedWay("/a/fast", "/a/fast/seeded", true), "tags and matches");
  EXPECT_EQ(UsedWay("/a/fast", "/a/fast/sparse/0", true), "mapper");
  EXPECT_EQ(UsedWay("/a/fast", "/a/fast/more_pairs/sparse/1", true), "more pairs");
  EXPECT_EQ(UsedWay("/a/fast", "/a/fast/more_pairs/sparse_held_focal/0", true), "more pairs, tagged focal");
  EXPECT_EQ(UsedWay("/a/colmap", "/a/colmap/sparse/0", false), "COLMAP alone");
}

TEST(PosesReport, FewerPhotosThanColmapPassOnlyWithTheFallBack) {
  PosesResult result;
  result.rows = {Row(PhotoSet::kTurned, "fast", 60, 58, 30.0, "mapper"),      Row(PhotoSet::kTurned, "colmap", 60, 60, 90.0, "COLMAP alone"),
                 Row(PhotoSet::kBlurred, "fast", 60, 50, 30.0, "more pairs"), Row(PhotoSet::kBlurred, "colmap", 60, 60, 90.0, "COLMAP alone"),
                 Row(PhotoSet::kNoTags, "fast", 60, 60, 30.0, "mapper"),      Row(PhotoSet::kNoTags, "colmap", 60, 60, 90.0, "COLMAP alone")};
  const auto comparisons = result.Comparisons();
  ASSERT_EQ(comparisons.size(), 3U);
  EXPECT_FALSE(comparisons[0].Passed());
  EXPECT_TRUE(comparisons[1].Passed() && !comparisons[1].NoFewer());
  EXPECT_TRUE(comparisons[2].Passed() && comparisons[2].NoFewer());
  const BenchPage page = PosesPage(result, "skyquilt bench poses");
  EXPECT_TRUE(Says(page, "fewer photos than COLMAP alone: turned (60 photos): 58 against 60."));
  EXPECT_TRUE(Says(page, "was taken for blurred (60 photos)"));
  const nlohmann::json json = base::ParseJson(PosesJson(result, "skyquilt bench poses"));
  EXPECT_EQ(json["rows"].size(), 6U);
  EXPECT_EQ(json["comparisons"][0]["passed"], false);
  EXPECT_EQ(json["comparisons"][1]["fell_back"], true);
  result.rows[0].score.registered = 60;
  EXPECT_TRUE(Says(PosesPage(result, ""), "In all 3 sets"));
}

TEST(PosesReport, TheSlopeIsOfTheTimesPerPhoto) {
  PosesResult result;
  result.rows = {Row(PhotoSet::kPlain, "fast", 100, 100, 50.0, "tags and matches"), Row(PhotoSet::kPlain, "colmap", 100, 100, 200.0, "COLMAP alone"),
                 Row(PhotoSet::kPlain, "fast", 500, 500, 300.0, "tags and matches"),
                 Row(PhotoSet::kPlain, "colmap", 500, 500, 3000.0, "COLMAP alone")};
  const auto slopes = result.Slopes();
  ASSERT_EQ(slopes.size(), 2U);
  const PosesSlope& fast = slopes[0].way == "fast" ? slopes[0] : slopes[1];
  EXPECT_EQ(fast.few, 100U);
  EXPECT_EQ(fast.many, 500U);
  EXPECT_DOUBLE_EQ(fast.ratio, 1.2);
  const BenchPage page = PosesPage(result, "");
  EXPECT_TRUE(Says(page, "1.20 times as long among 500 photos as among 100; the target of at most 1.3 is met"));
  EXPECT_TRUE(Says(page, "3.00 times as long"));
  result.rows[2].seconds = 400.0;
  EXPECT_TRUE(Says(PosesPage(result, ""), "is missed"));
  result.rows.resize(2);
  EXPECT_TRUE(result.Slopes().empty());
}

TEST(PosesReport, IntrudersAndMissingModelsAreSaid) {
  PosesResult result;
  result.rows = {Row(PhotoSet::kOtherPlace, "fast", 64, 60, 30.0, "tags and matches"), Row(PhotoSet::kOtherPlace, "colmap", 64, 0, 9.0, "")};
  result.rows[1].failure = "log: COLMAP found no model.";
  EXPECT_TRUE(Says(PosesPage(result, ""), "No photo of another place got a pose."));
  EXPECT_TRUE(Says(PosesPage(result, ""), "other_place (64 photos), colmap: no model. log: COLMAP found no model."));
  result.rows[0].score.intruders = 2;
  EXPECT_TRUE(Says(PosesPage(result, ""), "Photos of another place got a pose: 2 of other_place (64 photos), fast."));
  EXPECT_NE(BenchText(PosesPage(result, "")).find("no model"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::bench
