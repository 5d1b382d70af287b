#include "coordinator/stages/level_settings.h"

#include <algorithm>

#include "coordinator/stages/stage.h"
#include "coordinator/stages/training_width.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/survey/view_kind.h"

namespace skyquilt::coordinator {
namespace {

// Whether all results, unfinished ones too, were made with the options of these settings.
bool FitResults(const Project& project, Settings& settings) {
  return std::all_of(Stages().begin(), Stages().end(), [&](const Stage& stage) {
    if (stage.separate_folder != nullptr) return true;
    const std::optional<StageStamp> stamp = LoadStamp(project, stage.name);
    return !stamp || stamp->options == StageOptions(stage, settings);
  });
}

}  // namespace

bool UseLevelSettings(Pipeline& pipeline, const survey::Survey& survey) {
  if (!pipeline.level_settings || !survey::LooksLevel(survey)) return false;
  Settings& level = *pipeline.level_settings;
  const std::vector<std::string> changes = config::Differences(pipeline.settings.Flat(), level.Flat());
  if (changes.empty()) return false;
  if (!FitResults(pipeline.project, level) && FitResults(pipeline.project, pipeline.settings)) return false;
  level.Check();
  pipeline.settings = level;
  base::LogInfo("photos look level: settings of the preset level are used ({}); --config default keeps the defaults", base::Join(changes));
  return true;
}

void RecallLevelSettings(Pipeline& pipeline) {
  RecallTrainingWidth(pipeline, "prepare");
  const Project& project = pipeline.project;
  if (pipeline.restart || !pipeline.level_settings) return;
  const std::optional<StageStamp> prepare = LoadStamp(project, "prepare");
  if (!prepare || prepare->state != StageStamp::kDone || !std::filesystem::exists(project.SurveyFolder() / "survey.json")) return;
  UseLevelSettings(pipeline, survey::LoadSurvey(project.SurveyFolder()));
}

}  // namespace skyquilt::coordinator
