// The table of stages.
#include <fmt/core.h>

#include <algorithm>

#include "coordinator/stages/stage.h"
#include "coordinator/stages/stage_bodies.h"
#include "coordinator/stages/stage_inputs.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/checkpoint/archive.h"
#include "core/scene/field_file.h"
#include "core/survey/made_masks.h"
#include "tour/export/staged_folder.h"

namespace skyquilt::coordinator {
namespace {

std::filesystem::path SurveyFile(const Project& project) {
  return project.SurveyFolder() / "survey.json";
}

std::filesystem::path BlocksFile(const Project& project) {
  return project.BlocksFile();
}

std::filesystem::path TrainReportFile(const Project& project) {
  return project.TrainReport();
}

std::filesystem::path SceneFile(const Project& project) {
  return project.SceneFile();
}

// The checkpoints of the context and of every block that train.json lists as trained. When train.json is damaged, no blocks are required here;
// reading the report fails later (RecallTraining), and the stage runs again.
Paths TrainProof(const Project& project) {
  Paths proof = {project.ContextCheckpoint(), project.TrainReport()};
  try {
    for (const scene::FieldTraining& field : scene::ReadTrainReport(project.TrainReport()).fields) {
      if (field.ok && field.block >= 0) proof.push_back(project.BlockCheckpoint(field.name));
    }
  } catch (const base::InputError&) {
  }
  return proof;
}

// Checkpoints of another version are refused before the scene that was made from them is removed. One stands for all.
void RequireReadableTraining(const Project& project) {
  scene::ReadTrainReport(project.TrainReport());
  const std::filesystem::path context = project.ContextCheckpoint();
  if (std::filesystem::exists(context)) checkpoint::ArchiveReader(context).RequireVersion(scene::kCheckpointVersion);
}

// Without any masks to make the stage has nothing to show.
Paths MasksProof(const Project& project) {
  const std::optional<StageStamp> stamp = LoadStamp(project, "masks");
  const auto none = [&](const char* input) { return stamp->inputs.contains(input) && stamp->inputs.at(input).empty(); };
  if (stamp && none("network") && none("ignored ground")) return {};
  return {survey::MadeMasksFile(project.SurveyFolder())};
}

bool RecallTraining(Pipeline& pipeline) {
  std::optional<scene::TrainReport> report = scene::TryReadTrainReport(pipeline.project.TrainReport());
  if (!report) return false;
  pipeline.training = *std::move(report);
  return true;
}

bool RecallMetrics(Pipeline& pipeline) {
  try {
    pipeline.metrics = evaluate::metrics::ReadMetrics(pipeline.project.MetricsFile());
    return true;
  } catch (const base::InputError& error) {
    base::LogWarning("{}", error.what());
    return false;
  }
}

// They are found in the cloud and above the terrain model of the surface.
bool MakesBuildings(const Settings& settings) {
  return settings.buildings.enabled && settings.surface.enabled && settings.surface.cloud && settings.surface.maps;
}

// They count where they are asked for, so that surveys of older programs stay valid.
std::vector<std::string> SimulatedExtras() {
  return {"simulate.video_fps", "simulate.panoramas", "simulate.panorama_width"};
}

std::vector<Stage> MakeTable() {
  return {
      {.name = "simulate",
       .options = {"simulate."},
       .ignored_options = SimulatedExtras(),  // inputs
       .inputs =
           [](const Pipeline& pipeline) {
             const simulate::SimulateOptions& options = pipeline.settings.simulate;
             FlatOptions inputs;
             if (options.video_fps > 0) inputs["simulate.video_fps"] = std::to_string(options.video_fps);
             if (options.panoramas > 0) {
               inputs["simulate.panoramas"] = fmt::format("{} of {} pixels", options.panoramas, options.panorama_width);
             }
             return inputs;
           },
       .outputs = [](const Project& p) { return Paths{p.SimulatedFolder()}; },
       .completion_files = [](const Project& p) { return Paths{p.folder / "simulate.json"}; },
       .body = SimulateBody,
       .separate_folder = [](const Project& p) { return Project{p.SimulatedFolder()}; },
       .dated = false},
      {.name = "prepare",
       .options = {"prepare."},
       .ignored_options = OptionsAmongInputs(),
       .inputs = PrepareInputs,
       .outputs =
           [](const Project& p) {
             return Paths{p.SurveyFolder(), p.Earlier().folder};
           },
       .completion_files = [](const Project& p) { return Paths{SurveyFile(p)}; },
       .body = PrepareBody,
       .on_new_inputs = OnNewInputs::kRefuse},
      // Its results are in the survey's folder: the survey is loaded with them.
      {.name = "masks",
       .options = {"masks."},
       .ignored_options = {"masks.segment", "masks.segment_config", "masks.ignore_ground"},  // inputs
       .required = {{SurveyFile, "prepare"}},
       .inputs = MaskInputs,
       // Not network/ and photos/, which say themselves what they were made of.
       .outputs =
           [](const Project& p) {
             const std::filesystem::path folder = survey::MadeMasksFolder(p.SurveyFolder());
             return Paths{survey::MadeMasksFile(p.SurveyFolder()), folder / "combined", folder / "look", folder / "product_area.geojson"};
           },
       .completion_files = MasksProof,
       .body = MasksBody,
       .wanted = [](const Settings& settings) { return settings.masks.Any(); },
       .refused_after = "train"},
      {.name = "partition",
       .options = {"partition.", "run.image_width"},
       .required = {{SurveyFile, "prepare"}},
       .inputs =
           [](const Pipeline& pipeline) {
             return FlatOptions{{"survey", SurveyIdentity(pipeline.project)}};
           },
       .outputs =
           [](const Project& p) {
             return Paths{p.BlocksFile(), p.Earlier().BlocksFile()};
           },
       .completion_files = [](const Project& p) { return Paths{p.BlocksFile()}; },
       .body = PartitionBody,
       .on_new_inputs = OnNewInputs::kRefuse},
      {.name = "train",
       .options = {"brightness.", "context.", "train.", "priors.", "run.image_width", "run.time_budget_s", "run.context_share",
                   "run.shortest_block_s", "run.seed"},
       // How often a field is saved does not change its result.
       .ignored_options = {"context.checkpoint_every_s", "train.checkpoint_every_s", "context.diagnostics", "train.diagnostics"},
       .required = {{SurveyFile, "prepare"}, {BlocksFile, "partition"}},
       .inputs =
           [](const Pipeline& pipeline) {
             FlatOptions inputs{{"survey", MaskedSurveyIdentity(pipeline)}, {"blocks", FileIdentity(pipeline.project.BlocksFile())}};
             // Left out where they change nothing, so that trainings of older programs stay valid.
             if (pipeline.settings.robust.Any()) inputs.merge(Select(pipeline.settings.Flat(), {"robust."}));
             if (pipeline.settings.trust.tiles != trust::TrustOptions().tiles) inputs.merge(Select(pipeline.settings.Flat(), {"trust.tiles"}));
             return inputs;
           },
       .outputs =
           [](const Project& p) {
             return Paths{p.CheckpointFolder(),
                          p.MoversFolder(),
                          p.TrainReport(),
                          p.PixelCacheFile().parent_path(),
                          p.TrainLedgerFile(),
                          p.Earlier().CheckpointFolder(),
                          p.Earlier().TrainLedgerFile()};
           },
       .completion_files = TrainProof,
       .body = TrainBody,
       .load_results = RecallTraining,
       .on_new_inputs = OnNewInputs::kRefuse},
      {.name = "merge",
       .options = {"merge."},
       .required = {{BlocksFile, "partition"}, {TrainReportFile, "train"}},
       .check = RequireReadableTraining,
       .inputs =
           [](const Pipeline& pipeline) {
             FlatOptions inputs{{"train", FileIdentity(pipeline.project.TrainReport())}, {"blocks", FileIdentity(pipeline.project.BlocksFile())}};
             // Left out where it is the default, so that scenes of older programs stay valid.
             if (pipeline.settings.trust.rays != trust::TrustOptions().rays) inputs.merge(Select(pipeline.settings.Flat(), {"trust.rays"}));
             return inputs;
           },
       .outputs =
           [](const Project& p) {
             return Paths{p.SceneFile(), p.SceneFile().string() + ".prev", p.TrustFile(), p.TrustFile().string() + ".prev"};
           },
       .completion_files = [](const Project& p) { return Paths{p.SceneFile()}; },
       .body = MergeBody},
      {.name = "products",
       .options = {"products."},
       // The boundary's content, the vertical system and the kinds that are made are inputs, so that others make the products again. Previews are
       // made before, by other stages.
       .ignored_options = {"products.boundary", "products.preview", "products.vertical", "products.kinds"},
       .required = {{SceneFile, "merge"}},
       .inputs = ProductInputs,
       .outputs =
           [](const Project& p) {
             return Paths{p.ProductsFolder(), p.RendersFolder()};
           },
       .completion_files = [](const Project& p) { return Paths{p.ProductsFolder()}; },
       .body = ProductsBody},
      {.name = "surface",
       .options = {"surface.", "products.exposure", "products.resolution_m", "products.max_pixels", "run.image_width"},
       .ignored_options = {"surface.enabled"},
       .required = {{SceneFile, "merge"}, {SurveyFile, "prepare"}},
       .inputs = SurfaceInputs,
       .outputs =
           [](const Project& p) {
             return Paths{p.SurfaceFolder(), p.SurfaceWorkFolder()};
           },
       .completion_files = [](const Project& p) { return Paths{p.SurfaceTable()}; },
       .body = SurfaceBody,
       .wanted = [](const Settings& settings) { return settings.surface.enabled; }},
      {.name = "buildings",
       .options = {"buildings."},
       .ignored_options = {"buildings.enabled", "buildings.footprints", "buildings.facade_gsd"},
       .required = {{SceneFile, "merge"}, {[](const Project& p) { return p.SurfaceTable(); }, "surface"}},
       .inputs =
           [](const Pipeline& pipeline) {
             return FlatOptions{{"surface", FileIdentity(pipeline.project.StampFile("surface"))}, {"footprints", FootprintsIdentity(pipeline)}};
           },
       .outputs = [](const Project& p) { return Paths{p.BuildingsFolder()}; },
       .completion_files = [](const Project& p) { return Paths{p.BuildingsFile()}; },
       .body = BuildingsBody,
       .wanted = MakesBuildings},
      // Exports the project's tour to tour/index.html; proposes one first where there is none that a person made, as chosen in [tour].
      // Its options are inputs: another size exports the tour again.
      {.name = "tour",
       .options = {},
       .required = {{SceneFile, "merge"}},
       .inputs =
           [](const Pipeline& pipeline) {
             FlatOptions inputs = Select(pipeline.settings.Flat(), {"tour.", "products.exposure", "products.plain_surround"});
             inputs["scene"] = FileIdentity(pipeline.project.StampFile("merge"));
             inputs["products"] = FileIdentity(pipeline.project.StampFile("products"));
             inputs["surface"] = FileIdentity(pipeline.project.StampFile("surface"));
             inputs["buildings"] = FileIdentity(pipeline.project.StampFile("buildings"));
             inputs["tour"] = EditedTourIdentity(pipeline.project);
             return inputs;
           },
       // Not tour/assets, which people uploaded.
       .outputs =
           [](const Project& p) {
             Paths outputs = {p.TourWorkFolder()};
             for (const std::string& name : tour::ExportedNames()) outputs.push_back(p.TourFolder() / name);
             return outputs;
           },
       .completion_files = [](const Project& p) { return Paths{p.TourFolder() / "index.html"}; },
       .body = TourBody,
       .wanted = [](const Settings& settings) { return settings.tour.auto_stops > 0; }},
      {.name = "evaluate",
       .options = {"evaluate.", "run.image_width"},
       // How often the scores are saved does not change them.
       .ignored_options = {"evaluate.save_every_s"},
       .required = {{SceneFile, "merge"}},
       .inputs =
           [](const Pipeline& pipeline) {
             return FlatOptions{{"scene", FileIdentity(pipeline.project.StampFile("merge"))},
                                {"products", FileIdentity(pipeline.project.StampFile("products"))},
                                {"surface", FileIdentity(pipeline.project.StampFile("surface"))},
                                {"buildings", FileIdentity(pipeline.project.StampFile("buildings"))}};
           },
       .outputs =
           [](const Project& p) {
             return Paths{p.ReportFolder(), p.EvaluateProgressFile()};
           },
       .completion_files = [](const Project& p) { return Paths{p.MetricsFile()}; },
       .body = EvaluateBody,
       .load_results = RecallMetrics},
  };
}

}  // namespace

const std::vector<Stage>& Stages() {
  static const std::vector<Stage> table = MakeTable();
  return table;
}

const Stage& StageNamed(const std::string& name) {
  const auto found = std::find_if(Stages().begin(), Stages().end(), [&name](const Stage& stage) { return stage.name == name; });
  SKYQUILT_CHECK(found != Stages().end(), name);
  return *found;
}

}  // namespace skyquilt::coordinator
