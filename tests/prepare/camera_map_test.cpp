#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "prepare/prepare_report.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare {
namespace {

TEST(CameraMap, SaysHowAccurateItsPlaceIs) {
  survey::Survey survey;
  survey.origin = {47.0, 8.0, 400.0};
  survey.georeferenced = true;
  survey.photos = {NadirPhoto({0.0, 0.0, 50.0}, "a.jpg")};
  survey.fit.accuracy = {.scale_percent = 0.4, .tilt_deg = 0.3, .yaw_deg = 0.2, .horizontal_m = 1.5};
  const TemporaryFolder folder;
  WriteCameraMap(survey, folder / "cameras.geojson");
  const nlohmann::json map = base::ParseJson(base::ReadFile(folder / "cameras.geojson"));
  EXPECT_EQ(map["features"].size(), 1U);
  EXPECT_EQ(map["skyquilt:accuracy"]["scale_percent"], 0.4);
  EXPECT_EQ(map["skyquilt:accuracy"]["horizontal_m"], 1.5);
  EXPECT_TRUE(map["skyquilt:accuracy"].at("vertical_m").is_null());
}

}  // namespace
}  // namespace skyquilt::prepare
