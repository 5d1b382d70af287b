#include "bench/study/study.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/study/scene_views.h"
#include "bench/study/thin_survey.h"
#include "coordinator/rendering/scene_session.h"
#include "coordinator/scheduler/field_context.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "core/scene/field_file.h"
#include "core/scene/scene_file.h"
#include "core/survey/made_masks.h"
#include "evaluate/metrics/training_curve.h"

namespace skyquilt::bench {
namespace {

constexpr const char* kFix = "Run the bench again with --restart, or remove this file";

// Options that do not change a result.
constexpr const char* kIdle[] = {"run.threads",         "run.within_s",     "run.memory_gb", "context.checkpoint_every_s", "train.checkpoint_every_s",
                                 "context.diagnostics", "train.diagnostics"};

void RemoveOldRuns(const std::filesystem::path& folder) {
  for (const char* part : {"runs", "source", "cache"}) {
    std::error_code error;
    std::filesystem::remove_all(folder / part, error);
    if (error) throw base::InputError(folder / part, "cannot be removed: " + error.message(), "Check the permissions of the folder");
  }
}

// Mean PSNR of the training batches over all blocks, at 60 fractions of the training; x is that fraction of the blocks' total training seconds.
std::vector<std::pair<double, double>> JoinedCurve(const scene::TrainReport& training, const std::filesystem::path& checkpoint_folder) {
  constexpr int kPoints = 60;
  std::vector<std::pair<double, double>> joined;
  std::vector<std::string> blocks;
  for (const scene::FieldTraining& field : training.fields) {
    if (field.block >= 0) blocks.push_back(field.name);
  }
  evaluate::metrics::Curves curves = evaluate::metrics::ReadCurves(checkpoint_folder, blocks);
  std::erase_if(curves, [](const auto& entry) { return entry.second.empty(); });
  if (curves.empty()) return joined;
  double seconds = 0.0;
  for (const scene::FieldTraining& field : training.fields) {
    if (curves.contains(field.name)) seconds += field.seconds;
  }
  for (int k = 1; k <= kPoints; ++k) {
    const double share = static_cast<double>(k) / kPoints;
    double sum = 0.0;
    size_t counted = 0;
    for (const auto& [name, curve] : curves) {
      const double until = share * curve.back().step;
      const auto at = std::find_if(curve.begin(), curve.end(), [until](const evaluate::metrics::CurvePoint& p) { return p.step >= until; });
      if (at == curve.end() || !std::isfinite(at->psnr_db)) continue;
      sum += at->psnr_db;
      ++counted;
    }
    if (counted == curves.size()) joined.emplace_back(share * seconds, sum / static_cast<double>(curves.size()));
  }
  return joined;
}

// How far the field's training PSNR fell, and how far below its best it is in the end.
void AddFalls(const evaluate::metrics::Curves& curves, double final_psnr_db, VariantField* field) {
  constexpr double kFirstStep = 300.0;  // before, surfaces are not found yet
  const auto curve = curves.find(field->name);
  if (curve == curves.end()) return;
  double best = -std::numeric_limits<double>::infinity();
  for (const evaluate::metrics::CurvePoint& point : curve->second) {
    if (point.step < kFirstStep || !std::isfinite(point.psnr_db)) continue;
    best = std::max(best, point.psnr_db);
    field->worst_fall_db = std::max(std::isnan(field->worst_fall_db) ? 0.0 : field->worst_fall_db, best - point.psnr_db);
  }
  if (std::isfinite(best) && std::isfinite(final_psnr_db)) field->end_below_best_db = std::max(0.0, best - final_psnr_db);
}

// Number of parameters of every field in a scene, by name.
std::map<std::string, int64_t> SceneParameters(const std::filesystem::path& file) {
  const checkpoint::ArchiveReader reader = scene::OpenScene(file);
  std::vector<std::string> prefixes = {scene::kContextPrefix};
  for (int64_t i = 0; i < reader.IntAttribute("blocks"); ++i) prefixes.push_back(scene::BlockPrefix(i));
  std::map<std::string, int64_t> parameters;
  for (const std::string& prefix : prefixes) {
    if (reader.HasAttribute(prefix + "name")) parameters[reader.StringAttribute(prefix + "name")] = scene::StoredParameterCount(reader, prefix);
  }
  return parameters;
}

// Replaces the folder `to` if it exists.
void MoveFolder(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::filesystem::remove_all(to);
  std::filesystem::create_directories(to.parent_path());
  base::Rename(from, to);
}

}  // namespace

Study::Study(comm::Communicator& comm, Options options) : comm_(comm), options_(std::move(options)) {
  const StudySurvey& wanted = options_.survey;
  if (wanted.folder.empty() == wanted.place.empty()) throw base::UsageError("a bench needs either --survey FOLDER or --place NAME, not both");
  if (!wanted.place.empty()) {
    coordinator::Settings settings = options_.settings;
    settings.simulate.place = wanted.place;
    settings.Check();
  }
  options_.folder = std::filesystem::absolute(options_.folder).lexically_normal();
  base::RequireWritableFolder(options_.folder);
  if (options_.restart) RemoveOldRuns(options_.folder);
  base::RequireWritableFolder(options_.folder / "runs");
  base::AddLogFile(options_.folder / "log.txt");
  if (!wanted.folder.empty() && coordinator::Project::IsProject(wanted.folder)) {
    source_ = std::filesystem::absolute(wanted.folder);
  } else {
    source_ = options_.folder / "source";
    coordinator::Pipeline pipeline{.comm = comm_,
                                   .project = coordinator::Project::Create(source_),
                                   .settings = options_.settings,
                                   .quiet = options_.quiet,
                                   .verbose = options_.verbose};
    std::filesystem::path photos = wanted.folder;
    if (photos.empty()) {
      pipeline.settings.simulate.place = wanted.place;
      photos = pipeline.project.SimulatedFolder();
      coordinator::SimulateStage(pipeline, photos);
    }
    coordinator::PrepareStage(pipeline, photos, wanted.model);
    if (pipeline.settings.masks.Any()) coordinator::MasksStage(pipeline);
  }
  survey_ = survey::LoadSurvey(source_ / "survey");
}

std::string Study::Identity(const Variant& variant, const coordinator::Settings& settings) const {
  coordinator::FlatOptions flat = settings.Flat();
  for (const char* key : kIdle) flat.erase(key);
  // The survey file is part of the identity, so the options that made it are not needed.
  std::erase_if(flat, [](const auto& entry) { return entry.first.starts_with("simulate.") || entry.first.starts_with("prepare."); });
  std::string identity =
      config::Hash(flat) + " " + coordinator::FileIdentity(source_ / "survey" / "survey.json") + " " + std::to_string(variant.every_nth_photo);
  const std::filesystem::path masks = survey::MadeMasksFile(source_ / "survey");
  if (std::filesystem::exists(masks)) identity.append(" ").append(coordinator::FileIdentity(masks));
  for (const std::string& prefix : variant.photo_prefixes) identity.append(" ").append(prefix);
  if (scales_) identity.append(" ").append(scales_->Identity());
  if (lights_) identity.append(" ").append(lights_->Identity());
  if (views_ > 0) identity.append(" views ").append(std::to_string(views_));
  if (variant.max_tilt_deg < 180.0) identity.append(" tilt ").append(std::to_string(variant.max_tilt_deg));
  if (buildings_) identity.append(" buildings");
  if (variant.edit != SurveyEdit::kNone) identity.append(" edit ").append(std::to_string(static_cast<int>(variant.edit)));
  // Older programs left the points of all photos to variants with fewer.
  if (!variant.AllPhotos()) identity.append(" own points");
  return identity;
}

coordinator::Settings Study::SettingsOf(const Variant& variant) const {
  const auto legal = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_'; };
  SKYQUILT_CHECK(!variant.name.empty() && std::all_of(variant.name.begin(), variant.name.end(), legal), variant.name);
  SKYQUILT_CHECK(variant.every_nth_photo >= 1, variant.name);
  coordinator::Settings settings = options_.settings;
  for (const config::Override& entry : variant.overrides) settings.Set(entry);
  settings.Check();
  return settings;
}

std::vector<VariantResult> Study::RunOnce(const Variant& variant, const std::vector<Variant>& merged) {
  const coordinator::Settings settings = SettingsOf(variant);
  const std::string identity = Identity(variant, settings);
  std::vector<VariantResult> results;
  if (std::optional<VariantResult> known = Load(variant, identity)) results.push_back(std::move(*known));
  for (const Variant& other : merged) {
    if (results.empty()) break;
    // The identity includes that of the variant, because the training is the variant's.
    const std::optional<VariantResult> known = Load(other, identity + " " + Identity(other, SettingsOf(other)));
    if (!known) results.clear();
    if (known) results.push_back(*known);
  }
  if (results.size() == 1 + merged.size()) {
    base::LogInfo("{}: nothing to do, its result is saved", variant.label);
    return results;
  }
  scene::TrainReport training;
  results = {Measure(variant, settings, identity, !merged.empty(), &training)};
  const coordinator::Project project{RunFolder(variant)};
  const std::filesystem::path own_report = project.folder / "report_of_itself";
  if (!merged.empty() && results.front().failure.empty()) MoveFolder(project.ReportFolder(), own_report);
  for (const Variant& other : merged) {
    if (!results.front().failure.empty()) {
      VariantResult failed = results.front();
      failed.name = other.name;
      failed.label = other.label;
      results.push_back(std::move(failed));
      continue;
    }
    base::LogInfo("--- {}", other.label);
    const coordinator::Settings own = SettingsOf(other);
    // restart: the existing scene has other merge settings, which would be refused otherwise.
    coordinator::Pipeline pipeline{
        .comm = comm_, .project = project, .settings = own, .restart = true, .quiet = options_.quiet, .verbose = options_.verbose};
    coordinator::MergeStage(pipeline);
    const evaluate::metrics::Metrics metrics = Evaluate(other, pipeline);
    MoveFolder(project.ReportFolder(), coordinator::Project{RunFolder(other)}.ReportFolder());
    results.push_back(Collect(variant, other, training, metrics));
    results.back().label = other.label;
    base::WriteFileAtomically(RunFolder(other).string() + ".json", ResultJson(results.back(), identity + " " + Identity(other, own)));
  }
  if (std::filesystem::exists(own_report)) MoveFolder(own_report, project.ReportFolder());
  if (!options_.keep && results.front().failure.empty()) RemoveLargeFiles(variant);
  return results;
}

VariantResult Study::Measure(const Variant& variant, const coordinator::Settings& settings, const std::string& identity, bool merge_anew,
                             scene::TrainReport* training) {
  base::LogInfo("--- {}", variant.label);
  VariantResult result;
  result.name = variant.name;
  try {
    const evaluate::metrics::Metrics metrics = Train(variant, settings, merge_anew, training);
    result = Collect(variant, variant, *training, metrics);
    AddFromScene(variant, settings, &result);
    if (lights_) AddLights(variant, settings, &result);
  } catch (const base::BlockError& error) {
    result.failure = error.what();
  }
  result.label = variant.label;
  if (result.failure.empty()) {
    base::WriteFileAtomically(RunFolder(variant).string() + ".json", ResultJson(result, identity));
  } else {
    base::LogError("{}: {}", variant.label, result.failure);
  }
  return result;
}

void Study::RemoveLargeFiles(const Variant& variant) const {
  std::error_code ignored;
  for (const char* part : {"checkpoints", "cache", "scene.h5", "scene.h5.prev", "surface", "survey", "photos"})
    std::filesystem::remove_all(RunFolder(variant) / part, ignored);
}

// Decoded photos of one width are the same for all variants that use all photos, so they share one file through hard links.
void Study::LinkPixels(const std::filesystem::path& run_folder, int image_width, bool share) const {
  const std::filesystem::path shared = options_.folder / "cache" / ("pixels_" + std::to_string(image_width) + ".bin");
  const std::filesystem::path own = coordinator::Project{run_folder}.PixelCacheFile();
  const std::filesystem::path& from = share ? own : shared;
  const std::filesystem::path& to = share ? shared : own;
  if (!std::filesystem::exists(from) || std::filesystem::exists(to)) return;
  std::filesystem::create_directories(to.parent_path());
  std::error_code ignored;  // on a file system without links every variant decodes its photos itself
  std::filesystem::create_hard_link(from, to, ignored);
}

coordinator::Pipeline Study::BeginRun(const Variant& variant, const coordinator::Settings& settings, bool merge_anew) const {
  const coordinator::Project project = coordinator::Project::Create(RunFolder(variant));
  if (!std::filesystem::exists(project.SurveyFolder() / "survey.json")) {
    const survey::Survey edited = variant.edit == SurveyEdit::kNone ? survey_ : EditSurvey(survey_, variant.edit, project.folder / "photos");
    survey::SaveSurvey(variant.AllPhotos() ? edited : ThinSurvey(edited, variant), project.SurveyFolder());
  }
  coordinator::Pipeline pipeline{.comm = comm_, .project = project, .settings = settings, .quiet = options_.quiet, .verbose = options_.verbose};
  pipeline.settings.masks = {};  // the survey was loaded with them
  if (!merge_anew) coordinator::RequireSameConfiguration(pipeline, "partition");
  coordinator::PartitionStage(pipeline);
  if (variant.AllPhotos()) LinkPixels(project.folder, settings.run.image_width, false);
  return pipeline;
}

evaluate::metrics::Metrics Study::Evaluate(const Variant& variant, coordinator::Pipeline& pipeline) const {
  pipeline.settings.evaluate.scored_pixels_folder = RunFolder(variant) / "covered";
  return coordinator::EvaluateStage(pipeline);
}

evaluate::metrics::Metrics Study::Train(const Variant& variant, const coordinator::Settings& settings, bool merge_anew,
                                        scene::TrainReport* training) {
  coordinator::Pipeline pipeline = BeginRun(variant, settings, merge_anew);
  const coordinator::Project& project = pipeline.project;
  base::ResetPeakRss();
  try {
    *training = coordinator::TrainStage(pipeline);
  } catch (const base::UsageError& error) {
    throw base::BlockError(error.what());  // these settings cannot be trained, for instance for lack of memory: this is a result of the bench
  }
  coordinator::ThrowIfBlocksFailed(*training, project);
  if (variant.AllPhotos()) LinkPixels(project.folder, settings.run.image_width, true);
  pipeline.restart = merge_anew;
  coordinator::MergeStage(pipeline);
  if (buildings_) {
    coordinator::SurfaceStage(pipeline);
    coordinator::BuildingsStage(pipeline);
  }
  return Evaluate(variant, pipeline);
}

VariantResult Study::Collect(const Variant& trained, const Variant& scored, const scene::TrainReport& training,
                             const evaluate::metrics::Metrics& metrics) const {
  const coordinator::Project project{RunFolder(trained)};
  VariantResult r;
  r.name = scored.name;
  const auto known = [](double value) { return std::isfinite(value) ? value : VariantResult::kNone; };
  r.psnr_db = known(metrics.psnr);
  r.ssim = known(metrics.ssim);
  r.flip = known(metrics.flip);
  r.lpips = known(metrics.lpips);
  r.psnr_full_db = known(metrics.psnr_full_frame);
  r.ssim_full = known(metrics.ssim_full_frame);
  r.coverage = known(metrics.coverage);
  r.seam_gap_db = known(metrics.seam_psnr_gap_db);
  r.depth_rmse_m = known(metrics.depth_rmse_m);
  r.depth_median_abs_m = known(metrics.depth_median_abs_m);
  r.floater_opacity = known(metrics.floater_opacity);
  r.kept_median_gsd = known(metrics.kept_points.median_gsd);
  r.kept_nmad_gsd = known(metrics.kept_points.nmad_gsd);
  r.classes = metrics.classes;
  r.buildings = metrics.buildings;
  r.flat_roof_rms_m = known(metrics.flat_roof_rms_m);
  r.flat_roof_nmad_m = known(metrics.flat_roof_nmad_m);
  r.train_seconds = known(metrics.train_seconds);
  r.samples_per_second = known(metrics.samples_per_second);
  r.peak_rss_bytes = metrics.peak_rss_bytes > 0 ? static_cast<double>(metrics.peak_rss_bytes) : VariantResult::kNone;
  r.scene_parameters = static_cast<double>(metrics.parameters);
  r.evaluate_seconds = known(metrics.evaluate_seconds);
  for (const auto& [clearance_m, opacity] : metrics.floater_profile) {
    if (std::isfinite(opacity)) r.floater_profile.emplace_back(clearance_m, opacity);
  }
  r.scene_bytes = static_cast<double>(std::filesystem::file_size(project.SceneFile()));
  r.samples = r.parameters = 0.0;
  const std::map<std::string, int64_t> kept = SceneParameters(project.SceneFile());
  const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
  std::vector<std::string> names;
  for (const scene::FieldTraining& field : training.fields) names.push_back(field.name);
  const evaluate::metrics::Curves curves = evaluate::metrics::ReadCurves(project.CheckpointFolder(), names);
  for (const scene::FieldTraining& field : training.fields) {
    r.samples += static_cast<double>(field.samples);
    r.parameters += static_cast<double>(field.parameters);
    const auto block = std::find_if(blocks.blocks.begin(), blocks.blocks.end(), [&field](const partition::Block& b) { return b.name == field.name; });
    const auto score =
        std::find_if(metrics.blocks.begin(), metrics.blocks.end(), [&field](const evaluate::metrics::BlockScore& b) { return b.name == field.name; });
    const auto stored = kept.find(field.name);
    r.fields.push_back({.name = field.name,
                        .parameters = field.parameters,
                        .samples = field.samples,
                        .scene_parameters = stored == kept.end() ? 0 : stored->second,
                        .log2_table_size = block == blocks.blocks.end() ? 0 : block->log2_table_size,
                        .steps = field.steps,
                        .rays = field.rays,
                        .seconds = field.seconds,
                        .psnr_db = score == metrics.blocks.end() ? VariantResult::kNone : known(score->psnr_db),
                        .falls = static_cast<int>(field.falls.size()),
                        .shows_context = field.shows_context});
    AddFalls(curves, field.psnr_db, &r.fields.back());
    if (field.block >= 0) ++r.blocks;
  }
  r.layout = std::to_string(blocks.rows) + "x" + std::to_string(blocks.columns);
  r.curve = JoinedCurve(training, project.CheckpointFolder());
  const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
  r.training_photos = static_cast<int>(std::count_if(survey.photos.begin(), survey.photos.end(), [](const auto& photo) { return !photo.is_test; }));
  const std::filesystem::path relative = std::filesystem::path("runs") / scored.name / "report";
  r.report = (relative / "index.html").generic_string();
  std::vector<std::string> renders;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(options_.folder / relative / "images", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("photo_") && name.ends_with("_render.jpg")) renders.push_back(name);
  }
  if (renders.empty()) return r;
  std::sort(renders.begin(), renders.end());
  const std::string chosen = renders[renders.size() / 2];
  const std::string stem = chosen.substr(0, chosen.size() - std::string("_render.jpg").size());
  r.render = (relative / "images" / chosen).generic_string();
  r.photo = (relative / "images" / (stem + "_photo.jpg")).generic_string();
  r.error = (relative / "images" / (stem + "_error.png")).generic_string();
  return r;
}

void Study::AddFromScene(const Variant& variant, const coordinator::Settings& settings, VariantResult* result) const {
  if (!scales_ && views_ == 0) return;
  const coordinator::Project project{RunFolder(variant)};
  coordinator::SceneSession session(comm_, project.SceneFile(), settings.run, options_.verbose, options_.quiet);
  const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
  const image::PixelCache pixels =
      image::PixelCache::Open(project.PixelCacheFile(), coordinator::PixelSources(survey), settings.run.image_width, session.threads());
  const std::filesystem::path own = std::filesystem::path("runs") / variant.name;
  if (scales_) {
    const ScaleInput input{.scene = &session.scene(), .survey = &survey, .pixels = &pixels, .evaluate = settings.evaluate};
    result->scale_pictures = (own / "scales").generic_string();
    result->scales = ScoreScales(input, *scales_, options_.folder / result->scale_pictures, session.threads());
  }
  if (views_ > 0) {
    const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
    evaluate::EvaluateInput input;
    input.scene = &session.scene();
    input.survey = &survey;
    input.blocks = &blocks;
    input.pixels = &pixels;
    input.project_folder = project.folder;
    input.options = settings.evaluate;
    result->views = (own / "views").generic_string();
    WriteViews(input, views_, options_.folder / result->views, session.threads());
  }
}

Study Study::Beside(const std::string& name, const StudySurvey& survey, const std::vector<config::Override>& overrides) const {
  Options options = options_;
  options.folder = options_.folder / name;
  options.survey = survey;
  for (const config::Override& entry : overrides) options.settings.Set(entry);
  options.settings.Check();
  return {comm_, std::move(options)};
}

std::optional<VariantResult> Study::Load(const Variant& variant, const std::string& identity) const {
  const std::filesystem::path file = RunFolder(variant).string() + ".json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  std::string made_with;
  VariantResult result;
  try {
    result = ParseResult(base::ReadFile(file), &made_with);
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged: ") + error.what(), kFix);
  }
  if (made_with != identity) {
    throw base::UsageError(file.string() + ": this variant was measured with other settings or another survey. Use another folder, or --restart");
  }
  result.label = variant.label;
  return result;
}

}  // namespace skyquilt::bench
