#include "tests/prepare/control/reading/control_reader_fixture.h"

namespace skyquilt::prepare::control {
namespace {

class ControlFaults : public ControlReader {
 protected:
  void ExpectListError(const std::string& text, const std::string& wanted) {
    const std::string error = InputErrorOf([&] { ReadList(text); });
    EXPECT_NE(error.find(wanted), std::string::npos) << text << "\n" << error;
    EXPECT_NE(error.find(". "), std::string::npos) << "no way out: " << error;
  }
  void ExpectTableError(const std::string& text, const std::string& wanted, const ControlFiles& files = {.crs = "EPSG:32618"}) {
    const std::string error = InputErrorOf([&] { ReadTable(text, files); });
    EXPECT_NE(error.find(wanted), std::string::npos) << text << "\n" << error;
    EXPECT_NE(error.find(". "), std::string::npos) << "no way out: " << error;
  }
  std::string UsageErrorOf(const ControlFiles& files) {
    try {
      ReadTable("GCP-1,586000,4507000,3\n", files);
    } catch (const base::UsageError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(ControlFaults, OneLabelWithTwoPlacesNamesBothLines) {
  ExpectListError("EPSG:32618\n586000 4507000 3 1 2 DJI_0001.JPG a\n586001 4507000 3 1 2 DJI_0002.JPG a\n",
                  "line 3: gives a other coordinates than line 2. Give every point a name of its own");
  ExpectTableError("label,x,y,z\nA,586000,4507000,3\nA,586000,4507000,4\n", "line 3: gives A other coordinates than line 2");
  test::ControlTexts texts = test::OpensfmControlFiles(made_);
  std::string& json = texts["ground_control_points.json"];
  json.replace(json.find("GCP-2"), 5, "GCP-1");
  const std::string error = InputErrorOf([&] { Read(texts, {.points = "ground_control_points.json"}); });
  EXPECT_NE(error.find("line 6: points[1] has the id GCP-1, as the point on line 2"), std::string::npos) << error;
  texts = test::MetashapeControlFiles(made_, "EPSG:32618");
  std::string& xml = texts["markers.xml"];
  xml.replace(xml.find("label=\"GCP-2\""), 13, "label=\"GCP-1\"");
  const std::string marker = InputErrorOf([&] { Read(texts, {.points = "reference.csv", .marks = "markers.xml", .crs = "EPSG:32618"}); });
  EXPECT_NE(marker.find("has the label GCP-1, as the one on line "), std::string::npos) << marker;
}

TEST_F(ControlFaults, DamagedRowsAreNamed) {
  ExpectListError("EPSG:32618\n586000 4507000 3 1 2 DJI_0001.JPG\n586000 4507x 3 1 2 DJI_0002.JPG\n", "line 3: '4507x' is not a number");
  ExpectListError("EPSG:32618\n586000 4507000 3 1 2 DJI_0001.JPG\n586000 4507000 3 1\n", "line 3: has 4 fields instead of 6 or more");
  ExpectListError("EPSG:32618\n586000 4507000 inf 1 2 DJI_0001.JPG\n", "line 2: ");
  ExpectTableError("label,x,y,z\nA,586000,,3\n", "line 2: has no y");
  ExpectTableError("label,x,y,z\nA,586000,4507000,high\n", "line 2: height 'high' is not a number");
  ExpectTableError("label,x,y,z,accuracy\nA,586000,4507000,3,-1\n", "line 2: has a negative accuracy");
  ExpectTableError("A,1,2,3,4,5,6,7\n", "line 1: has 8 fields, and no line says what they are");
  ExpectTableError(std::string("A,586000,4507000,3\nB\0,1,2,3\n", 28), "line 2: has a character that text does not have");
  ExpectTableError("", "is empty");
  ExpectTableError("# nothing\n", "has no control points");
}

TEST_F(ControlFaults, CoordinateSystemsMustBeKnown) {
  ExpectTableError("A,586000,4507000,3\n", "does not say what coordinate system its points are in. Give their coordinate system with prepare.gcp_crs",
                   {});
  ExpectListError("EPSG:1\n586000 4507000 3 1 2 DJI_0001.JPG\n", "line 1: 'EPSG:1' is not a coordinate system");
  ExpectListError("EPSG:4326\n40.7 -173.9 3 1 2 DJI_0001.JPG\n",
                  "line 2: point 1: the position is outside this coordinate system. Check that x is east");
  ExpectTableError("A,40.7,-73.9,3\n", "has longitudes and latitudes, but nothing says which come first. Name the columns", {.crs = "EPSG:4326"});
  EXPECT_EQ(ReadTable("A,40.7,-73.9,3\n", {.crs = "EPSG:4326", .columns = "label,lat,lon,up"}).points[0].place.latitude_deg, 40.7);
}

TEST_F(ControlFaults, MarksMustBeGiven) {
  const std::string error = InputErrorOf([&] { Read(test::Pix4dFiles(made_, "EPSG:32618"), {.points = "points.csv", .crs = "EPSG:32618"}); });
  EXPECT_NE(error.find("has no marks, so it is not known where its points are in the photos. Give the marks with prepare.gcp_marks"),
            std::string::npos)
      << error;
  const std::string gone = InputErrorOf([&] { Read({}, {.points = "none.txt"}); });
  EXPECT_NE(gone.find("none.txt"), std::string::npos);
}

TEST_F(ControlFaults, DamagedXmlAndJsonAreNamed) {
  test::ControlTexts texts = test::MetashapeControlFiles(made_, "EPSG:32618");
  const ControlFiles files{.points = "reference.csv", .marks = "markers.xml", .crs = "EPSG:32618"};
  const auto broken = [&](const std::string& from, const std::string& to) {
    test::ControlTexts other = texts;
    std::string& xml = other["markers.xml"];
    xml.replace(xml.find(from), from.size(), to);
    return InputErrorOf([&] { Read(other, files); });
  };
  EXPECT_NE(broken("</chunk>", "").find("is not XML"), std::string::npos);
  EXPECT_NE(broken("marker_id=\"0\"", "marker_id=\"77\"").find("has the number 77, but there is no such marker"), std::string::npos);
  EXPECT_NE(broken("camera_id=\"0\"", "camera_id=\"77\"").find("is in camera 77, but there is no such <camera>"), std::string::npos);
  EXPECT_NE(broken("x=\"1000.5000\"", "x=\"wide\"").find("has x 'wide', which is not a number"), std::string::npos);
  EXPECT_NE(broken("width=\"4000\"", "width=\"0\"").find("has a width that is not a number of pixels"), std::string::npos);
  const std::string json = InputErrorOf([&] {
    Read({{"g.json", "{\"points\": [\n{\"id\": \"a\", \"position\": {\"latitude\": \"x\"}}]}"}}, {.points = "g.json"});
  });
  EXPECT_NE(json.find("line 2"), std::string::npos) << json;
}

TEST_F(ControlFaults, OptionsThatCannotBeMeantAreUsageErrors) {
  EXPECT_NE(UsageErrorOf({.crs = "EPSG:1"}).find("gcp_crs"), std::string::npos);
  EXPECT_NE(UsageErrorOf({.crs = "EPSG:32618", .columns = "label,east,sideways"}).find("'sideways' is no column"), std::string::npos);
  EXPECT_NE(UsageErrorOf({.crs = "EPSG:32618", .columns = "label,east"}).find("must name at least"), std::string::npos);
  EXPECT_NE(UsageErrorOf({.crs = "EPSG:32618", .heights = "sea"}).find("must be crs, ellipsoid or egm96"), std::string::npos);
  EXPECT_NE(UsageErrorOf({.crs = "EPSG:32618", .check_points = "GCP-1,GCP-7"}).find("names 'GCP-7', but no point is called so; there are GCP-1"),
            std::string::npos);
  test::WriteTexts({{"check.txt", "GCP-1\nGCP-7\n"}}, folder_.path());
  ExpectTableError("GCP-1,586000,4507000,3\n", "check.txt: line 2: names 'GCP-7'",
                   {.crs = "EPSG:32618", .check_points = (folder_ / "check.txt").string()});
}

}  // namespace
}  // namespace skyquilt::prepare::control
