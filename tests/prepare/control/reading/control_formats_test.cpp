#include <cmath>

#include "core/geo/ecef.h"
#include "core/geo/utm.h"
#include "tests/prepare/control/reading/control_reader_fixture.h"

namespace skyquilt::prepare::control {
namespace {

class ControlFormats : public ControlReader {
 protected:
  void ExpectMade(const ControlPoints& control, const std::string& what) {
    ASSERT_EQ(control.points.size(), made_.points.size()) << what;
    for (size_t i = 0; i < control.points.size(); ++i) {
      const ControlPoint& point = control.points[i];
      EXPECT_EQ(point.label, made_.points[i].label) << what;
      EXPECT_LT((geo::EcefFromGeodetic(point.place) - geo::EcefFromGeodetic(made_.points[i].place)).norm(), 1e-3) << what << " " << point.label;
      EXPECT_GT(point.line, 0) << what;
      EXPECT_FALSE(point.check);
      ASSERT_EQ(point.marks.size(), made_.points[i].marks.size()) << what;
      for (size_t k = 0; k < point.marks.size(); ++k) {
        EXPECT_EQ(point.marks[k].photo, made_.photos[made_.points[i].marks[k].photo].name) << what;
        EXPECT_LT((point.marks[k].pixel - made_.points[i].marks[k].pixel).norm(), 1e-4) << what;
        EXPECT_GT(point.marks[k].line, 0) << what;
      }
    }
  }
};

TEST_F(ControlFormats, AllGiveTheSamePointsInMetresAndFeet) {
  for (const char* crs : {"EPSG:32618", "WGS84 UTM 18N", "+proj=utm +zone=18 +datum=WGS84 +units=m +no_defs", "EPSG:2263", "EPSG:32618+5773"}) {
    ExpectMade(Read(test::OdmFiles(made_, crs), {.points = "gcp_list.txt"}), std::string("ODM ") + crs);
    ExpectMade(Read(test::Pix4dFiles(made_, crs), {.points = "points.csv", .marks = "marks.csv", .crs = crs}), std::string("Pix4D ") + crs);
    ExpectMade(Read(test::MetashapeControlFiles(made_, crs), {.points = "reference.csv", .marks = "markers.xml", .crs = crs}),
               std::string("Metashape ") + crs);
  }
  ExpectMade(Read(test::OdmFiles(made_, "EPSG:4326"), {.points = "gcp_list.txt"}), "ODM in degrees");
  ExpectMade(Read(test::OpensfmControlFiles(made_), {.points = "ground_control_points.json"}), "OpenSfM");
}

TEST_F(ControlFormats, StatePlaneFeetAreWhereCs2csHasThem) {
  // cs2cs from EPSG:2263 to EPSG:4326.
  const ControlPoints control = ReadTable("GCP-1,990000,200000,328.083333333\n", {.crs = "EPSG:2263"});
  EXPECT_NEAR(control.points[0].place.latitude_deg, 40.715628630, 1e-8);
  EXPECT_NEAR(control.points[0].place.longitude_deg, -73.979258038, 1e-8);
  EXPECT_NEAR(control.points[0].place.height_m, 100.0, 1e-6);
}

TEST_F(ControlFormats, GcpListOfOpensfmHasLongitudesFirst) {
  const ControlPoints control = ReadList("WGS84\n-73.98 40.715 12.5 99.5 199.5 DJI_0001.JPG\n-73.98 40.715 12.5 10 20 DJI_0002.JPG\n");
  ASSERT_EQ(control.points.size(), 1U);
  EXPECT_EQ(control.points[0].label, "point 1");
  EXPECT_DOUBLE_EQ(control.points[0].place.latitude_deg, 40.715);
  EXPECT_DOUBLE_EQ(control.points[0].place.longitude_deg, -73.98);
  EXPECT_DOUBLE_EQ(control.points[0].place.height_m, 12.5);
  EXPECT_EQ(control.points[0].marks[0].pixel, Eigen::Vector2d(100.0, 200.0));
  EXPECT_EQ(control.points[0].marks[0].line, 2);
  EXPECT_EQ(control.points[0].marks[1].photo, "a/DJI_0002.JPG");
}

TEST_F(ControlFormats, GcpListMayHaveWhatEditorsWrite) {
  const ControlPoints control = ReadList(
      "\xEF\xBB\xBF"
      "EPSG:32618\r\n# made by hand\r\n\r\n586000 4507000 NaN 100 200 DJI_0001.JPG north extra 1\r\n586000 4507000 nan 100 200 dji_0002.jpg north\r\n"
      "586100 4507000 3 100 200 DJI_0003.JPG\r\n586100 4507000 3 100 200 DJI_0004.JPG\r\n");
  ASSERT_EQ(control.points.size(), 2U);
  EXPECT_EQ(control.points[0].label, "north");
  EXPECT_TRUE(std::isnan(control.points[0].place.height_m));
  EXPECT_TRUE(std::isnan(control.points[0].given.z()));
  EXPECT_EQ(control.points[0].marks.size(), 2U);
  EXPECT_EQ(control.points[0].line, 4);
  EXPECT_EQ(control.points[1].label, "point 1");
  EXPECT_EQ(control.crs, "WGS 84 / UTM zone 18N");
}

TEST_F(ControlFormats, PhotosMayHaveSpacesInTheirNames) {
  made_.photos.push_back({"my photo 1.jpg", 4000, 3000});
  const ControlPoints control = ReadList("EPSG:32618\n586000 4507000 3 100 200 my photo 1.jpg north\n586000 4507000 3 100 200 DJI_0001.JPG north\n");
  ASSERT_EQ(control.points.size(), 1U);
  EXPECT_EQ(control.points[0].marks[0].photo, "my photo 1.jpg");
}

TEST_F(ControlFormats, TablesMayHaveSemicolonsDecimalCommasAndQuotes) {
  const ControlPoints control = ReadTable(
      "\xEF\xBB\xBF"
      "Name;Northing;Easting;H\r\n\"GCP-1\";4507000,25;586000,5;3,75\r\nGCP-2;4507100;586100;\r\n",
      {.crs = "EPSG:32618"});
  ASSERT_EQ(control.points.size(), 2U);
  EXPECT_EQ(control.points[0].given, Eigen::Vector3d(586000.5, 4507000.25, 3.75));
  EXPECT_EQ(control.points[0].label, "GCP-1");
  EXPECT_EQ(control.points[0].line, 2);
  EXPECT_TRUE(std::isnan(control.points[1].place.height_m));
}

TEST_F(ControlFormats, ColumnsSayOrderAndAccuracy) {
  const ControlPoints control = ReadTable("1 x,4507000,586000,3,0.03,0.05,GCP-1\n",
                                          {.crs = "EPSG:32618", .columns = "skip,north,east,up,horizontal_accuracy,vertical accuracy,label"});
  ASSERT_EQ(control.points.size(), 1U);
  EXPECT_EQ(control.points[0].given, Eigen::Vector3d(586000.0, 4507000.0, 3.0));
  EXPECT_DOUBLE_EQ(control.points[0].horizontal_sigma_m, 0.03);
  EXPECT_DOUBLE_EQ(control.points[0].vertical_sigma_m, 0.05);
}

TEST_F(ControlFormats, AccuraciesOfTheUsualColumns) {
  const ControlPoints metashape =
      Read(test::MetashapeControlFiles(made_, "EPSG:32618"), {.points = "reference.csv", .marks = "markers.xml", .crs = "EPSG:32618"});
  EXPECT_DOUBLE_EQ(metashape.points[0].horizontal_sigma_m, 0.015);
  EXPECT_DOUBLE_EQ(metashape.points[0].vertical_sigma_m, 0.015);
  const ControlPoints pix4d = ReadTable("GCP-1,586000,4507000,3,0.03,0.05\nGCP-2,586100,4507000,3,0,0\n", {.crs = "EPSG:32618"});
  EXPECT_DOUBLE_EQ(pix4d.points[0].horizontal_sigma_m, 0.03);
  EXPECT_DOUBLE_EQ(pix4d.points[0].vertical_sigma_m, 0.05);
  EXPECT_DOUBLE_EQ(pix4d.points[1].horizontal_sigma_m, ControlPoint().horizontal_sigma_m);
}

TEST_F(ControlFormats, OneTableMayHoldPointsAndMarks) {
  const ControlPoints control =
      Read({{"all.csv", "EPSG:32618\nlabel,x,y,z,image,px,py\nA,586000,4507000,3,DJI_0001.JPG,100,200\nA,586000,4507000,3,DJI_0002.JPG,110,210\n"}},
           {.points = "all.csv"});
  ASSERT_EQ(control.points.size(), 1U);
  EXPECT_EQ(control.points[0].marks.size(), 2U);
  EXPECT_EQ(control.points[0].marks[1].pixel, Eigen::Vector2d(110.0, 210.0));
}

TEST_F(ControlFormats, MetashapeXmlMayHoldCoordinates) {
  test::ControlTexts texts = test::MetashapeControlFiles(made_, "EPSG:32618");
  std::string& xml = texts["markers.xml"];
  const auto put = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(xml.find(from), std::string::npos);
    xml.replace(xml.find(from), from.size(), to);
  };
  put("<marker id=\"0\" label=\"GCP-1\"/>",
      "<marker id=\"0\" label=\"GCP-1\"><reference x=\"-73.98\" y=\"40.715\" z=\"-20\" sxy=\"0.02\" sz=\"0.04\" enabled=\"true\"/></marker>");
  put("<marker id=\"1\" label=\"GCP-2\"/>",
      "<group label=\"g\"><marker id=\"1\" label=\"GCP-2\"><reference x=\"-73.978\" y=\"40.715\" enabled=\"false\"/></marker></group>");
  put("<frames>", "<reference>EPSG:4326</reference><frames>");
  const ControlPoints control = Read(texts, {.points = "markers.xml"});
  ASSERT_EQ(control.points.size(), 2U);
  EXPECT_FALSE(control.points[0].check);
  EXPECT_DOUBLE_EQ(control.points[0].place.latitude_deg, 40.715);
  EXPECT_DOUBLE_EQ(control.points[0].horizontal_sigma_m, 0.02);
  EXPECT_DOUBLE_EQ(control.points[0].vertical_sigma_m, 0.04);
  EXPECT_EQ(control.points[0].marks.size(), 3U);
  EXPECT_TRUE(control.points[1].check);
  EXPECT_TRUE(std::isnan(control.points[1].place.height_m));
}

TEST_F(ControlFormats, MetashapeTableNamesItsSystem) {
  const ControlPoints control = ReadTable("# CoordinateSystem: EPSG:32618\n#Label,X/Easting,Y/Northing,Z/Altitude,Yaw\nGCP-1,586000,4507000,3,0\n");
  EXPECT_EQ(control.crs, "WGS 84 / UTM zone 18N");
}

TEST_F(ControlFormats, CheckPointsAreNamedInAListOrAFile) {
  const test::ControlTexts texts = test::OdmFiles(made_, "EPSG:32618");
  const ControlPoints listed = Read(texts, {.points = "gcp_list.txt", .check_points = "GCP-2, GCP-5"});
  test::WriteTexts({{"check.txt",
                     "\xEF\xBB\xBF"
                     "# labels\r\nGCP-2\r\nGCP-5\r\n"}},
                   folder_.path());
  const ControlPoints filed = Read(texts, {.points = "gcp_list.txt", .check_points = (folder_ / "check.txt").string()});
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(listed.points[i].check, i == 1 || i == 4);
    EXPECT_EQ(filed.points[i].check, i == 1 || i == 4);
  }
}

TEST_F(ControlFormats, GcpListsMayHaveOtherSeparatorsAndDecimalCommas) {
  for (const char* row : {"586000.5 4507000.25 3.5 99.5 199.5 DJI_0001.JPG a", "586000.5,4507000.25,3.5,99.5,199.5,DJI_0001.JPG,a",
                          "586000,5;4507000,25;3,5;99,5;199,5;C:\\a\\DJI_0001.JPG;a", "586000,5\t4507000,25\t3,5\t99,5\t199,5\tDJI_0001\ta"}) {
    const ControlPoints control = ReadList(std::string("EPSG:32618\n") + row + "\n");
    ASSERT_EQ(control.points.size(), 1U) << row;
    EXPECT_EQ(control.points[0].label, "a") << row;
    EXPECT_EQ(control.points[0].given, Eigen::Vector3d(586000.5, 4507000.25, 3.5)) << row;
    EXPECT_EQ(control.points[0].marks.at(0).pixel, Eigen::Vector2d(100.0, 200.0)) << row;
  }
}

}  // namespace
}  // namespace skyquilt::prepare::control
