#include <algorithm>

#include "core/survey/orientation.h"
#include "tests/prepare/control/reading/control_reader_fixture.h"

namespace skyquilt::prepare::control {
namespace {

using ControlMarks = ControlReader;

TEST_F(ControlMarks, PhotosThatAreNotThereAreLeftOutWithAWarning) {
  made_.photos.erase(made_.photos.begin() + 3);
  const ControlPoints control = Read(test::OdmFiles(test::MakeControl(), "EPSG:32618"), {.points = "gcp_list.txt"});
  ASSERT_EQ(control.points.size(), 5U);
  EXPECT_EQ(control.points[0].marks.size(), 3U);
  EXPECT_EQ(control.points[1].marks.size(), 2U);
  ASSERT_FALSE(control.warnings.empty());
  EXPECT_NE(control.warnings[0].find("line 7: 3 of 15 marks are in photos that are not there"), std::string::npos) << control.warnings[0];
  EXPECT_NE(control.warnings[0].find("DJI_0004.JPG"), std::string::npos);
}

TEST_F(ControlMarks, NamesThatTwoPhotosShareMustHaveTheirFolder) {
  made_.photos.push_back({"c/DJI_0001.JPG", 4000, 3000});
  const ControlPoints control = ReadList("EPSG:32618\n586000 4507000 3 100 200 DJI_0001.JPG a\n586000 4507000 3 100 200 c/DJI_0001.JPG a\n");
  ASSERT_EQ(control.points[0].marks.size(), 1U);
  EXPECT_EQ(control.points[0].marks[0].photo, "c/DJI_0001.JPG");
}

TEST_F(ControlMarks, StatedSizesScaleThem) {
  test::ControlTexts texts = test::Pix4dFiles(made_, "EPSG:32618");
  texts["marks.csv"] = "image,label,x,y,width,height\nDJI_0001.JPG,GCP-1,5000,1000,8000,6000\n";
  const ControlPoints control = Read(texts, {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"});
  ASSERT_EQ(control.points[0].marks.size(), 1U);
  EXPECT_EQ(control.points[0].marks[0].pixel, Eigen::Vector2d(2500.0, 500.0));
  EXPECT_NE(control.warnings.at(0).find("1 of 1 marks were made in photos of another size"), std::string::npos) << control.warnings[0];
}

TEST_F(ControlMarks, MetashapesSensorScalesThem) {
  const test::ControlTexts texts = test::MetashapeControlFiles(made_, "EPSG:32618");
  for (PhotoSize& photo : made_.photos) {
    photo.width /= 2;
    photo.height /= 2;
  }
  const ControlPoints control = Read(texts, {.points = "reference.csv", .marks = "markers.xml", .crs = "EPSG:32618"});
  EXPECT_EQ(control.points[0].marks[0].pixel, 0.5 * made_.points[0].marks[0].pixel);
}

TEST_F(ControlMarks, OriginalSizesAreUsedWhenOnlyTheyFit) {
  const test::ControlTexts texts = test::Pix4dFiles(made_, "EPSG:32618");
  for (PhotoSize& photo : made_.photos) {
    photo.original_width = photo.width;
    photo.original_height = photo.height;
    photo.width /= 4;
    photo.height /= 4;
  }
  const ControlPoints control = Read(texts, {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"});
  EXPECT_EQ(control.points[0].marks[0].pixel, 0.25 * made_.points[0].marks[0].pixel);
  EXPECT_FALSE(control.warnings.empty());
  // Marks that fit the stored photos are left as they are.
  for (PhotoSize& photo : made_.photos) {
    photo.width *= 3;
    photo.height *= 3;
  }
  const ControlPoints fitting = Read(texts, {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"});
  EXPECT_EQ(fitting.points[0].marks[0].pixel, made_.points[0].marks[0].pixel);
}

TEST_F(ControlMarks, ThoseOfOtherShapesAreRefused) {
  test::ControlTexts texts = test::Pix4dFiles(made_, "EPSG:32618");
  texts["marks.csv"] = "image,label,x,y,width,height\nDJI_0001.JPG,GCP-1,100,100,3000,4000\n";
  const std::string error = InputErrorOf([&] { Read(texts, {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"}); });
  EXPECT_NE(error.find("marks.csv: line 2: the mark of GCP-1 was made in a/DJI_0001.JPG with 3000x4000 pixels"), std::string::npos) << error;
}

TEST_F(ControlMarks, ThoseOutsideTheirPhotosAreRefused) {
  for (const char* pixel : {"4000.1 200", "-0.6 200", "100 3000"}) {
    const std::string error = InputErrorOf([&] { ReadList(std::string("EPSG:32618\n586000 4507000 3 ") + pixel + " DJI_0001.JPG a\n"); });
    EXPECT_NE(error.find("line 2: the mark of a at x "), std::string::npos) << error;
    EXPECT_NE(error.find("is outside a/DJI_0001.JPG, which has 4000x3000 pixels. Correct the mark"), std::string::npos) << error;
  }
  EXPECT_NO_THROW(ReadList("EPSG:32618\n586000 4507000 3 -0.5 2999.5 DJI_0001.JPG a\n"));
  test::ControlTexts texts = test::OpensfmControlFiles(made_);
  std::string& json = texts["ground_control_points.json"];
  json.replace(json.find("[-0."), 4, "[-9.");
  const std::string error = InputErrorOf([&] { Read(texts, {.points = "ground_control_points.json"}); });
  EXPECT_NE(error.find("line 3: the mark of GCP-1"), std::string::npos) << error;
}

TEST_F(ControlMarks, TwoInOnePhotoAreRefusedUnlessTheyAgree) {
  const std::string once = "EPSG:32618\n586000 4507000 3 100 200 DJI_0001.JPG a\n";
  EXPECT_EQ(ReadList(once + "586000 4507000 3 100 200 DJI_0001.JPG a\n").points[0].marks.size(), 1U);
  const std::string error = InputErrorOf([&] { ReadList(once + "586000 4507000 3 100 201 a/DJI_0001.JPG a\n"); });
  EXPECT_NE(error.find("line 3: marks a in a/DJI_0001.JPG a second time, elsewhere than line 2"), std::string::npos) << error;
}

TEST_F(ControlMarks, PositionsThatMetashapeOnlyProjectedAreNone) {
  test::ControlTexts texts = test::MetashapeControlFiles(made_, "EPSG:32618");
  std::string& xml = texts["markers.xml"];
  xml.replace(xml.find("pinned=\"true\""), 13, "pinned=\"false\"");
  const ControlPoints control = Read(texts, {.points = "reference.csv", .marks = "markers.xml", .crs = "EPSG:32618"});
  EXPECT_EQ(control.points[0].marks.size(), 2U);
  EXPECT_NE(control.warnings.at(0).find("1 of 5 points are marked in two photos only"), std::string::npos) << control.warnings[0];
}

TEST_F(ControlMarks, OfPointsWithoutCoordinatesAreLeftOutWithAWarning) {
  const ControlPoints control = ReadTable("GCP-1,586000,4507000,3\nGCP-9,586100,4507000,3\n", {.crs = "EPSG:32618"});
  ASSERT_EQ(control.points.size(), 2U);
  EXPECT_TRUE(control.points[1].marks.empty());
  EXPECT_NE(control.warnings.at(0).find("marks.csv: line 4: 12 of 15 marks are of points without coordinates"), std::string::npos)
      << control.warnings[0];
  EXPECT_NE(control.warnings.at(1).find("1 of 2 points are marked in fewer than two photos and cannot be used: GCP-9"), std::string::npos)
      << control.warnings[1];
}

Eigen::Vector2i SizeOf(const PhotoSize& photo) {
  return {photo.width, photo.height};
}

// The same marks as a program writes them that shows the photos upright. Marks near the left and right sides, so that some of photos turned by 90
// degrees are outside of the stored ones.
test::MadeControl ShownUpright(test::MadeControl* made, int orientation) {
  for (PhotoSize& photo : made->photos) photo.orientation = orientation;
  test::MadeControl upright = *made;
  for (size_t i = 0; i < made->points.size(); ++i) {
    for (size_t k = 0; k < made->points[i].marks.size(); ++k) {
      test::MadeMark& mark = made->points[i].marks[k];
      const PhotoSize& photo = made->photos[mark.photo];
      mark.pixel = {(i % 2 == 0 ? 0.9 : 0.1) * photo.width + 0.25 * static_cast<double>(i), 0.1 * photo.height + 0.5 * static_cast<double>(k)};
      upright.points[i].marks[k].pixel = survey::UprightFromStored(mark.pixel, SizeOf(photo), orientation);
    }
  }
  for (PhotoSize& photo : upright.photos) {
    const Eigen::Vector2i size = survey::UprightSize(SizeOf(photo), orientation);
    photo.width = size.x();
    photo.height = size.y();
  }
  return upright;
}

TEST_F(ControlMarks, OfPhotosShownUprightAreTurnedToTheStoredOnes) {
  for (int orientation = 5; orientation <= 8; ++orientation) {
    made_ = test::MakeControl();
    const test::MadeControl upright = ShownUpright(&made_, orientation);
    const ControlPoints read[] = {
        Read(test::OdmFiles(upright, "EPSG:32618"), {.points = "gcp_list.txt"}),
        Read(test::OpensfmControlFiles(upright), {.points = "ground_control_points.json"}),
        Read(test::Pix4dFiles(upright, "EPSG:32618"), {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"}),
        Read(test::MetashapeControlFiles(upright, "EPSG:32618"), {.points = "reference.csv", .marks = "markers.xml", .crs = "EPSG:32618"})};
    for (const ControlPoints& control : read) {
      for (size_t i = 0; i < control.points.size(); ++i) {
        ASSERT_EQ(control.points[i].marks.size(), 3U);
        for (size_t k = 0; k < 3; ++k) {
          EXPECT_LT((control.points[i].marks[k].pixel - made_.points[i].marks[k].pixel).norm(), 1e-4) << orientation;
          EXPECT_FALSE(control.points[i].marks[k].if_upright);
        }
      }
      ASSERT_FALSE(control.warnings.empty());
      EXPECT_NE(control.warnings.back().find("15 of 15 marks were made in photos shown upright"), std::string::npos) << control.warnings.back();
    }
  }
}

TEST_F(ControlMarks, ThatFitBothWaysAreLeftOpen) {
  for (int orientation = 2; orientation <= 4; ++orientation) {
    made_ = test::MakeControl();
    const test::MadeControl upright = ShownUpright(&made_, orientation);
    const ControlPoints control = Read(test::Pix4dFiles(upright, "EPSG:32618"), {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"});
    for (size_t i = 0; i < control.points.size(); ++i) {
      const ControlMark& mark = control.points[i].marks.at(0);
      EXPECT_LT((mark.pixel - upright.points[i].marks[0].pixel).norm(), 1e-4) << orientation;
      ASSERT_TRUE(mark.if_upright);
      EXPECT_LT((*mark.if_upright - made_.points[i].marks[0].pixel).norm(), 1e-4) << orientation;
    }
    EXPECT_TRUE(control.warnings.empty());
  }
}

TEST_F(ControlMarks, OfPhotosStoredUprightAreNeverOpen) {
  const ControlPoints control = Read(test::OdmFiles(made_, "EPSG:32618"), {.points = "gcp_list.txt"});
  for (const ControlPoint& point : control.points) {
    for (const ControlMark& mark : point.marks) EXPECT_FALSE(mark.if_upright);
  }
}

TEST_F(ControlMarks, OneTurnedPhotoTellsOfAllInTheFile) {
  // The mark in the first photo is outside as it is written; that in the second, turned by 180 degrees, would fit either way.
  made_.photos[0].orientation = 6;
  made_.photos[1].orientation = 3;
  const ControlPoints control = ReadList("EPSG:32618\n586000 4507000 3 999.5 3599.5 DJI_0001.JPG a\n586000 4507000 3 99.5 199.5 DJI_0002.JPG a\n");
  EXPECT_EQ(control.points[0].marks.at(0).pixel, Eigen::Vector2d(3600.0, 2000.0));
  EXPECT_EQ(control.points[0].marks.at(1).pixel, Eigen::Vector2d(3900.0, 2800.0));
  EXPECT_FALSE(control.points[0].marks[1].if_upright);
}

TEST_F(ControlMarks, OfUprightPhotosInTheirOriginalSizeAreTurnedAndScaled) {
  const test::MadeControl upright = ShownUpright(&made_, 6);
  for (PhotoSize& photo : made_.photos) {
    photo.original_width = photo.width;
    photo.original_height = photo.height;
    photo.width /= 4;
    photo.height /= 4;
  }
  const ControlPoints control = Read(test::Pix4dFiles(upright, "EPSG:32618"), {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"});
  EXPECT_LT((control.points[0].marks.at(0).pixel - 0.25 * made_.points[0].marks[0].pixel).norm(), 1e-4);
}

TEST_F(ControlMarks, OfTurnedPicturesWithoutTheirOrientationSayHowToTurnThem) {
  const test::MadeControl upright = ShownUpright(&made_, 6);
  for (PhotoSize& photo : made_.photos) photo.orientation = 1;
  const std::string error =
      InputErrorOf([&] { Read(test::Pix4dFiles(upright, "EPSG:32618"), {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"}); });
  EXPECT_NE(error.find("marks.csv: line 1: the mark of GCP-1"), std::string::npos) << error;
  EXPECT_NE(error.find("EXIF orientation (1) does not say so"), std::string::npos) << error;
}

TEST_F(ControlMarks, OneOutsideAmongUprightOnesIsNamed) {
  test::MadeControl upright = ShownUpright(&made_, 8);
  upright.points[1].marks[0].pixel.x() = 4100.0;
  const std::string error =
      InputErrorOf([&] { Read(test::Pix4dFiles(upright, "EPSG:32618"), {.points = "points.csv", .marks = "marks.csv", .crs = "EPSG:32618"}); });
  EXPECT_NE(error.find("line 4: the mark of GCP-2 at x 4100"), std::string::npos) << error;
  EXPECT_NE(error.find("3000x4000 pixels upright. Correct the mark"), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::prepare::control
