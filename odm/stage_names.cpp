#include "odm/stage_names.h"

#include <algorithm>

#include "core/base/errors.h"

namespace skyquilt::odm {

const std::vector<std::string>& OdmStages() {
  static const std::vector<std::string> stages = {"dataset",        "split",          "merge",
                                                  "opensfm",        "openmvs",        "odm_filterpoints",
                                                  "odm_meshing",    "mvs_texturing",  "odm_georeferencing",
                                                  "odm_dem",        "odm_orthophoto", "odm_report",
                                                  "odm_postprocess"};
  return stages;
}

int OdmStageIndex(const std::string& name) {
  const auto found = std::find(OdmStages().begin(), OdmStages().end(), name);
  SKYQUILT_CHECK(found != OdmStages().end(), name);
  return static_cast<int>(found - OdmStages().begin());
}

const std::vector<Step>& Steps() {
  // Shares of the time of a usual survey; training has the largest.
  static const std::vector<Step> steps = {
      {"prepare", {"opensfm"}, 1.0, 20.0},
      {"partition", {}, 20.0, 21.0},
      {"train", {"openmvs"}, 21.0, 65.0},
      {"merge", {"odm_filterpoints"}, 65.0, 67.0},
      {"products", {"odm_dem", "odm_orthophoto"}, 67.0, 78.0},
      {"surface", {"odm_meshing", "mvs_texturing", "odm_georeferencing"}, 78.0, 90.0},
      {"buildings", {}, 90.0, 92.0},
      {"evaluate", {"odm_report"}, 92.0, 97.0},
      {"odm", {"odm_postprocess"}, 97.0, 100.0},
  };
  return steps;
}

std::string StageBehind(const std::string& odm_stage) {
  const int index = OdmStageIndex(odm_stage);
  if (index <= OdmStageIndex("opensfm")) return "prepare";
  for (const Step& step : Steps()) {
    if (std::find(step.odm_stages.begin(), step.odm_stages.end(), odm_stage) != step.odm_stages.end()) return step.stage == "odm" ? "" : step.stage;
  }
  return "";
}

bool RunsUntil(const Step& step, const std::string& end_with) {
  if (step.stage == "odm") return true;
  // Ours without a counterpart belong to the one before.
  static const std::vector<std::pair<std::string, std::string>> belong = {{"partition", "opensfm"}, {"buildings", "odm_georeferencing"}};
  std::string first = step.odm_stages.empty() ? "" : step.odm_stages.front();
  for (const auto& [stage, odm_stage] : belong) {
    if (stage == step.stage) first = odm_stage;
  }
  return OdmStageIndex(first) <= OdmStageIndex(end_with);
}

}  // namespace skyquilt::odm
