#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/survey/control_fit.h"
#include "core/survey/survey.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::test {
namespace {

using ControlFitJson = InTemporaryFolder;

using survey::ControlFit;
using survey::ControlPointFit;

ControlFit SmallFit() {
  ControlFit fit;
  fit.file = "/data/gcp_list.txt";
  fit.crs = "EPSG:2263";
  fit.heights = "egm96";
  fit.placed = fit.adjusted = true;
  ControlPointFit full;
  full.label = "T 1";
  full.given_in_enu = {1.25, -7.5, 0.1};
  full.given_sigma_m = {0.01, 0.02};
  full.error_m = {0.01, 1.0 / 3.0, -0.02};
  full.sigma_m = {0.011, 0.012, 0.03};
  full.left_out_error_m = {0.02, 0.5, -0.05};
  full.error_px = 0.4;
  full.gsd_m = 0.02;
  full.marks = {{"a/1.jpg", {10.5, 20.25}, 0.7, true}, {"a/2.jpg", {1.0, 2.0}, std::nan(""), false}};
  ControlPointFit flat;
  flat.label = "T2";
  flat.use = survey::ControlUse::kUnseen;
  flat.given_in_enu = {3.0, 4.0, std::nan("")};
  fit.points = {full, flat};
  for (const survey::ControlUse use : {survey::ControlUse::kCheck, survey::ControlUse::kRejected}) {
    flat.label += "'";
    flat.use = use;
    fit.points.push_back(flat);
  }
  return fit;
}

void ExpectSame(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  for (Eigen::Index axis = 0; axis < b.size(); ++axis) EXPECT_TRUE(a[axis] == b[axis] || (std::isnan(a[axis]) && std::isnan(b[axis])));
}

TEST_F(ControlFitJson, ASurveyKeepsEveryBitOfIt) {
  survey::Survey survey;
  survey.control = SmallFit();
  SaveSurvey(survey, folder_.path());
  const ControlFit after = survey::LoadSurvey(folder_.path()).control, before = SmallFit();
  EXPECT_EQ(after.file, before.file);
  EXPECT_EQ(after.crs, before.crs);
  EXPECT_EQ(after.heights, before.heights);
  EXPECT_TRUE(after.placed && after.adjusted);
  ASSERT_EQ(after.points.size(), before.points.size());
  for (size_t i = 0; i < after.points.size(); ++i) {
    const ControlPointFit &a = after.points[i], &b = before.points[i];
    EXPECT_EQ(a.label, b.label);
    EXPECT_EQ(a.use, b.use);
    ExpectSame(a.given_in_enu, b.given_in_enu);
    ExpectSame(a.given_sigma_m, b.given_sigma_m);
    ExpectSame(a.error_m, b.error_m);
    ExpectSame(a.sigma_m, b.sigma_m);
    ExpectSame(a.left_out_error_m, b.left_out_error_m);
    EXPECT_TRUE(a.error_px == b.error_px || (std::isnan(a.error_px) && std::isnan(b.error_px)));
    EXPECT_TRUE(a.gsd_m == b.gsd_m || (std::isnan(a.gsd_m) && std::isnan(b.gsd_m)));
    ASSERT_EQ(a.marks.size(), b.marks.size());
    for (size_t k = 0; k < a.marks.size(); ++k) {
      EXPECT_EQ(a.marks[k].photo, b.marks[k].photo);
      EXPECT_EQ(a.marks[k].pixel, b.marks[k].pixel);
      EXPECT_EQ(a.marks[k].used, b.marks[k].used);
      EXPECT_TRUE(a.marks[k].error_px == b.marks[k].error_px || (std::isnan(a.marks[k].error_px) && std::isnan(b.marks[k].error_px)));
    }
  }
}

TEST_F(ControlFitJson, SurveysWithoutControlPointsHaveNone) {
  survey::SaveSurvey({}, folder_.path());
  EXPECT_EQ(base::ReadFile(folder_ / "survey.json").find("\"control\""), std::string::npos);
  EXPECT_TRUE(survey::LoadSurvey(folder_.path()).control.points.empty());
}

TEST_F(ControlFitJson, RefusesDamage) {
  const nlohmann::json good = ToJson(SmallFit());
  EXPECT_NO_THROW(survey::ControlFitFromJson(good));
  const auto refused = [&](const std::function<void(nlohmann::json&)>& damage) {
    nlohmann::json value = good;
    damage(value);
    EXPECT_THROW(survey::ControlFitFromJson(value), std::invalid_argument) << base::JsonText(value);
  };
  refused([](auto& value) { value["points"][0]["use"] = "controlled"; });
  refused([](auto& value) { value["points"][0]["error_m"] = {1.0, 2.0}; });
  refused([](auto& value) { value["points"][0]["sigma_m"] = 1.0; });
  refused([](auto& value) { value["points"][0]["given_in_enu_m"][0] = nullptr; });
  refused([](auto& value) { value["points"][0]["marks"][0]["pixel"] = {1.0, nullptr}; });
  refused([](auto& value) { value["points"][1]["label"] = "T 1"; });
  for (const char* key :
       {"label", "use", "given_in_enu_m", "given_sigma_m", "error_m", "sigma_m", "left_out_error_m", "error_px", "gsd_m", "marks"}) {
    nlohmann::json value = good;
    value["points"][0].erase(key);
    EXPECT_THROW(survey::ControlFitFromJson(value), nlohmann::json::exception) << key;
  }
  // In a whole survey the message names the file.
  survey::Survey survey;
  survey.control = SmallFit();
  SaveSurvey(survey, folder_.path());
  nlohmann::json json = base::ParseJson(base::ReadFile(folder_ / "survey.json"));
  json["control"]["points"][0]["use"] = 7;
  base::WriteFileAtomically(folder_ / "survey.json", base::JsonText(json));
  EXPECT_THROW(survey::LoadSurvey(folder_.path()), base::InputError);
}

}  // namespace
}  // namespace skyquilt::test
