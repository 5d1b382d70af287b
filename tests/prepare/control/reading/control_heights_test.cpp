#include <cmath>

#include "core/geo/geoid.h"
#include "tests/prepare/control/reading/control_reader_fixture.h"

namespace skyquilt::prepare::control {
namespace {

class ControlHeights : public ControlReader {
 protected:
  double HeightOf(const std::string& z, const ControlFiles& files) {
    const ControlPoints control = ReadTable("label,x,y,z\nGCP-1,586000,4507000," + z + "\n", files);
    heights_ = control.heights;
    warnings_ = control.warnings;
    undulation_m_ = geo::Egm96Undulation(control.points[0].place.latitude_deg, control.points[0].place.longitude_deg);
    return control.points[0].place.height_m;
  }
  bool Warns(const std::string& text) const {
    for (const std::string& warning : warnings_) {
      if (warning.find(text) != std::string::npos) return true;
    }
    return false;
  }

  std::string heights_;
  std::vector<std::string> warnings_;
  double undulation_m_ = 0.0;
};

TEST_F(ControlHeights, SystemsWithoutHeightsHaveEllipsoidalOnes) {
  EXPECT_DOUBLE_EQ(HeightOf("10", {.crs = "EPSG:32618"}), 10.0);
  EXPECT_EQ(heights_, "ellipsoid");
  EXPECT_FALSE(Warns("heights are taken"));
}

TEST_F(ControlHeights, FeetWithoutHeightsAreSaidToBeFeet) {
  EXPECT_NEAR(HeightOf("39.37", {.crs = "EPSG:2263"}), 12.0, 1e-9);
  EXPECT_TRUE(Warns("heights are taken in the unit of x and y (US survey foot)"));
}

TEST_F(ControlHeights, Egm96IsAddedByTheSystemOrTheOption) {
  const double by_system = HeightOf("10", {.crs = "EPSG:32618+5773"});
  EXPECT_EQ(heights_, "egm96");
  EXPECT_NEAR(by_system, 10.0 + undulation_m_, 1e-6);
  EXPECT_LT(undulation_m_, -30.0);
  EXPECT_NEAR(HeightOf("10", {.crs = "EPSG:32618", .heights = "egm96"}), by_system, 1e-6);
  EXPECT_EQ(heights_, "egm96");
  const double in_feet = HeightOf("39.37", {.crs = "EPSG:2263", .heights = "egm96"});
  EXPECT_NEAR(in_feet, 12.0 + undulation_m_, 1e-9);
}

TEST_F(ControlHeights, TheOptionGoesBeforeTheSystem) {
  EXPECT_DOUBLE_EQ(HeightOf("10", {.crs = "EPSG:32618+5773", .heights = "ellipsoid"}), 10.0);
  EXPECT_EQ(heights_, "ellipsoid");
  // NAVD88 in feet: PROJ's grid of it is not part of Debian.
  EXPECT_NEAR(HeightOf("39.37", {.crs = "EPSG:2263+6360", .heights = "ellipsoid"}), 12.0, 1e-9);
}

TEST_F(ControlHeights, ThoseAboveAGeoidWithoutItsGridAreRefused) {
  for (const char* crs : {"EPSG:32618+3855", "EPSG:2263+6360"}) {
    const std::string error = InputErrorOf([&] { HeightOf("10", {.crs = crs}); });
    EXPECT_NE(error.find("line 2: GCP-1: PROJ has no grid here for heights of"), std::string::npos) << error;
    EXPECT_NE(error.find("prepare.gcp_heights"), std::string::npos) << error;
  }
  EXPECT_TRUE(std::isnan(HeightOf("", {.crs = "EPSG:32618+3855"})));
}

TEST_F(ControlHeights, GuessedDatumsAreSaid) {
  HeightOf("10", {.crs = "+proj=utm +zone=18 +ellps=GRS80 +units=m"});
  EXPECT_TRUE(Warns("PROJ knows no exact way"));
  HeightOf("10", {.crs = "EPSG:26918"});
  EXPECT_FALSE(Warns("PROJ knows no exact way"));
}

}  // namespace
}  // namespace skyquilt::prepare::control
