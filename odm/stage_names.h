// OpenDroneMap's stages, and which of ours does their work.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::odm {

// In OpenDroneMap's order: dataset, split, merge, opensfm, openmvs, odm_filterpoints, odm_meshing, mvs_texturing, odm_georeferencing, odm_dem,
// odm_orthophoto, odm_report, odm_postprocess.
const std::vector<std::string>& OdmStages();
// Place in that order. The name must be one of them.
int OdmStageIndex(const std::string& name);

// One step of our own, in the order of running.
struct Step {
  std::string stage;                    // of coordinator/stages/stage_table.cpp; "odm" for what is done without a stage
  std::vector<std::string> odm_stages;  // whose work it does, first to last
  double progress_from, progress_to;    // percent of the whole
};
const std::vector<Step>& Steps();

// Our stage that does the work of one of theirs: what has to be made again for --rerun-from. Empty: none, results are only put in place again.
std::string StageBehind(const std::string& odm_stage);
// Whether a step runs with --end-with of that stage.
bool RunsUntil(const Step& step, const std::string& end_with);

}  // namespace skyquilt::odm
