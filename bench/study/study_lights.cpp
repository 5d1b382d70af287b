// Variants that are scored under several lights.
#include <algorithm>

#include "bench/study/light_scores.h"
#include "bench/study/study.h"
#include "coordinator/rendering/scene_session.h"
#include "coordinator/scheduler/field_context.h"
#include "core/base/log.h"

namespace skyquilt::bench {

void Study::AddLights(const Variant& variant, const coordinator::Settings& settings, VariantResult* result) const {
  const coordinator::Project project{RunFolder(variant)};
  const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
  const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
  std::vector<bool> trained;
  for (const std::string& light : lights_->lights) {
    const std::vector<std::string>& prefixes = variant.photo_prefixes;
    trained.push_back(prefixes.empty() || std::find(prefixes.begin(), prefixes.end(), light + "/") != prefixes.end());
  }
  result->light_pictures = (std::filesystem::path("runs") / variant.name / "lights").generic_string();
  const auto merge = [&](const std::string& look) {
    // restart: the scene that is there has another look, which would be refused otherwise.
    coordinator::Pipeline pipeline{
        .comm = comm_, .project = project, .settings = settings, .restart = true, .quiet = options_.quiet, .verbose = options_.verbose};
    pipeline.settings.merge.look = look;
    coordinator::MergeStage(pipeline);
  };
  for (const LookPlan& plan : PlanLooks(lights_->lights, trained, settings.train.appearance_codes > 0)) {
    merge(plan.look);
    coordinator::SceneSession session(comm_, project.SceneFile(), settings.run, options_.verbose, options_.quiet);
    const image::PixelCache pixels =
        image::PixelCache::Open(project.PixelCacheFile(), coordinator::PixelSources(survey), settings.run.image_width, session.threads());
    evaluate::EvaluateInput input;
    input.scene = &session.scene();
    input.survey = &survey;
    input.blocks = &blocks;
    input.pixels = &pixels;
    input.project_folder = project.folder;
    input.options = settings.evaluate;
    input.options.lpips_network.clear();
    const std::vector<LightScore> scores = ScoreLook(input, *lights_, plan, options_.folder / result->light_pictures, session.threads());
    result->lights.insert(result->lights.end(), scores.begin(), scores.end());
  }
  if (options_.keep) merge(settings.merge.look);
}

}  // namespace skyquilt::bench
