#include "prepare/control/reading/control_checks.h"

#include "core/geo/crs.h"
#include "tests/prepare/control/reading/control_reader_fixture.h"

namespace skyquilt::prepare::control {
namespace {

class ControlChecks : public ControlReader {
 protected:
  std::vector<geo::Geodetic> Tags() const {
    std::vector<geo::Geodetic> tags(5, {40.7155, -73.9795, 60.0});
    tags.push_back({0.0, 10.0, 0.0});  // a wrong one
    return tags;
  }
  // Written in one system, read in another.
  std::string NearError(const std::string& written, const std::string& read, const std::string& columns = "label,x,y,z") {
    const ControlFiles files{.points = "points.csv", .marks = "marks.csv", .crs = read, .columns = columns};
    const ControlPoints control = Read(test::Pix4dFiles(made_, written), files);
    return InputErrorOf([&] { CheckNear(control, Tags()); });
  }
  ControlPoints Good() { return Read(test::OdmFiles(made_, "EPSG:32618"), {.points = "gcp_list.txt"}); }
};

TEST_F(ControlChecks, PointsNearThePhotosAreGood) {
  EXPECT_NO_THROW(CheckNear(Good(), Tags()));
  EXPECT_NO_THROW(CheckNear(Good(), {}));
}

TEST_F(ControlChecks, WrongSystemsAreNamedWithTheWayOut) {
  const std::string zone = NearError("EPSG:32618", "EPSG:32617");
  EXPECT_NE(zone.find("points.csv: line 1: GCP-1 in WGS 84 / UTM zone 17N is 50"), std::string::npos) << zone;
  EXPECT_NE(zone.find("km from the photos"), std::string::npos) << zone;
  EXPECT_NE(zone.find("In UTM 18N (EPSG:32618) it lies near the photos"), std::string::npos) << zone;
  const std::string south = NearError("EPSG:32618", "EPSG:32718");
  EXPECT_NE(south.find("In UTM 18N (EPSG:32618) it lies"), std::string::npos) << south;
  const std::string swapped = NearError("EPSG:32618", "EPSG:32618", "label,north,east,up");
  EXPECT_NE(swapped.find("With x and y exchanged it lies near the photos"), std::string::npos) << swapped;
  const std::string metres = NearError("EPSG:32118", "EPSG:2263");
  EXPECT_NE(metres.find("Taken as metres it lies near the photos"), std::string::npos) << metres;
  const std::string feet = NearError("EPSG:2263", "EPSG:32118");
  EXPECT_NE(feet.find("Taken as feet it lies near the photos"), std::string::npos) << feet;
  const ControlPoints east = ReadTable("label,lon,lat,up\nGCP-1,73.98,40.715,3\n", {.crs = "EPSG:4326"});
  const std::string sign = InputErrorOf([&] { CheckNear(east, Tags()); });
  EXPECT_NE(sign.find("line 2: GCP-1"), std::string::npos) << sign;
  EXPECT_NE(sign.find("west and south are negative"), std::string::npos) << sign;
}

TEST_F(ControlChecks, OneFarPointIsNamed) {
  ControlPoints control = Good();
  control.points[3].place.latitude_deg += 2.0;
  control.points[3].given.y() += 222e3;
  const std::string error = InputErrorOf([&] { CheckNear(control, Tags()); });
  EXPECT_NE(error.find("line 11: GCP-4"), std::string::npos) << error;
  EXPECT_NE(error.find("Check its coordinates"), std::string::npos) << error;
}

TEST_F(ControlChecks, FewerThanThreePointsNeedAPlaceFromTags) {
  EXPECT_EQ(CheckGeometry(Good(), false), "");
  ControlPoints control = Good();
  control.points[0].check = control.points[1].check = true;
  control.points[2].marks.resize(1);
  const std::string error = InputErrorOf([&] { CheckGeometry(control, false); });
  EXPECT_NE(error.find("gcp_list.txt: only 2 of 3 control points are marked in two photos or more, 3 are needed. Mark three"), std::string::npos)
      << error;
  EXPECT_NE(CheckGeometry(control, true).find("only 2 of 3 control points are marked"), std::string::npos);
}

TEST_F(ControlChecks, HeightsOfThreePointsAreNeeded) {
  ControlPoints control = Good();
  for (size_t i = 0; i < 3; ++i) control.points[i].place.height_m = std::nan("");
  EXPECT_NE(CheckGeometry(control, true).find("only 2 of 5 usable control points have a height"), std::string::npos);
  control.points[0].place.height_m = 3.0;
  EXPECT_EQ(CheckGeometry(control, false), "");
}

TEST_F(ControlChecks, PointsOnOneLineNeedAPlaceFromTags) {
  ControlPoints control = Good();
  for (size_t i = 0; i < control.points.size(); ++i) control.points[i].place = {40.715, -73.98 + 0.001 * static_cast<double>(i), 5.0};
  const std::string error = InputErrorOf([&] { CheckGeometry(control, false); });
  EXPECT_NE(error.find("all usable control points lie on one line"), std::string::npos) << error;
  EXPECT_NE(CheckGeometry(control, true).find("lie on one line"), std::string::npos);
  control.points[2].place.latitude_deg += 0.0005;
  EXPECT_EQ(CheckGeometry(control, false), "");
}

}  // namespace
}  // namespace skyquilt::prepare::control
