#include "prepare/georeference/checks/shutter_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::prepare::georeference {
namespace {

TEST(ShutterTable, KnowsRollingShutters) {
  EXPECT_EQ(SensorReadout({"DJI FC300S", 4000, 2250, 1.0 / 370.0}), 33.0);
  EXPECT_EQ(SensorReadout({"DJI FC220", 4000, 3000, {}}), 64.0);
  EXPECT_EQ(SensorReadout({"Parrot Anafi", 4608, 3456, {}}), 39.0);
}

TEST(ShutterTable, IgnoresCaseAndSpaces) {
  EXPECT_EQ(SensorReadout({"dji fc300s ", 4000, 3000, {}}), 33.0);
  EXPECT_EQ(SensorReadout({"GOPRO HERO4  Black", 4000, 3000, {}}), 30.0);
}

TEST(ShutterTable, AMechanicalShutterIsUsedForLongExposuresOnly) {
  EXPECT_EQ(SensorReadout({"DJI FC6310", 5472, 3648, 1.0 / 640.0}), 0.0);
  EXPECT_EQ(SensorReadout({"DJI FC6310", 5472, 3648, 1.0 / 2000.0}), 0.0);
  EXPECT_EQ(SensorReadout({"DJI FC6310", 5472, 3648, 0.0005 - 1e-9}), 0.0);  // 1/2000 rounded in the tag
  EXPECT_EQ(SensorReadout({"DJI FC6310", 5472, 3648, 1.0 / 2500.0}), 33.0);
  EXPECT_EQ(SensorReadout({"DJI M3E", 5280, 3956, {}}), 0.0);
  EXPECT_TRUE(std::isnan(SensorReadout({"DJI M3E", 5280, 3956, 1.0 / 4000.0})));  // nobody measured it
}

TEST(ShutterTable, WidePicturesOfSomeCamerasReadFewerRows) {
  EXPECT_EQ(SensorReadout({"Hasselblad L1D-20c", 5472, 3648, {}}), 56.0);
  EXPECT_EQ(SensorReadout({"Hasselblad L1D-20c", 5472, 3078, {}}), 47.0);
  EXPECT_EQ(SensorReadout({"Hasselblad L1D-20c", 1539, 2736, {}}), 47.0);  // turned and reduced
}

TEST(ShutterTable, OtherCamerasAreUnknown) {
  for (const char* name : {"", "DJI", "FC300S", "DJI FC300SX", "Canon PowerShot ELPH 300 HS"}) {
    EXPECT_TRUE(std::isnan(SensorReadout({name, 4000, 3000, {}}))) << name;
  }
}

TEST(CameraName, HasTheMakeOnce) {
  EXPECT_EQ(CameraName("DJI", "FC300S"), "DJI FC300S");
  EXPECT_EQ(CameraName(" DJI ", " FC300S "), "DJI FC300S");
  EXPECT_EQ(CameraName("Canon", "Canon PowerShot ELPH 300 HS"), "Canon PowerShot ELPH 300 HS");
  EXPECT_EQ(CameraName("", "FC300S"), "FC300S");
  EXPECT_EQ(CameraName("DJI", ""), "DJI");
  EXPECT_EQ(CameraName("", " "), "");
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
