#include "evaluate/page/geo_section.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/base/pattern.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"
#include "tests/evaluate/page/count_of.h"
#include "tests/evaluate/page/sample_report.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

constexpr const char* kSize = "viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"";

// A survey with every kind of evidence and bad tags, and one without a geo-reference.
class GeoPage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    sample_ = std::make_unique<SampleReport>(folder_->path());
    poor_ = std::make_unique<SampleReport>(folder_->path());
    poor_->MakePoor();
  }
  static void TearDownTestSuite() { folder_.reset(); }
  // The section for a changed survey.
  static std::string SectionOf(const survey::Survey& survey) {
    ReportInput input = sample_->input;
    input.survey = &survey;
    return GeoSection(input);
  }
  static survey::Survey ExactSurvey() {
    survey::Survey exact = sample_->survey;
    exact.fit.accuracy = {.scale_percent = 0.0, .tilt_deg = 0.0, .yaw_deg = 0.0, .horizontal_m = 0.0, .vertical_m = 0.0};
    exact.fit.gravity.clear();
    exact.fit.tag_lag_s = 0.0;
    exact.fit.flight_vertical_offset_m.clear();
    exact.fit.flight_vertical_drift_m.clear();
    return exact;
  }
  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<SampleReport> sample_, poor_;
  survey::Survey survey_ = sample_->survey;
};

// The value beside a name in a table of figures.
std::string ValueOf(const std::string& html, const std::string& name) {
  const std::string before = "<td>" + name + "</td><td class=\"num\">";
  const size_t at = html.find(before);
  if (at == std::string::npos) return "(no row " + name + ")";
  return html.substr(at + before.size(), html.find("</td>", at + before.size()) - at - before.size());
}

TEST(TwoDigits, KeepsTwoDigitsWhateverTheSize) {
  EXPECT_EQ(TwoDigits(123.4, "m"), "123\xE2\x80\xAFm");
  EXPECT_EQ(TwoDigits(9.96, "m"), "10\xE2\x80\xAFm");
  EXPECT_EQ(TwoDigits(9.94, "m"), "9.9\xE2\x80\xAFm");
  EXPECT_EQ(TwoDigits(0.0996, kDegree), "0.10\xC2\xB0");
  EXPECT_EQ(TwoDigits(0.034, kDegree), "0.034\xC2\xB0");
  EXPECT_EQ(TwoDigits(0.0, "m"), "0\xE2\x80\xAFm");
  EXPECT_EQ(TwoDigits(kNotMeasured, "m"), "\xE2\x80\x93");
}

TEST_F(GeoPage, TellsAccuracyCorrectionsAndChecks) {
  const std::string html = GeoSection(sample_->input);
  ExpectBalanced(html);
  EXPECT_EQ(ValueOf(html, "Scale"), "0.21\xE2\x80\xAF%");
  EXPECT_EQ(ValueOf(html, "Tilt"), "0.31\xC2\xB0");
  EXPECT_EQ(ValueOf(html, "Yaw"), "0.17\xC2\xB0");
  EXPECT_EQ(ValueOf(html, "Horizontal position"), "1.6\xE2\x80\xAFm");
  EXPECT_EQ(ValueOf(html, "Vertical position"), "2.2\xE2\x80\xAFm");
  EXPECT_EQ(ValueOf(html, "Lag of the tags"), "0.30 \xC2\xB1 0.05\xE2\x80\xAFs");
  EXPECT_NE(html.find("that is 2.4\xE2\x80\xAFm along the track"), std::string::npos) << "0.3 s at 8.1 m/s";
  EXPECT_EQ(ValueOf(html, "Offset of tagged heights"), "0.00 \xE2\x80\x93 3.50\xE2\x80\xAFm");
  EXPECT_EQ(ValueOf(html, "Drift of tagged heights"), "2.50 \xE2\x80\x93 6.00\xE2\x80\xAFm");
  EXPECT_EQ(ValueOf(html, "Rolling shutter"), "4.4\xE2\x80\xAFpx");
  EXPECT_EQ(ValueOf(html, "Doming"), "0.42 \xC2\xB1 0.31\xE2\x80\xAFm");
  EXPECT_EQ(ValueOf(html, "Lens distortion k1"),
            "\xE2\x88\x92"
            "0.0123 \xC2\xB1 0.0004");
  // Flight 2: 36 photos, one tag missing and one not used.
  EXPECT_NE(html.find("<tr><td>2</td><td class=\"num\" data-v=\"36\">36</td><td class=\"num\" data-v=\"34\">34</td>"
                      "<td class=\"num\" data-v=\"3.5\">3.50\xE2\x80\xAFm</td><td class=\"num\" data-v=\"2.5\">2.50\xE2\x80\xAFm</td>"),
            std::string::npos);
  EXPECT_EQ(CountOf(html, "<td></td>"), 0U);
}

TEST_F(GeoPage, WhatIsUnknownIsADash) {
  survey_.fit.accuracy = {};
  survey_.fit.tag_lag_s = 0.0;
  survey_.fit.tag_lag_sigma_s = kNotMeasured;
  survey_.fit.tags_alone_tilt_deg = kNotMeasured;
  survey_.fit.gravity[0] = {.kind = "gimbal", .lean_east_deg = kNotMeasured, .lean_north_deg = kNotMeasured, .sigma_deg = kNotMeasured};
  survey_.checks = {};
  const std::string html = SectionOf(survey_);
  ExpectBalanced(html);
  for (const char* name : {"Tilt", "Yaw", "Vertical position", "Rolling shutter", "Doming", "Lens distortion k1"}) {
    EXPECT_EQ(ValueOf(html, name), "\xE2\x80\x93") << name;
  }
  EXPECT_EQ(ValueOf(html, "Lag of the tags"), "none");
  EXPECT_EQ(html.find("tags alone"), std::string::npos);
}

TEST_F(GeoPage, AMechanicalShutterIsSaid) {
  survey_.checks.readout_ms = 0.0;
  survey_.checks.smear_px = 0.0;
  const std::string html = SectionOf(survey_);
  EXPECT_NE(html.find("DJI &lt;FC300S&gt; has a global or mechanical shutter"), std::string::npos);
  EXPECT_EQ(ValueOf(html, "Rolling shutter"), "0.0\xE2\x80\xAFpx");
}

TEST_F(GeoPage, MapHasAnArrowPerTagAndKeepsFarOnesInside) {
  const std::string map = GeoMap(sample_->survey);
  ExpectBalanced(map);
  EXPECT_EQ(CountOf(map, "<g class=\"used\">"), 78U);
  EXPECT_EQ(CountOf(map, "<g class=\"unused\">"), 2U);
  EXPECT_EQ(CountOf(map, "<circle class=\"untagged\""), 1U);
  EXPECT_EQ(CountOf(map, "class=\"beyond\""), 1U) << "the tag that is 400 m away";
  EXPECT_EQ(CountOf(map, "<polyline class=\"cameras\""), 2U) << "one per flight";
  EXPECT_EQ(CountOf(map, "<polyline class=\"tags\""), 2U);
  EXPECT_EQ(CountOf(map, "class=\"north\""), 1U);
  EXPECT_EQ(CountOf(map, "class=\"scale\""), 1U);
  EXPECT_NE(map.find("moved by 2.4\xE2\x80\xAFm for a lag of 0.30\xE2\x80\xAFs"), std::string::npos);
  const auto size = base::FindAll(map, kSize);
  ASSERT_FALSE(size.empty());
  const double width_px = std::stod(size[0][1]), height_px = std::stod(size[0][2]);
  const auto arrows = base::FindAll(map, "</title><path[^>]* d=\"M[-0-9.]+ [-0-9.]+L([-0-9.]+) ([-0-9.]+)");
  for (const base::PatternMatch& arrow : arrows) {
    const double x_px = std::stod(arrow[1]), y_px = std::stod(arrow[2]);
    EXPECT_TRUE(x_px >= 0.0 && x_px <= width_px && y_px >= 0.0 && y_px <= height_px) << arrow[0];
  }
  EXPECT_EQ(arrows.size(), 80U);
}

TEST_F(GeoPage, SmallResidualsAreExaggeratedAndTheMapSaysSo) {
  EXPECT_NE(GeoMap(survey_).find("<b>5 times too far</b>"), std::string::npos);
  // Tags that are ten times as far away need no exaggeration.
  for (survey::Photo& photo : survey_.photos) {
    if (photo.gps) photo.gps->latitude_deg += 3e-4;
  }
  EXPECT_EQ(GeoMap(survey_).find("times too far"), std::string::npos);
}

TEST_F(GeoPage, MapOfOnePhotoOrOneLineHasASize) {
  for (const size_t n : {size_t{9}, size_t{1}}) {
    survey_.photos.resize(n);
    const std::string map = GeoMap(survey_);
    ExpectBalanced(map);
    const auto size = base::FindAll(map, kSize);
    ASSERT_FALSE(size.empty());
    EXPECT_GT(std::stod(size[0][1]), 250.0);
    EXPECT_GT(std::stod(size[0][2]), 250.0);
  }
}

TEST_F(GeoPage, ChartsShowEveryResidualAndHeight) {
  const std::string charts = GeoCharts(sample_->survey);
  ExpectBalanced(charts);
  EXPECT_EQ(CountOf(charts, "<figure"), 2U);
  EXPECT_NE(charts.find("flight time (min), pauses"), std::string::npos);
  // 78 used tags with three components each, and one of them without height; then heights as recorded and corrected.
  EXPECT_EQ(CountOf(charts, "h0"), 3U * 78U - 1U + 2U * 77U);
  EXPECT_EQ(CountOf(charts, "m-3 0a3 3"), 2U * 3U + 2U) << "rings: two tags that are not used";
  EXPECT_EQ(CountOf(charts, "<path class=\"curve c0\""), 2U) << "camera heights, one line per flight";
  EXPECT_EQ(CountOf(charts, "</i>fitted cameras"), 1U);
  EXPECT_EQ(CountOf(charts, "Points beyond the chart"), 2U);
}

TEST_F(GeoPage, ChartsOfPhotosWithoutTimesSaySo) {
  survey_.photos[5].time_s.reset();
  EXPECT_EQ(CountOf(GeoCharts(survey_), "photo, in order of names"), 2U);
}

TEST_F(GeoPage, GravityEvidenceIsInTableAndPlot) {
  const std::string html = GravityEvidenceTable(sample_->survey);
  ExpectBalanced(html);
  EXPECT_NE(html.find("A fit to the tags alone would tilt the survey by 4.4\xC2\xB0."), std::string::npos);
  EXPECT_NE(html.find("<td>Gimbal angles in the tags</td><td class=\"num\" data-v=\"81\">81</td>"), std::string::npos);
  EXPECT_NE(html.find(">0.14\xC2\xB0 to the south-east<"), std::string::npos) << "0.12 east, 0.08 south";
  EXPECT_NE(html.find(">0.50\xC2\xB0 to the north-west<"), std::string::npos) << "0.4 west, 0.3 north";
  EXPECT_NE(html.find("--share:0.780\"></i>78\xE2\x80\xAF%"), std::string::npos);
  EXPECT_NE(html.find(">not used<"), std::string::npos);
  EXPECT_EQ(CountOf(html, "<circle class=\"dot\""), 3U);
  EXPECT_EQ(CountOf(html, "<circle class=\"dot hollow\""), 1U) << "GPS heights, without weight";
  EXPECT_EQ(CountOf(html, "<circle class=\"error\""), 3U);
}

TEST_F(GeoPage, EvidenceFarBeyondTheOthersStandsOnTheRim) {
  survey_.fit.gravity[3].lean_east_deg = 19.0;
  survey_.fit.gravity[3].lean_north_deg = 0.0;
  const std::string html = GravityEvidenceTable(survey_);
  EXPECT_NE(html.find("GPS heights (beyond the rim)"), std::string::npos);
  EXPECT_NE(html.find("<circle class=\"dot hollow\" cx=\"308.0\" cy=\"170.0\""), std::string::npos) << html;
}

TEST_F(GeoPage, ALocalFrameIsSaidWithItsReasonAndHasNoMap) {
  const std::string html = GeoSection(poor_->input);
  ExpectBalanced(html);
  EXPECT_NE(html.find("levelled local frame of unknown scale"), std::string::npos);
  EXPECT_NE(html.find("<li>None of the photos &lt;at all&gt; has GPS tags.</li>"), std::string::npos);
  EXPECT_EQ(html.find("geo-map"), std::string::npos);
  EXPECT_EQ(html.find("Accuracy of the place"), std::string::npos);
  EXPECT_NE(html.find("Evidence for the direction of gravity"), std::string::npos);
  EXPECT_EQ(html.find("to the north"), std::string::npos) << "no direction is known";
  EXPECT_EQ(ValueOf(html, "Lens distortion k1"),
            "\xE2\x88\x92"
            "0.0123 \xC2\xB1 0.0004");
}

TEST_F(GeoPage, ScaleBarsMakeMetresOfALocalFrame) {
  survey::Survey survey = poor_->survey;
  survey.fit.scale_bars = {{"left", "<right>", 2.5, 2.493}};
  const std::string html = SectionOf(survey);
  ExpectBalanced(html);
  EXPECT_EQ(html.find("Lengths are not metres"), std::string::npos);
  EXPECT_NE(html.find("Lengths are metres by the scale bars"), std::string::npos);
  EXPECT_NE(html.find("left to &lt;right&gt;"), std::string::npos);
}

TEST_F(GeoPage, ALocalFrameNeverComparesTagsWithIt) {
  survey::Survey survey = sample_->survey;  // tags and all
  survey.georeferenced = false;
  const std::string html = SectionOf(survey);
  ExpectBalanced(html);
  EXPECT_EQ(html.find("geo-map"), std::string::npos);
  EXPECT_EQ(html.find("Residuals"), std::string::npos);
}

TEST_F(GeoPage, AnExactFrameIsOnlyComparedWithItsTags) {
  const survey::Survey exact = ExactSurvey();
  EXPECT_TRUE(FrameIsExact(exact.fit));
  EXPECT_FALSE(FrameIsExact(sample_->survey.fit));
  EXPECT_FALSE(FrameIsExact(survey::GeoFit{}));
  const std::string html = SectionOf(exact);
  ExpectBalanced(html);
  EXPECT_NE(html.find("known exactly from the simulation"), std::string::npos);
  EXPECT_EQ(html.find("class=\"figures\""), std::string::npos);
  EXPECT_EQ(html.find("Evidence for"), std::string::npos);
  EXPECT_EQ(CountOf(html, "<svg"), 3U) << "map and two charts";
  EXPECT_NE(html.find("Residuals by photo"), std::string::npos);
  metrics::Metrics metrics = sample_->metrics;
  metrics.geo_fit = exact.fit;
  ReportInput input = sample_->input;
  input.metrics = &metrics;
  EXPECT_NE(SummarySection(input).find("78 of 80 GPS tags used; the frame is known exactly<"), std::string::npos);
}

TEST_F(GeoPage, SaysThatTheShapeIsThatOfTheTags) {
  EXPECT_EQ(SectionOf(survey_).find("bundle adjustment"), std::string::npos);
  survey_.fit.adjusted_to_tags = true;
  EXPECT_NE(SectionOf(survey_).find("a bundle adjustment with the tags"), std::string::npos);
}

TEST_F(GeoPage, AnExactFrameWithoutTagsHasNothingToShow) {
  survey::Survey exact = ExactSurvey();
  exact.fit.n_matches = exact.fit.n_inliers = 0;
  for (survey::Photo& photo : exact.photos) {
    photo.gps.reset();
    photo.gps_residual_m = kNotMeasured;
  }
  const std::string html = SectionOf(exact);
  ExpectBalanced(html);
  EXPECT_EQ(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find("No photo has a GPS tag"), std::string::npos);
  EXPECT_EQ(html.find("RMSE"), std::string::npos);
}

TEST_F(GeoPage, ResidualTableHasTheThreeDirectionsAndTheWorstFirst) {
  const std::string table = ResidualTable(sample_->survey);
  ExpectBalanced(table);
  EXPECT_LT(table.find("DJI_1060.JPG"), table.find("DJI_1040.JPG"));
  EXPECT_EQ(CountOf(table, "<tr><td>"), 80U);
  EXPECT_NE(table.find("1 photo has no usable GPS tag and is not listed."), std::string::npos);
  // The tag without height: no residual upwards.
  const size_t row = table.find("DJI_1012.JPG");
  ASSERT_NE(row, std::string::npos);
  EXPECT_NE(table.substr(row, table.find("</tr>", row) - row).find("<td class=\"num\" data-v=\"\">\xE2\x80\x93</td>"), std::string::npos);
}

TEST_F(GeoPage, NamesAndTextsNeverBecomeMarkup) {
  survey_.fit.gravity[0].kind = "<script>kind";
  survey_.photos[77].name = "<script>untagged.jpg";
  const std::string html = SectionOf(survey_);
  EXPECT_EQ(html.find("<b>DJI"), std::string::npos);
  EXPECT_EQ(html.find("<script>"), std::string::npos);
  EXPECT_EQ(html.find("<FC300S>"), std::string::npos);
  // On the map and in the table.
  EXPECT_EQ(CountOf(html, "&lt;b&gt;DJI &amp; &quot;co&quot;&lt;/b&gt;.jpg"), 2U);
  // In the plot's tooltip, in its legend and in the table.
  EXPECT_EQ(CountOf(html, "&lt;script&gt;kind"), 3U);
}

TEST_F(GeoPage, TheBlockMapShowsTagsWithoutHeightToo) {
  for (survey::Photo& photo : survey_.photos) {
    if (photo.gps) photo.gps->height_m = kNotMeasured;
  }
  ReportInput input = sample_->input;
  input.survey = &survey_;
  const std::string map = BlockMapSvg(input);
  EXPECT_EQ(CountOf(map, "<polyline class=\"track\""), 2U);
  EXPECT_EQ(CountOf(map, "h6m-3 -3v6"), 80U);
  EXPECT_EQ(map.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::evaluate::page
