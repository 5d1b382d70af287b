// The work of stage "merge".
#include <string>

#include "coordinator/rendering/scene_session.h"
#include "coordinator/scheduler/field_context.h"
#include "coordinator/stages/stage_bodies.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/image/pixel_cache.h"
#include "core/survey/refined_poses.h"
#include "core/trust/trust.h"
#include "evaluate/trust/measure_trust.h"
#include "merge/merge.h"

namespace skyquilt::coordinator {
namespace {

// Writes Project::TrustFile. A scene is complete without it.
void MeasureSceneTrust(Pipeline& pipeline) {
  const Project& project = pipeline.project;
  std::filesystem::remove(project.TrustFile());
  if (!pipeline.settings.trust.Measured()) return;
  try {
    SceneSession session(pipeline.comm, project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
    const survey::Survey survey = survey::LoadRefinedSurvey(project.SurveyFolder());
    std::filesystem::create_directories(project.PixelCacheFile().parent_path());
    const image::PixelCache pixels =
        image::PixelCache::Open(project.PixelCacheFile(), PixelSources(survey), pipeline.settings.run.image_width, session.threads());
    trust::Trust trust = evaluate::trust::MeasureTrust(session.scene(), survey, pixels, pipeline.settings.trust, session.threads());
    trust.scene = trust::SceneIdentity(project.SceneFile());
    trust::Save(trust, project.TrustFile());
  } catch (const base::InputError& error) {
    // Where photos are gone the message lists all of them, a line each.
    const std::string text = error.what();
    base::LogWarning("it is not known how far the scene can be trusted: {}", text.substr(0, text.find('\n')));
  }
}

}  // namespace

std::optional<trust::Trust> TrustOfScene(const Project& project) {
  if (!std::filesystem::exists(project.TrustFile())) return std::nullopt;
  try {
    return trust::LoadTrustOf(project.SceneFile());
  } catch (const base::InputError& error) {
    base::LogWarning("it is not known how far the scene can be trusted: {}", error.what());
  }
  return std::nullopt;
}

std::string MergeBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  const Project& project = pipeline.project;
  const scene::TrainReport training = scene::ReadTrainReport(project.TrainReport());
  const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
  const std::optional<StageStamp> train = LoadStamp(project, "train");
  merge::MergeInput input{.context = project.ContextCheckpoint(),
                          .blocks = {},
                          .origin = blocks.origin,
                          .georeferenced = blocks.georeferenced,
                          .accuracy = blocks.accuracy,
                          .height_reference = blocks.height_reference,
                          .borders = pipeline.settings.merge.Borders(),
                          .storage = pipeline.settings.merge.Storage(),
                          .look = merge::ParseLook(pipeline.settings.merge.look),
                          .use_context = pipeline.settings.train.coupling != "independent",
                          .config_toml = pipeline.settings.Toml(),
                          .config_hash = train ? train->Hash() : "",
                          .scene = project.SceneFile()};
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    const scene::FieldTraining* field = training.Find(block.name);
    if (field != nullptr && field->ok && field->shows_context && pipeline.settings.train.coupling != "independent") {
      base::LogWarning("block {} shows its photos worse than the context does ({:.2f} dB instead of {:.2f} dB): the scene shows the context there",
                       block.name, field->block_psnr_db, field->context_psnr_db);
      input.blocks.push_back({.checkpoint = project.BlockCheckpoint(block.name), .gsd_m = block.gsd_m, .shows_context = true});
    } else if (field != nullptr && field->ok) {
      input.blocks.push_back({.checkpoint = project.BlockCheckpoint(block.name), .gsd_m = block.gsd_m});
    } else {
      base::LogWarning("block {} has no finished checkpoint: the scene shows the coarse context field there. Run 'skyquilt train' to train it again",
                       block.name);
    }
  }
  merge::MergeScene(input);
  base::LogInfo("scene: {}", project.SceneFile().string());
  MeasureSceneTrust(pipeline);
  return StageStamp::kDone;
}

}  // namespace skyquilt::coordinator
