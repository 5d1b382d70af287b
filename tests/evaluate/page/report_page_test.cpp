#include "evaluate/page/report_page.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <memory>

#include "core/base/file.h"
#include "core/base/pattern.h"
#include "evaluate/page/report_images.h"
#include "evaluate/page/sections.h"
#include "tests/evaluate/page/count_of.h"
#include "tests/evaluate/page/sample_report.h"

namespace skyquilt::evaluate::page {
namespace {

// A good and a poor sample for all tests; SKYQUILT_SAMPLE_REPORT=<folder> keeps their pages for a look at them.
class ReportPage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const char* kept = std::getenv("SKYQUILT_SAMPLE_REPORT");
    keep_ = kept != nullptr;
    folder_ = keep_ ? std::filesystem::path(kept) : std::filesystem::temp_directory_path() / ("skyquilt_report_" + std::to_string(::getpid()));
    sample_ = std::make_unique<SampleReport>(folder_);
    AddSurface();
    html_ = BuildReportPage(sample_->input);
    poor_ = std::make_unique<SampleReport>(folder_);
    poor_->MakePoor();
    if (!keep_) return;
    base::WriteFileAtomically(folder_ / "index.html", html_);
    base::WriteFileAtomically(folder_ / "poor.html", BuildReportPage(poor_->input));
  }
  static void TearDownTestSuite() {
    sample_.reset();
    poor_.reset();
    if (!keep_) std::filesystem::remove_all(folder_);
  }
  // Scores by class, and normals of the first photo.
  static void AddSurface() {
    metrics::Metrics& metrics = sample_->metrics;
    metrics.classes = {{"roof", 123456, 789, 0.021, 0.084, 0.093, 0.612, 9.4, 14.2}, {.name = "tree"}};
    metrics.flat_roofs = 14;
    metrics.flat_roof_rms_m = 0.087;
    metrics.flat_roof_nmad_m = 0.031;
    const image::Image8 photo(64, 42, 3, 100);
    const image::ImageF normals(64, 42, 3, 0.57735F);
    const std::vector<uint8_t> scored(photo.data.size() / 3, 1);
    const PhotoImages written = WritePhotoImages({&photo, &photo, nullptr, scored, &normals, &normals}, folder_, "surface", 960, 0.25F);
    sample_->input.images[0].normals = written.normals;
    sample_->input.images[0].true_normals = written.true_normals;
  }
  static inline std::filesystem::path folder_;
  static inline bool keep_ = false;
  static inline std::unique_ptr<SampleReport> sample_, poor_;
  static inline std::string html_;
};

TEST_F(ReportPage, TellsWhereTrainingTimeWent) {
  const size_t at = html_.find("Where training time goes");
  ASSERT_NE(at, std::string::npos);
  // Longest first: 0.9 of 1.5.
  EXPECT_LT(html_.find("network backward", at), html_.find("hash forward", at));
  EXPECT_NE(html_.find("60.0\xE2\x80\xAF%", at), std::string::npos);
}

TEST_F(ReportPage, SurfacesAreScoredByClassWhereTheTruthIsKnown) {
  const size_t at = html_.find("Surface by class");
  ASSERT_NE(at, std::string::npos);
  for (const char* text :
       {">roof<", ">tree<", "0.093\xE2\x80\xAFm", "9.4\xC2\xB0", "14 flat roofs are rough by", "0.087\xE2\x80\xAFm", "0.031\xE2\x80\xAFm"}) {
    EXPECT_NE(html_.find(text, at), std::string::npos) << text;
  }
  EXPECT_EQ(CountOf(html_, "alt=\"Normals of the render\""), 1U);
  EXPECT_EQ(CountOf(html_, "alt=\"True normals\""), 1U);
  const std::string poor = BuildReportPage(poor_->input);
  EXPECT_EQ(poor.find("Surface by class"), std::string::npos);
}

// Columns of the density's and the predicted normals are there only when those were measured.
TEST_F(ReportPage, NormalsOfTheFieldHaveColumnsWhenTheyWereMeasured) {
  metrics::Metrics metrics;
  metrics.classes = {{.name = "roof"}, {.name = "tree"}};
  const std::string density = "Of the density's normals", head = "Of the predicted normals";
  const auto has = [&](const std::string& column) { return ClassTable(metrics).find(column) != std::string::npos; };
  EXPECT_FALSE(has(density) || has(head));
  metrics.classes[1].density_normal_median_deg = 21.5;
  EXPECT_TRUE(has(density) && has("21.5\xC2\xB0"));
  EXPECT_FALSE(has(head));
  metrics.classes[0].head_normal_median_deg = 6.5;
  EXPECT_TRUE(has(density) && has(head) && has("6.5\xC2\xB0"));
  const std::string table = ClassTable(metrics);
  EXPECT_EQ(CountOf(table, "<td"), 2 * CountOf(table, "<th class") + 2);
}

TEST_F(ReportPage, OpensOfflineAndEveryPictureExists) {
  EXPECT_EQ(html_.find("http://"), std::string::npos);
  EXPECT_EQ(html_.find("https://"), std::string::npos);
  EXPECT_EQ(html_.find("@import"), std::string::npos);
  const auto pictures = base::FindAll(html_, "(?:src|href)=\"(images/[^\"]+)\"");
  for (const base::PatternMatch& picture : pictures) EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / picture[1])) << picture[1];
  EXPECT_GE(pictures.size(), 4 * sample_->metrics.photos.size());
}

TEST_F(ReportPage, LinksWithinThePageArrive) {
  const auto links = base::FindAll(html_, "href=\"#([^\"]+)\"");
  for (const base::PatternMatch& link : links) EXPECT_EQ(CountOf(html_, "id=\"" + link[1] + "\""), 1U) << link[1];
  EXPECT_GT(links.size(), 10U);
}

TEST_F(ReportPage, FileNamesNeverBecomeMarkup) {
  EXPECT_EQ(html_.find("<b>DJI"), std::string::npos);
  EXPECT_NE(html_.find("&lt;b&gt;DJI &amp; &quot;co&quot;&lt;/b&gt;.jpg"), std::string::npos);
  EXPECT_EQ(html_.find("town <sample>"), std::string::npos);
}

TEST_F(ReportPage, TagsAreBalancedAndNoNumberIsNan) {
  for (const char* tag : {"section", "table", "tbody", "tr", "svg", "figure", "article", "details", "div", "span", "dl", "a"}) {
    const std::string name(tag);
    const size_t opened = CountOf(html_, "<" + name + " ") + CountOf(html_, "<" + name + ">");
    EXPECT_EQ(opened, CountOf(html_, "</" + name + ">")) << name;
  }
  EXPECT_EQ(CountOf(html_, "\"nan\"") + CountOf(html_, ">nan") + CountOf(html_, "inf\""), 0U);
}

TEST_F(ReportPage, AtMostSixKeyFiguresStandBeforeTheDetails) {
  for (const SampleReport* sample : {sample_.get(), poor_.get()}) {
    const std::string html = BuildReportPage(sample->input);
    const size_t details = html.find("id=\"details\"");
    ASSERT_NE(details, std::string::npos);
    const size_t before = CountOf(html.substr(0, details), "<div class=\"kpi\">");
    EXPECT_GE(before, 4U);
    EXPECT_LE(before, 6U);
    EXPECT_EQ(CountOf(html, "<div class=\"kpi\">"), before);
    // A label, a value and a note each.
    EXPECT_EQ(base::FindAll(html, "<div class=\"kpi\"><span>[^<]+</span><strong>[^<]+</strong><small>[^<]+</small></div>").size(), before);
  }
}

TEST_F(ReportPage, TheFirstScreenSaysWhereOnEarthOrThatNothingDoes) {
  const std::string good = SummarySection(sample_->input), poor = SummarySection(poor_->input);
  EXPECT_NE(good.find("2.41\xE2\x80\xAFm"), std::string::npos) << good;
  EXPECT_NE(good.find("78 of 80 GPS tags used; place \xC2\xB1"
                      "1.6\xE2\x80\xAFm, scale \xC2\xB1"
                      "0.21\xE2\x80\xAF%, tilt \xC2\xB1"
                      "0.31\xC2\xB0<"),
            std::string::npos)
      << good;
  EXPECT_NE(good.find("6.1\xE2\x80\xAF"
                      "cm</strong>"),
            std::string::npos)
      << good;
  EXPECT_NE(good.find("photos reduced to 480 pixels width"), std::string::npos) << good;
  // Five blocks of 100 m by 150 m.
  EXPECT_NE(good.find("7.50\xE2\x80\xAFha"), std::string::npos) << good;
  EXPECT_NE(good.find("Depth error"), std::string::npos) << good;
  EXPECT_NE(poor.find("<strong>none</strong>"), std::string::npos) << poor;
  EXPECT_EQ(poor.find("per pixel"), std::string::npos) << "a scale nobody knows: " << poor;
  EXPECT_EQ(poor.find("\xE2\x80\xAFha"), std::string::npos) << poor;
  EXPECT_EQ(poor.find("Depth error"), std::string::npos) << poor;
  EXPECT_NE(poor.find("31.0\xE2\x80\xAF%"), std::string::npos) << "coverage instead: " << poor;
}

TEST_F(ReportPage, EveryWarningSaysWhatToDo) {
  for (const SampleReport* sample : {sample_.get(), poor_.get()}) {
    const std::vector<metrics::Warning>& warnings = sample->metrics.warnings;
    EXPECT_GE(warnings.size(), 4U);
    const std::string banner = WarningsBanner(sample->metrics);
    EXPECT_NE(BuildReportPage(sample->input).find(banner), std::string::npos);
    EXPECT_EQ(base::FindAll(banner, "<li>[^<]+<span class=\"advice\"><b>What to do:</b>[^<]+</span></li>").size(), warnings.size());
  }
}

TEST_F(ReportPage, PrintsAsAReportOnPaper) {
  EXPECT_NE(html_.find("size:A4", html_.find("@page {")), std::string::npos);
  const size_t print = html_.find("@media print");
  ASSERT_NE(print, std::string::npos);
  // Later rules win: none for the screen may follow.
  EXPECT_EQ(html_.find("@media (max-width", print), std::string::npos);
  EXPECT_NE(html_.find("display:table-header-group", print), std::string::npos);
  EXPECT_NE(html_.find("break-inside:avoid", print), std::string::npos);
  // Dark colours are for the screen alone, and what is folded away opens.
  EXPECT_EQ(CountOf(html_, "color-scheme:dark }"), 2U);
  EXPECT_EQ(CountOf(html_, "@media screen"), 2U);
  EXPECT_NE(html_.find("beforeprint"), std::string::npos);
}

TEST_F(ReportPage, DetailsTellWhatPredictedGainsAreWorthAndExplainEveryFigure) {
  const std::string details = DetailsSection(sample_->input);
  for (const char* name : {"PSNR with the EXIF gain alone", "PSNR of right halves, as rendered", "with gains fitted to the left halves",
                           "Floater opacity", "Exposure seams", "Seam gap", "Parameters"}) {
    EXPECT_NE(details.find(name), std::string::npos) << name;
  }
  EXPECT_EQ(CountOf(details, "<td></td>"), 0U);
  EXPECT_NE(MethodSection(sample_->input).find("given: found together with those of all other photos"), std::string::npos);
  EXPECT_EQ(DetailsSection(poor_->input).find("Floater opacity"), std::string::npos) << "needs true depth";
}

TEST_F(ReportPage, BrightnessHasChartsPicturesAndATooltipPerPhoto) {
  const std::string section = BrightnessSection(sample_->input);
  EXPECT_NE(html_.find(section), std::string::npos);
  EXPECT_EQ(CountOf(html_, "href=\"#brightness\""), 1U);
  EXPECT_EQ(CountOf(section, "<svg"), 3U);
  EXPECT_EQ(CountOf(section, "<title>flight"), sample_->survey.photos.size());
  EXPECT_EQ(CountOf(section, " (held out)\n"), sample_->metrics.photos.size());
  EXPECT_EQ(CountOf(section, "dot c7"), sample_->survey.photos.size());
  EXPECT_EQ(CountOf(section, "dot c7 hollow"), sample_->metrics.photos.size());
  EXPECT_EQ(CountOf(section, "<img src=\"images/brightness_"), 6U);
  EXPECT_NE(section.find("87\xE2\x80\xAF%"), std::string::npos);
  EXPECT_NE(section.find("0.62 \xE2\x86\x92 0.21\xE2\x80\xAFstops"), std::string::npos);
  EXPECT_NE(section.find("<b>+1.23\xE2\x80\xAFstops</b>"), std::string::npos);
}

TEST_F(ReportPage, BrightnessEscapesNamesAndSentences) {
  const std::string section = BrightnessSection(sample_->input);
  EXPECT_EQ(section.find("<b>DJI"), std::string::npos);
  // In a tooltip and over the pictures.
  EXPECT_EQ(CountOf(section, "&lt;b&gt;DJI &amp; &quot;co&quot;&lt;/b&gt;.jpg"), 2U);
  EXPECT_NE(section.find("Concealing field &lt;none&gt;."), std::string::npos);
}

TEST_F(ReportPage, ThereIsNoBrightnessWithoutFindings) {
  const BrightnessReport nothing;
  ReportInput input = sample_->input;
  input.brightness = &nothing;
  EXPECT_EQ(BrightnessSection(input), "");
  EXPECT_EQ(BuildReportPage(input).find("#brightness"), std::string::npos);
  input.brightness = nullptr;
  EXPECT_EQ(BrightnessSection(input), "");
}

TEST_F(ReportPage, BrightnessOfOnePhotoThatLearnedNothing) {
  BrightnessReport one;
  one.photos.push_back({"only.jpg", 0, 0.0, false, 0.0, {}});
  ReportInput input = sample_->input;
  input.brightness = &one;
  const std::string section = BrightnessSection(input);
  EXPECT_EQ(CountOf(section, "<svg"), 1U);
  EXPECT_EQ(CountOf(section, "<circle"), 1U);
  EXPECT_NE(section.find("Nothing beyond the tags was learned"), std::string::npos);
  EXPECT_EQ(section.find("nan"), std::string::npos);
}

TEST_F(ReportPage, ShowsTheShadingOfPhotosAsSmallPictures) {
  BrightnessReport shaded;
  shaded.shading_grid = {3, 2};
  shaded.photos.push_back({"dark <left>.jpg", 0, 0.0, false, 0.0, {}, {-0.5F, 0.0F, 0.5F, -0.5F, 0.0F, 0.5F}});
  shaded.photos.push_back({"held_out.jpg", 0, 1.0, true, 0.0, {}});
  ReportInput input = sample_->input;
  input.brightness = &shaded;
  const std::string section = BrightnessSection(input);
  EXPECT_EQ(CountOf(section, "<rect x="), 6U);  // held-out photos have none
  EXPECT_NE(section.find("dark &lt;left&gt;.jpg: "), std::string::npos);
  EXPECT_NE(section.find("Light within the photos"), std::string::npos);
  shaded.shading_grid = {};
  EXPECT_EQ(BrightnessSection(input).find("Light within the photos"), std::string::npos);
}

TEST_F(ReportPage, LongPausesDoNotSqueezeTheFlights) {
  BrightnessReport two_days;
  two_days.timed = true;
  for (const double time_s : {0.0, 60.0, 86400.0, 86460.0}) {
    two_days.photos.push_back({"p.jpg", time_s < 3600.0 ? 0 : 1, time_s, false, time_s < 3600.0 ? 0.0 : 0.5, {}});
  }
  ReportInput input = sample_->input;
  input.brightness = &two_days;
  const std::string section = BrightnessSection(input);
  EXPECT_NE(section.find("pauses of more than 10 min"), std::string::npos);
  // Three minutes are left, and each flight has a line of its own.
  EXPECT_EQ(section.find(">1440<"), std::string::npos);
  const size_t line = section.find("<path class=\"curve c6\"");
  ASSERT_NE(line, std::string::npos);
  EXPECT_EQ(CountOf(section.substr(line, section.find("<title>", line) - line), "M"), 2U);
}

TEST(ReportPageOfNothing, SaysWhatIsMissing) {
  const std::string html = BuildReportPage(ReportParts().input);
  EXPECT_NE(html.find("No photo was scored"), std::string::npos);
  EXPECT_NE(html.find("no geo-reference: local frame, unknown scale"), std::string::npos);
  EXPECT_NE(html.find("No data"), std::string::npos);
  EXPECT_EQ(CountOf(html, "\"nan\"") + CountOf(html, ">nan") + CountOf(html, ">inf"), 0U);
}

TEST_F(ReportPage, BackgroundNeedsPictureAndBounds) {
  const std::filesystem::path products = folder_ / "products";
  std::filesystem::create_directories(products);
  EXPECT_FALSE(CopyMapBackground(products, folder_).has_value());
  image::SavePng(image::Image8(8, 4, 3, 90), products / "orthophoto.png");
  std::ofstream(products / "orthophoto.json") << "{\"min_enu\": [0, 0]}";
  EXPECT_FALSE(CopyMapBackground(products, folder_).has_value());
  std::ofstream(products / "orthophoto.json") << "{\"min_enu\": [-5, -2.5], \"max_enu\": [5, 2.5]}";
  const auto background = CopyMapBackground(products, folder_);
  ASSERT_TRUE(background.has_value());
  EXPECT_DOUBLE_EQ(background->min_enu.y(), -2.5);
  EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / background->image));
}

TEST_F(ReportPage, AnOrthophotoTakesThePlaceOfItsPreview) {
  const std::filesystem::path products = folder_ / "previewed";
  std::filesystem::create_directories(products);
  image::SavePng(image::Image8(8, 4, 3, 90), products / "preview_ortho.png");
  std::ofstream(products / "preview_ortho.json") << "{\"min_enu\": [-5, -2.5], \"max_enu\": [5, 2.5], \"preview\": \"sparse points\"}";
  const auto preview = CopyMapBackground(products, folder_);
  ASSERT_TRUE(preview.has_value());
  EXPECT_EQ(preview->preview, "sparse points");
  ReportInput page = sample_->input;
  page.background = preview;
  EXPECT_EQ(CountOf(BuildReportPage(page), "Orthophoto (preview: from the sparse points)"), 1U);
  EXPECT_EQ(CountOf(html_, "(preview:"), 0U);
  image::SavePng(image::Image8(8, 4, 3, 90), products / "orthophoto.png");
  std::ofstream(products / "orthophoto.json") << "{\"min_enu\": [-5, -2.5], \"max_enu\": [5, 2.5]}";
  const auto orthophoto = CopyMapBackground(products, folder_);
  ASSERT_TRUE(orthophoto.has_value());
  EXPECT_EQ(orthophoto->preview, "");
  EXPECT_EQ(orthophoto->image, "images/orthophoto.png");
}

TEST(ErrorPicture, PixelsThatDoNotCountAreGrey) {
  const image::Image8 photo(2, 1, 3, 200), render(2, 1, 3, 100);
  const image::ImageF error = AbsoluteError(photo, render);
  EXPECT_NEAR(error.data[0], 100.0F / 255.0F, 1e-6F);
  const std::vector<uint8_t> scored = {1, 0};
  const image::Image8 picture = ErrorPicture({&photo, &render, nullptr, scored}, 0.25F);
  EXPECT_FALSE(picture.data[0] == picture.data[1] && picture.data[1] == picture.data[2]);
  EXPECT_TRUE(picture.data[3] == picture.data[4] && picture.data[4] == picture.data[5]);
}

}  // namespace
}  // namespace skyquilt::evaluate::page
