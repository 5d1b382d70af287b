#include "prepare/georeference/scale_bars.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "core/base/file.h"
#include "prepare/georeference/stated_up.h"
#include "tests/prepare/synthetic_flight.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::test {
namespace {

using namespace prepare::georeference;
using Eigen::Vector3d;
namespace control = prepare::control;
namespace input = prepare::input;

const Vector3d kA(-10.0, -8.0, 0.5), kB(12.0, 6.0, 2.0);

// A flight, its photos, and marks of two places in it.
struct MarkedFlight {
  Flight flight = MakeFlight({47.0, 8.0, 400.0});
  std::vector<input::PreparedPhoto> photos = {};
  std::vector<Vector3d> points = {};
  control::ControlPoints marks = {.file = "marks.csv"};

  explicit MarkedFlight(bool tagged) {
    for (size_t i = 0; i < flight.photos.size(); ++i) {
      if (!tagged) flight.photos[i].tags.gps.reset();
      const input::PhotoFile file{.name = flight.photos[i].name, .width = 64, .height = 48, .tags = flight.photos[i].tags};
      photos.push_back(input::PreparePhoto(file, i, flight.model.images[i].cam_from_world));
    }
    for (const survey::ColmapPoint& point : flight.model.points) points.push_back(point.x_in_world);
    for (const auto& [label, place] : {std::pair("A", kA), std::pair("B", kB)}) {
      control::ControlPoint point;
      point.label = label;
      for (const survey::ColmapImage& image : flight.model.images) {
        const auto pixel = flight.model.cameras[1].ImgFromCam(image.cam_from_world * (flight.model_from_enu * place));
        if (pixel && pixel->x() > 0.0 && pixel->y() > 0.0 && pixel->x() < 64.0 && pixel->y() < 48.0) point.marks.push_back({image.name, *pixel, 1});
      }
      marks.points.push_back(point);
    }
  }
  // "x;y;z" in the model's frame.
  std::string InModel(const Vector3d& x_in_enu) const {
    const Vector3d x = flight.model_from_enu * x_in_enu;
    return std::to_string(x.x()) + ";" + std::to_string(x.y()) + ";" + std::to_string(x.z());
  }
  Georeference Placed(const std::string& bars) {
    Georeference georeference = PlaceOnEarth(photos, points, {});
    ApplyScaleBars(ParseScaleBars(bars), marks, flight.model, photos, georeference);
    return georeference;
  }
};

bool HasProblem(const Georeference& georeference, const std::string& code) {
  return std::any_of(georeference.problems.begin(), georeference.problems.end(), [&](const auto& problem) { return problem.code == code; });
}

TEST(ScaleBars, AreReadAsLabelsOrPoints) {
  const std::vector<ScaleBar> bars = ParseScaleBars("door left, door right ,0.98|1;-2;3.5,4;5;6e0,12");
  ASSERT_EQ(bars.size(), 2U);
  EXPECT_EQ(bars[0].a, "door left");
  EXPECT_EQ(bars[0].b, "door right");
  EXPECT_EQ(bars[0].length_m, 0.98);
  EXPECT_FALSE(bars[0].at_a);
  ASSERT_TRUE(bars[1].at_a && bars[1].at_b);
  EXPECT_EQ(*bars[1].at_a, Vector3d(1.0, -2.0, 3.5));
  EXPECT_EQ(*bars[1].at_b, Vector3d(4.0, 5.0, 6.0));
  EXPECT_TRUE(ParseScaleBars("").empty());
}

TEST(ScaleBars, WrongOnesAreNamedWithAWayOut) {
  for (const std::string& wrong : {"A,B", "A,B,1,2", "A,B,0", "A,B,-1", "A,B,nan", "A,B,long", ",B,1", "A,A,1", "A,1;2;3,1", "1;2,3;4;5,1",
                                   "1;2;x,3;4;5,1", "1;2;3,1.0;2;3,1", "A,B,1|", "|"}) {
    const std::string message = UsageErrorOf([&] { ParseScaleBars(wrong); });
    EXPECT_NE(message.find("--scale-bar"), std::string::npos) << wrong;
    EXPECT_NE(message.find("Give A,B,LENGTH"), std::string::npos) << wrong;
  }
}

TEST(ScaleBars, MakeMetresOfALocalFrame) {
  MarkedFlight marked(false);
  const double length_m = (kB - kA).norm();
  ASSERT_GE(std::min(marked.marks.points[0].marks.size(), marked.marks.points[1].marks.size()), 2U);
  for (const std::string& bar : {"A,B," + std::to_string(length_m), marked.InModel(kA) + "," + marked.InModel(kB) + "," + std::to_string(length_m)}) {
    const Georeference local = marked.Placed("");
    ASSERT_FALSE(local.ok);
    EXPECT_NE(local.problems.front().finding.find("lengths are not metres"), std::string::npos);
    EXPECT_FALSE(local.fit.accuracy.HasScale());
    const Georeference scaled = marked.Placed(bar);
    EXPECT_FALSE(scaled.ok);
    EXPECT_NEAR(scaled.enu_from_model.scale * marked.flight.model_from_enu.scale, 1.0, 1e-4) << bar;
    EXPECT_EQ(scaled.fit.scale, scaled.enu_from_model.scale);
    EXPECT_EQ(scaled.fit.accuracy.scale_percent, kLeastBarError_percent);
    // The same frame but for its unit.
    const double factor = scaled.enu_from_model.scale / local.enu_from_model.scale;
    const Vector3d x = marked.points.front();
    EXPECT_LT((scaled.enu_from_model * x - factor * (local.enu_from_model * x)).norm(), 1e-9);
    ASSERT_EQ(scaled.fit.scale_bars.size(), 1U);
    EXPECT_NEAR(scaled.fit.scale_bars[0].measured_m, length_m, 1e-3);
    EXPECT_EQ(scaled.problems.front().finding.find("lengths are not metres"), std::string::npos);
    EXPECT_NE(scaled.problems.front().finding.find("lengths are metres by the scale bars"), std::string::npos);
  }
}

TEST(ScaleBars, ThatContradictEachOtherAreReported) {
  MarkedFlight marked(false);
  const double length_m = (kB - kA).norm();
  const std::string points = marked.InModel(kA) + "," + marked.InModel(kB) + ",";
  const Georeference agree = marked.Placed("A,B," + std::to_string(1.01 * length_m) + "|" + points + std::to_string(0.99 * length_m));
  EXPECT_FALSE(HasProblem(agree, "scale_bars_contradict"));
  EXPECT_NEAR(agree.enu_from_model.scale * marked.flight.model_from_enu.scale, 1.0, 1e-3);
  EXPECT_NEAR(agree.fit.accuracy.scale_percent, 1.0, 0.05);
  const Georeference contradict = marked.Placed("A,B," + std::to_string(1.2 * length_m) + "|" + points + std::to_string(length_m));
  EXPECT_TRUE(HasProblem(contradict, "scale_bars_contradict"));
  EXPECT_EQ(contradict.fit.scale_bars.size(), 2U);
}

TEST(ScaleBars, AreOnlyComparedWithAPlaceOnEarth) {
  MarkedFlight marked(true);
  const double length_m = (kB - kA).norm();
  const Georeference without = marked.Placed("");
  ASSERT_TRUE(without.ok);
  const Georeference same = marked.Placed("A,B," + std::to_string(length_m));
  EXPECT_EQ(same.enu_from_model.scale, without.enu_from_model.scale);
  EXPECT_NEAR(same.fit.scale_bars.at(0).measured_m, length_m, 0.01);
  EXPECT_FALSE(HasProblem(same, "scale_bars_contradict"));
  const Georeference wrong = marked.Placed(marked.InModel(kA) + "," + marked.InModel(kB) + "," + std::to_string(1.1 * length_m));
  EXPECT_EQ(wrong.enu_from_model.scale, without.enu_from_model.scale);
  EXPECT_TRUE(HasProblem(wrong, "scale_bars_contradict"));
}

TEST(ScaleBars, OfMarksThatDoNotMeetAreLeftOutWithAWarning) {
  MarkedFlight marked(false);
  for (control::ControlMark& mark : marked.marks.points[0].marks) mark.photo = "elsewhere.jpg";
  const Georeference georeference = marked.Placed("A,B,25");
  EXPECT_TRUE(HasProblem(georeference, "scale_bar_lost"));
  EXPECT_TRUE(georeference.fit.scale_bars.empty());
  EXPECT_NE(georeference.problems.front().finding.find("lengths are not metres"), std::string::npos);
}

TEST(ScaleMarks, ComeFromAFileOfMarksAlone) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "marks.csv";
  base::WriteFileAtomically(file, "image,label,x,y\na.jpg,left,10,20\nb.jpg,left,12.5,20\na.jpg,right,40,21\nb.jpg,right,44,21\na.jpg,once,5,5\n");
  const std::vector<input::PhotoFile> files = {{.name = "a.jpg", .width = 64, .height = 48}, {.name = "b.jpg", .width = 64, .height = 48}};
  const control::ControlFiles given{.marks = file};
  const control::ControlPoints marks = ReadScaleMarks(ParseScaleBars("left,right,2.5"), given, {}, files);
  ASSERT_EQ(marks.points.size(), 2U);
  EXPECT_EQ(marks.points[0].label, "left");
  ASSERT_EQ(marks.points[0].marks.size(), 2U);
  EXPECT_EQ(marks.points[0].marks[1].photo, "b.jpg");
  EXPECT_EQ(marks.points[0].marks[1].pixel, Eigen::Vector2d(12.5, 20.0));
  for (const std::string& wrong : {"left,once,1", "left,nowhere,1"}) {
    const std::string message = UsageErrorOf([&] { ReadScaleMarks(ParseScaleBars(wrong), given, {}, files); });
    EXPECT_NE(message.find(wrong.substr(5, 4)), std::string::npos) << message;
    EXPECT_NE(message.find("Mark it in two photos"), std::string::npos) << message;
  }
  EXPECT_NE(UsageErrorOf([&] { ReadScaleMarks(ParseScaleBars("left,right,1"), {}, {}, files); }).find("prepare.gcp_marks"), std::string::npos);
  EXPECT_TRUE(ReadScaleMarks(ParseScaleBars("0;0;0,1;0;0,1"), {}, {}, files).points.empty());
}

RC_GTEST_PROP(StatedUp, IsTheUnitVectorOfItsNumbers, ()) {
  const Vector3d up(*rc::gen::inRange(-100, 100), *rc::gen::inRange(-100, 100), *rc::gen::inRange(1, 100));
  const std::string text = std::to_string(up.x()) + ", " + std::to_string(up.y()) + "," + std::to_string(up.z());
  RC_ASSERT((StatedUp(text, {}).value() - up.normalized()).norm() < 1e-12);
}

TEST(StatedUp, IsThatOfTheCamerasOrAnError) {
  const MarkedFlight marked(false);
  EXPECT_FALSE(StatedUp("", marked.photos));
  // Photos straight down with one heading: their up is north.
  const Vector3d north = marked.flight.model_from_enu.rotation * Vector3d::UnitY();
  EXPECT_LT((StatedUp("cameras", marked.photos).value() - north).norm(), 1e-9);
  for (const std::string& wrong : {"up", "1,2", "0,0,0", "1,2,x", "1;2;3", "Cameras"}) {
    const std::string message = UsageErrorOf([&] { CheckUpOption(wrong); });
    EXPECT_NE(message.find("--up"), std::string::npos) << wrong;
    EXPECT_NE(message.find("0,0,1"), std::string::npos) << wrong;
  }
  EXPECT_NO_THROW(CheckUpOption("cameras"));
  EXPECT_NE(UsageErrorOf([] { StatedUp("cameras", {}); }).find("cancel"), std::string::npos);
}

TEST(StatedUp, LevelsALocalFrame) {
  const MarkedFlight marked(false);
  const Vector3d stated = marked.flight.model_from_enu.rotation * Vector3d(0.5, 0.0, 1.0).normalized();
  const Georeference georeference = PlaceOnEarth(marked.photos, marked.points, {.up = stated});
  EXPECT_LT((georeference.enu_from_model.rotation * stated - Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_EQ(georeference.fit.gravity.front().kind, "stated");
}

}  // namespace
}  // namespace skyquilt::test
