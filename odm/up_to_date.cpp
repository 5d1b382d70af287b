#include "odm/up_to_date.h"

#include "coordinator/stages/stage.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"

namespace skyquilt::odm {
namespace {

// Nothing of ours is trained on them: what reads them runs again by itself when they have changed.
bool IsProduct(const std::string& stage) {
  return stage == "products" || stage == "surface" || stage == "buildings" || stage == "evaluate";
}

}  // namespace

void RemoveResults(const coordinator::Project& project, const std::string& stage) {
  if (!IsProduct(stage)) {
    coordinator::RemoveStagesFrom(project, stage);
    return;
  }
  std::error_code error;
  std::filesystem::remove(project.StampFile(stage), error);
  for (const std::filesystem::path& path : coordinator::StageNamed(stage).outputs(project)) {
    std::filesystem::remove_all(path, error);
    if (error) throw base::InputError(path, "cannot be removed: " + error.message(), "Check the permissions of the project folder");
  }
}

void RemoveIfChanged(const coordinator::Pipeline& pipeline, const std::string& name) {
  const coordinator::Stage& stage = coordinator::StageNamed(name);
  const std::optional<coordinator::StageStamp> stamp = coordinator::LoadStamp(pipeline.project, name);
  if (!stamp) return;
  coordinator::Settings settings = pipeline.settings;
  std::vector<std::string> changes = config::Differences(stamp->options, coordinator::StageOptions(stage, settings));
  if (changes.empty() && stage.on_new_inputs == coordinator::OnNewInputs::kRefuse) {
    changes = config::Differences(stamp->inputs, stage.inputs(pipeline));
  }
  if (changes.empty()) return;
  base::LogInfo("{} begins anew, because of what has changed since its last run:\n  {}", name, base::Join(changes, "\n  "));
  RemoveResults(pipeline.project, name);
}

}  // namespace skyquilt::odm
