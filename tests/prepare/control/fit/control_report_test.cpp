#include "prepare/control/fit/control_report.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::control {
namespace {

survey::Survey ControlledSurvey() {
  survey::Survey survey;
  survey.origin = {47.0, 8.0, 400.0};
  survey.georeferenced = true;
  survey::ControlPointFit known;
  known.label = "corner, north";
  known.given_in_enu = {10.0, 20.0, 1.5};
  known.error_m = {0.01, -0.02, 0.03};
  known.sigma_m = {0.011, 0.012, 0.021};
  known.error_px = 0.4321;
  known.gsd_m = 0.0213;
  known.marks = {{.photo = "a.jpg", .used = true}, {.photo = "b.jpg", .used = true}, {.photo = "c.jpg"}};
  survey::ControlPointFit unseen;
  unseen.label = "p2";
  unseen.use = survey::ControlUse::kUnseen;
  unseen.given_in_enu = {-5.0, 0.0, std::numeric_limits<double>::quiet_NaN()};
  survey.control.points = {known, unseen};
  return survey;
}

TEST(ControlReport, TableHasALinePerPoint) {
  const TemporaryFolder folder;
  WriteControlReport(ControlledSurvey(), folder.path());
  EXPECT_EQ(base::ReadFile(folder / "geo_control.csv"),
            "label,use,east_m,north_m,up_m,error_east_m,error_north_m,error_up_m,sigma_east_m,sigma_north_m,sigma_up_m,left_out_error_east_m,"
            "left_out_error_north_m,left_out_error_up_m,error_px,marks_used,marks_given,gsd_m\n"
            "\"corner, north\",control,10.0000,20.0000,1.5000,0.0100,-0.0200,0.0300,0.0110,0.0120,0.0210,,,,0.432,2,3,0.0213\n"
            "p2,unseen,-5.0000,0.0000,,,,,,,,,,,,0,0,\n");
}

TEST(ControlReport, MapHasThePointsOnEarth) {
  const TemporaryFolder folder;
  WriteControlReport(ControlledSurvey(), folder.path());
  const nlohmann::json map = base::ParseJson(base::ReadFile(folder / "control.geojson"));
  ASSERT_EQ(map["features"].size(), 2U);
  const nlohmann::json& first = map["features"][0];
  EXPECT_NEAR(first["geometry"]["coordinates"][0].get<double>(), 8.0 + 10.0 / 76000.0, 1e-6);
  EXPECT_NEAR(first["geometry"]["coordinates"][1].get<double>(), 47.0 + 20.0 / 111200.0, 1e-6);
  EXPECT_NEAR(first["geometry"]["coordinates"][2].get<double>(), 401.5, 1e-3);
  EXPECT_EQ(first["properties"]["error_m"][1], -0.02);
  EXPECT_EQ(map["features"][1]["geometry"]["coordinates"].size(), 2U);
  EXPECT_TRUE(map["features"][1]["properties"]["error_px"].is_null());
}

TEST(ControlReport, FilesOfAnEarlierRunAreRemoved) {
  const TemporaryFolder folder;
  survey::Survey survey = ControlledSurvey();
  WriteControlReport(survey, folder.path());
  survey.georeferenced = false;
  WriteControlReport(survey, folder.path());
  EXPECT_TRUE(std::filesystem::exists(folder / "geo_control.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "control.geojson"));
  survey.control = {};
  WriteControlReport(survey, folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder / "geo_control.csv"));
}

}  // namespace
}  // namespace skyquilt::prepare::control
