#include <gtest/gtest.h>

#include <limits>

#include "evaluate/page/report_images.h"
#include "evaluate/page/sections.h"
#include "tests/evaluate/page/sample_report.h"
#include "tests/support/count_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

// A report of one photo.
struct SmallReport : ReportParts {
  SmallReport() {
    metrics.photos = {{.name = "<one>.jpg"}};
    PhotoImages& images = input.images.emplace_back();
    images.photo = "images/a.jpg";
    images.render = "images/b.jpg";
    images.mesh = "images/c.jpg";
    images.width = 8;
    images.height = 4;
  }
  void AddSurface() {
    surface::SurfaceScores& scores = metrics.surface.emplace();
    scores.psnr = 25.5;
    scores.psnr_field = 26.75;
    scores.pixels = 1000;
    scores.missing_share = 0.0125;
    scores.deck_samples = 10;
    scores.decks_within_2_gsd = 0.9951;
    scores.agreement.accuracy_median_m = 0.0123;
    scores.agreement.completeness_median_m = std::numeric_limits<double>::infinity();
    scores.agreement.f_scores = {{"2 GSD", 0.06, 0.9, 0.8, 0.847}, {"5 cm", 0.05, 0.88, 0.77, 0.8213}};
    scores.classes = {{.name = "roof", .pixels = 100, .missing_pixels = 7, .psnr_db = 24.25, .psnr_field_db = 25.0}, {.name = "tree"}};
    scores.classes[0].agreement.f_scores = {{"2 GSD", 0.06, 0.91, 0.92, 0.915}};
    scores.record.triangles = 335120;
    scores.record.edges = 500000;
    scores.record.boundary_edges = 321;
    scores.record.non_manifold_edges = 0;
    scores.record.files = {{"tiles/tileset.json", "tiles & more", "3D Tiles 1.1", "EPSG:4978", "", 2048, "12 tiles in 4 levels"}};
  }
};

TEST(SurfaceSection, ShowsPicturesScoresAndFiles) {
  SmallReport report;
  report.AddSurface();
  const std::string html = SurfaceSection(report.input);
  for (const char* text : {"25.50\xE2\x80\xAF"
                           "dB",
                           "26.75\xE2\x80\xAF"
                           "dB",
                           "\xE2\x88\x92"
                           "1.25\xE2\x80\xAF"
                           "dB",
                           "84.7\xE2\x80\xAF%", "82.1\xE2\x80\xAF%", "91.5\xE2\x80\xAF%", "99.51\xE2\x80\xAF%", ">roof<", "7.0\xE2\x80\xAF%",
                           "335\xE2\x80\xAF"
                           "120",
                           "321 at borders and 0 with more than two triangles", "href=\"../surface/tiles/tileset.json\"", "tiles &amp; more",
                           "EPSG:4978", "&lt;one&gt;.jpg", "src=\"images/a.jpg\"", "src=\"images/b.jpg\"", "src=\"images/c.jpg\"",
                           "1.2\xE2\x80\xAF"
                           "cm"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text << "\n" << html;
  }
  for (const char* tag : {"section", "table", "tbody", "tr", "td", "article", "figure", "div", "dl", "p", "h3"}) {
    const std::string name(tag);
    EXPECT_EQ(CountOf(html, "<" + name + " ") + CountOf(html, "<" + name + ">"), CountOf(html, "</" + name + ">")) << name;
  }
  EXPECT_EQ(CountOf(html, "nan") + CountOf(html, ">inf"), 0U);
  const std::string page = BuildReportPage(report.input);
  EXPECT_EQ(CountOf(page, "href=\"#surface\""), 1U);
  EXPECT_NE(page.find(html), std::string::npos);
}

TEST(SurfaceSection, IsAbsentWithoutASurface) {
  SmallReport report;
  EXPECT_EQ(SurfaceSection(report.input), "");
  const std::string page = BuildReportPage(report.input);
  EXPECT_EQ(page.find("id=\"surface\""), std::string::npos);
  EXPECT_EQ(page.find("#surface"), std::string::npos);
}

TEST(SurfaceSection, LeavesOutWhatWasNotMeasured) {
  SmallReport report;
  report.metrics.surface.emplace();  // of a real survey, without held-out photos and without surface.json
  report.input.images.clear();
  report.metrics.photos.clear();
  const std::string html = SurfaceSection(report.input);
  EXPECT_NE(html.find("id=\"surface\""), std::string::npos);
  for (const char* absent : {"<table", "true surface", "beside the field in held-out photos", "class=\"views\"", "-1", "nan"}) {
    EXPECT_EQ(html.find(absent), std::string::npos) << absent;
  }
}

TEST(WritePhotoImages, PictureOfTheMeshIsWrittenWhenThereIsOne) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "images");
  const image::Image8 photo(8, 4, 3, 100), mesh(8, 4, 3, 50);
  const std::vector<uint8_t> scored(32, 1);
  PhotoPixels pixels{&photo, &photo, nullptr, scored};
  EXPECT_EQ(WritePhotoImages(pixels, folder.path(), "a", 960, 0.25F).mesh, "");
  pixels.mesh = &mesh;
  const std::string file = WritePhotoImages(pixels, folder.path(), "b", 960, 0.25F).mesh;
  EXPECT_NEAR(image::LoadRgb8(folder / file).data[0], 50, 2);
}

}  // namespace
}  // namespace skyquilt::evaluate::page
