#include "coordinator/stages/training_width.h"

#include <algorithm>

#include "coordinator/planning/needs.h"
#include "coordinator/planning/paying_width.h"
#include "coordinator/planning/work_size.h"
#include "coordinator/scheduler/expected_steps.h"
#include "coordinator/stages/stage.h"
#include "core/base/log.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {
namespace {

constexpr const char* kWidth = "run.image_width";
constexpr const char* kStage = "partition";

bool IsAfter(const std::string& stage, const std::string& other) {
  const std::vector<Stage>& stages = Stages();
  const auto at = [&stages](const std::string& name) {
    return std::find_if(stages.begin(), stages.end(), [&name](const Stage& one) { return one.name == name; });
  };
  return at(stage) > at(other);
}

}  // namespace

void ChooseTrainingWidth(Pipeline& pipeline) {
  Settings& settings = pipeline.settings;
  if (settings.run.image_width != kAutoWidth) return;
  WorkSize size;
  CountSurvey(survey::LoadSurvey(pipeline.project.SurveyFolder()), &size);
  const double steps = ExpectedBlockSteps(settings, pipeline.comm.size(), pipeline.comm.local_size());
  const int width = PayingWidth(size, settings, steps * settings.train.batch_samples, RoomFor(pipeline.project.folder, settings));
  if (size.photo_width > kLeastAutoWidth) {
    base::LogInfo("photos are trained at a width of {} of {} pixels: {} (run.image_width = auto)", width, size.photo_width,
                  settings.run.time_budget_s > 0.0 ? "as wide as the time budget is enough for" : "wider only where a time for training is given");
  }
  for (Settings* each : {&settings, pipeline.level_settings ? &*pipeline.level_settings : nullptr}) {
    if (each != nullptr && each->run.image_width == kAutoWidth) each->run.image_width = width;
  }
}

void RecallTrainingWidth(const Project& project, Settings* settings) {
  if (settings->run.image_width != kAutoWidth) return;
  const std::optional<StageStamp> stamp = LoadStamp(project, kStage);
  if (stamp && stamp->options.contains(kWidth)) settings->Set({kWidth, stamp->options.at(kWidth)});
}

void RecallTrainingWidth(Pipeline& pipeline, const std::string& stage) {
  if (pipeline.restart && !IsAfter(stage, kStage)) return;
  RecallTrainingWidth(pipeline.project, &pipeline.settings);
  if (pipeline.level_settings) RecallTrainingWidth(pipeline.project, &*pipeline.level_settings);
}

}  // namespace skyquilt::coordinator
