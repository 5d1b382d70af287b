#include "evaluate/page/control_section.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/image/image.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/sections.h"
#include "tests/evaluate/page/count_of.h"
#include "tests/evaluate/page/sample_report.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using survey::ControlUse;

survey::ControlPointFit Point(const std::string& label, ControlUse use, const Vector3d& given_in_enu, const Vector3d& error_m) {
  survey::ControlPointFit point;
  point.label = label;
  point.use = use;
  point.given_in_enu = given_in_enu;
  point.error_m = error_m;
  point.sigma_m = {0.02, 0.02, 0.03};
  point.error_px = 0.4;
  point.gsd_m = 0.06;
  return point;
}

survey::ControlFit SampleControl() {
  survey::ControlFit fit;
  fit.file = "gcp_list.txt";
  fit.crs = "WGS 84 / UTM zone 32N";
  fit.heights = "ellipsoid";
  fit.placed = fit.adjusted = true;
  const Vector3d unknown = Vector3d::Constant(kNotMeasured);
  fit.points = {Point("gcp<1>", ControlUse::kControl, {-120.0, -120.0, 1.0}, {0.01, -0.02, 0.03}),
                Point("gcp2", ControlUse::kRejected, {120.0, -120.0, 1.0}, {5.0, 0.4, -0.2}),
                Point("gcp3", ControlUse::kUnseen, {0.0, 0.0, kNotMeasured}, unknown),
                Point("check1", ControlUse::kCheck, {60.0, 30.0, 2.0}, {0.04, 0.01, -0.05})};
  return fit;
}

// The sample's pictures take two seconds, so that all tests share them; each begins with the same survey and metrics.
class ControlPage : public ::testing::Test {
 protected:
  ControlPage() {
    static const survey::Survey survey = sample_.survey;
    static const metrics::Metrics metrics = sample_.metrics;
    sample_.survey = survey;
    sample_.survey.control = SampleControl();
    sample_.metrics = metrics;
    sample_.input.mark_pictures.clear();
  }
  static const TemporaryFolder& SharedFolder() {
    static const TemporaryFolder folder;
    return folder;
  }
  static SampleReport& Shared() {
    static SampleReport sample(SharedFolder().path());
    return sample;
  }

  SampleReport& sample_ = Shared();
  const TemporaryFolder& folder_ = SharedFolder();
};

TEST_F(ControlPage, TellsErrorsAndWhatTheyMean) {
  const std::string html = ControlSection(sample_.input);
  ExpectBalanced(html);
  EXPECT_NE(html.find("gcp&lt;1&gt;"), std::string::npos);
  EXPECT_NE(html.find("The check points are within the usual limits"), std::string::npos);
  EXPECT_NE(html.find("1 control point contradicts the others"), std::string::npos);
  EXPECT_NE(html.find("There are fewer than 30 check points (1)."), std::string::npos);
  EXPECT_NE(html.find("<b>rejected</b>"), std::string::npos);
  EXPECT_EQ(CountOf(html, "<g class=\"point "), 4U);
  EXPECT_EQ(CountOf(html, "class=\"height low\""), 2U);
  EXPECT_EQ(CountOf(html, "class=\"beyond\""), 1U);  // the rejected point does not set the scale
}

TEST_F(ControlPage, IsThereOnlyWithPoints) {
  EXPECT_NE(BuildReportPage(sample_.input).find("href=\"#control\""), std::string::npos);
  sample_.survey.control = {};
  EXPECT_EQ(ControlSection(sample_.input), "");
  const std::string page = BuildReportPage(sample_.input);
  EXPECT_EQ(page.find("href=\"#control\""), std::string::npos);
}

TEST_F(ControlPage, ChecksComeBeforeTags) {
  sample_.metrics.control = sample_.survey.control;
  const std::string figures = SummarySection(sample_.input);
  EXPECT_NE(figures.find("Error at check points"), std::string::npos);
  EXPECT_NE(figures.find("0.050\xE2\x80\xAFm vertically at 1 check point<"), std::string::npos) << figures;
  EXPECT_EQ(figures.find("against GPS"), std::string::npos);
  EXPECT_NE(GeoSection(sample_.input).find("by its <a href=\"#control\">control points</a>"), std::string::npos);
  sample_.metrics.control = sample_.survey.control = {};
  EXPECT_NE(SummarySection(sample_.input).find("against GPS"), std::string::npos);
  EXPECT_EQ(GeoSection(sample_.input).find("#control"), std::string::npos);
}

TEST_F(ControlPage, MetricsHaveThePoints) {
  metrics::Metrics metrics = sample_.metrics;
  EXPECT_FALSE(base::ParseJson(metrics::MetricsJson(metrics)).contains("control"));
  metrics.control = SampleControl();
  const auto json = base::ParseJson(metrics::MetricsJson(metrics));
  EXPECT_EQ(json["control"]["points"].size(), 4U);
  EXPECT_EQ(json["control"]["check"]["rmse_m"][0], 0.04);
}

TEST_F(ControlPage, MarksOfAPhotoAreShownWithCrossAndRing) {
  survey::Survey& survey = sample_.survey;
  survey.photo_root = folder_ / "photos";
  std::filesystem::create_directories(survey.photo_root / "flight1");
  // A photo of one colour with a white pixel at the mark.
  const survey::Photo& photo = survey.photos[0];
  image::Image8 pixels(640, 420, 3, 40);
  std::fill_n(pixels.At(300, 200), 3, uint8_t{255});
  image::SavePng(pixels, folder_ / "photo.png");
  std::filesystem::rename(folder_ / "photo.png", survey.photo_root / photo.name);
  survey::ControlPointFit& point = survey.control.points[0];
  // On the ground where the photo sees pixel (302.5, 200.5).
  const geo::Rigid3d enu_from_cam = photo.cam_from_enu.Inverse();
  const Vector3d ray = enu_from_cam.rotation * survey.cameras[0].RayFromImg({302.5, 200.5});
  point.given_in_enu = photo.cam_from_enu.OriginInSource() + 120.0 * ray;
  point.error_m.setZero();
  point.marks = {{.photo = photo.name, .pixel = {300.5, 200.5}, .error_px = 2.0, .used = true}, {.photo = "not there.jpg", .pixel = {10.0, 10.0}}};
  base::ThreadPool threads(1);
  const std::vector<control::MarkPicture> pictures = control::WriteMarkPictures(survey, nullptr, folder_.path(), threads);
  ASSERT_EQ(pictures.size(), 1U);
  const control::MarkPicture& picture = pictures[0];
  EXPECT_EQ(picture.marked_px, Vector2d(32.5, 32.5));
  ASSERT_TRUE(picture.projected_px);
  EXPECT_LT((*picture.projected_px - Vector2d(34.5, 32.5)).norm(), 1e-6);
  EXPECT_TRUE(picture.render.empty());
  const image::Image8 crop = image::LoadRgb8(folder_ / picture.photo);
  EXPECT_EQ(crop.width, control::kMarkPicture_px);
  EXPECT_EQ(crop.height, control::kMarkPicture_px);
  EXPECT_EQ(crop.At(32, 32)[0], 255);
  EXPECT_EQ(crop.At(31, 32)[0], 40);
  sample_.input.mark_pictures = pictures;
  const std::string html = ControlSection(sample_.input);
  ExpectBalanced(html);
  EXPECT_EQ(CountOf(html, "<path class=\"cross\""), 1U);
  EXPECT_NE(html.find("cx=\"34.50\" cy=\"32.50\" r=\"4\""), std::string::npos);
}

TEST(MarkWindow, StaysInsideThePhoto) {
  const control::PictureWindow middle = control::WindowAround({300.5, 200.5}, 640, 420);
  EXPECT_EQ(middle.left, 268);
  EXPECT_EQ(middle.top, 168);
  const control::PictureWindow corner = control::WindowAround({639.9, 2.0}, 640, 420);
  EXPECT_EQ(corner.left, 576);
  EXPECT_EQ(corner.top, 0);
  const control::PictureWindow small = control::WindowAround({5.0, 5.0}, 32, 400);
  EXPECT_EQ(small.left, 0);
  EXPECT_EQ(small.width, 32);
  EXPECT_EQ(small.height, 64);
}

}  // namespace
}  // namespace skyquilt::evaluate::page
