#include "coordinator/stages/stage_bodies.h"

#include "coordinator/rendering/scene_session.h"
#include "coordinator/scheduler/expected_steps.h"
#include "coordinator/scheduler/field_context.h"
#include "coordinator/scheduler/kept_blocks.h"
#include "coordinator/scheduler/train_all.h"
#include "coordinator/stages/addition.h"
#include "coordinator/stages/first_picture.h"
#include "coordinator/stages/level_settings.h"
#include "coordinator/stages/product_area.h"
#include "coordinator/stages/timed_run.h"
#include "coordinator/tasks/rank_tasks.h"
#include "core/base/amounts.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/thread_pool.h"
#include "core/image/video_writer.h"
#include "core/scene/scene.h"
#include "core/survey/refined_poses.h"
#include "core/survey/view_kind.h"
#include "evaluate/evaluate.h"
#include "masks/make_masks.h"
#include "partition/altitude.h"
#include "partition/make_blocks.h"
#include "prepare/add_photos.h"
#include "prepare/prepare.h"
#include "products/camera_path.h"
#include "products/elevation.h"
#include "products/map_products.h"
#include "products/render_views.h"
#include "simulate/simulate.h"

namespace skyquilt::coordinator {
namespace {

void LogBlocks(const partition::BlockSet& blocks) {
  if (blocks.area_is_that_of_points) {
    base::LogWarning("photos see no ground at the height of the sparse points: blocks divide the rectangle around the points instead");
  }
  base::LogInfo("{} x {} blocks (rows x columns): {}", blocks.rows, blocks.columns, blocks.number_reason);
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) {
      base::LogInfo("  {}: empty ({})", block.name, block.empty_reason);
    } else {
      const Eigen::Vector3d size = block.max_enu - block.min_enu;
      base::LogInfo("  {}: {:.0f} x {:.0f} m, {:.1f} m high, {} photos from {:.1f} m, GSD {:.3f} m, 2^{} table entries per level", block.name,
                    size.x(), size.y(), size.z(), block.photos.size(), block.altitude_agl_m, block.gsd_m, block.log2_table_size);
      if (const std::string doubt = partition::AltitudeDoubt(block); !doubt.empty()) base::LogWarning("  {}: {}", block.name, doubt);
    }
  }
}

// Names whatever the scores of photos depend on: the stage's options and inputs, and the contents of files that options name.
std::string ScoresKey(const Pipeline& pipeline, const StageStamp& stamp) {
  const evaluate::EvaluateOptions& options = pipeline.settings.evaluate;
  std::string key = stamp.Hash();
  if (std::filesystem::exists(pipeline.project.TrustFile())) key.append(" ").append(FileIdentity(pipeline.project.TrustFile()));
  if (!options.lpips_network.empty()) key.append(" ").append(FileIdentity(options.lpips_network));
  if (!options.normal_photos.empty()) key.append(" ").append(PhotosIdentity(options.normal_photos, pipeline.project.folder));
  return key;
}

}  // namespace

products::ProductKinds KindsOf(const Pipeline& pipeline) {
  const std::string& kinds = pipeline.settings.products.kinds;
  const std::filesystem::path folder = pipeline.project.SurveyFolder();
  const bool level = kinds == "auto" && std::filesystem::exists(folder / "survey.json") && survey::LooksLevel(survey::LoadSurvey(folder));
  return products::KindsOf(kinds, level);
}

std::string SimulateBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  base::ThreadPool threads(pipeline.settings.run.threads);
  simulate::Simulate(pipeline.settings.simulate, pipeline.project.folder, threads);
  return StageStamp::kDone;
}

std::string PrepareBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  const prepare::PrepareInput input{
      .photos = pipeline.photos, .model = pipeline.model, .out_folder = pipeline.project.SurveyFolder(), .videos = pipeline.videos};
  base::ThreadPool threads(pipeline.settings.run.threads);
  RankTasks ranks(pipeline.comm, pipeline.settings.run, pipeline.project.folder, pipeline.verbose, pipeline.quiet);
  const auto show = [&](const survey::Survey& survey, std::chrono::steady_clock::time_point poses_known) {
    MakeFirstPicture(pipeline, survey, poses_known, threads);
  };
  if (IsAddition(pipeline.project)) {
    prepare::AddPhotos(input, EarlierSurveyOf(pipeline.project), pipeline.settings.prepare, threads, pipeline.comm.size() > 1 ? &ranks : nullptr);
    return StageStamp::kDone;
  }
  const survey::Survey survey = prepare::Prepare(input, pipeline.settings.prepare, threads, pipeline.comm.size() > 1 ? &ranks : nullptr, show);
  if (UseLevelSettings(pipeline, survey)) base::WriteFileAtomically(pipeline.project.ConfigFile(), pipeline.settings.Toml());
  return StageStamp::kDone;
}

std::string MasksBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  MaskTasks ranks(pipeline.comm, pipeline.settings.run, pipeline.project.folder, pipeline.verbose, pipeline.quiet);
  masks::MakeMasks(pipeline.project.SurveyFolder(), pipeline.settings.masks, pipeline.settings.run.threads,
                   pipeline.comm.size() > 1 ? &ranks : nullptr);
  return StageStamp::kDone;
}

std::string PartitionBody(Pipeline& pipeline, const StageStamp& stamp) {
  const survey::Survey survey = survey::LoadSurvey(pipeline.project.SurveyFolder());
  if (const std::filesystem::path earlier = pipeline.project.Earlier().BlocksFile(); std::filesystem::exists(earlier)) {
    const partition::BlockSet extended = partition::ExtendBlocks(survey, partition::LoadBlocks(earlier), pipeline.settings.partition);
    partition::SaveBlocks(extended, pipeline.project.BlocksFile());
    LogBlocks(extended);
    return StageStamp::kDone;
  }
  const double block_steps = ExpectedBlockSteps(pipeline.settings, pipeline.comm.size(), pipeline.comm.local_size());
  partition::BlockSet blocks = partition::MakeBlocks(survey, pipeline.settings.partition, pipeline.settings.run.image_width, block_steps);
  if (blocks.config_hash.empty()) blocks.config_hash = stamp.Hash();
  partition::SaveBlocks(blocks, pipeline.project.BlocksFile());
  LogBlocks(blocks);
  return StageStamp::kDone;
}

std::string TrainBody(Pipeline& pipeline, const StageStamp& stamp) {
  const survey::Survey survey = survey::LoadSurvey(pipeline.project.SurveyFolder());
  const partition::BlockSet blocks = partition::LoadBlocks(pipeline.project.BlocksFile());
  const TrainInput input{.survey = &survey,
                         .blocks = &blocks,
                         .config_hash = stamp.Hash(),
                         .kept = KeptBlocks(pipeline.project, survey, blocks, true),
                         .verbose = pipeline.verbose,
                         .quiet = pipeline.quiet};
  pipeline.training = TrainAll(pipeline.comm, input, pipeline.settings, pipeline.project);
  return pipeline.training.Failed().empty() ? StageStamp::kDone : StageStamp::kFailed;
}

std::string ProductsBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  const products::ProductKinds kinds = KindsOf(pipeline);
  products::ProductOptions options = OptionsOfProducts(pipeline);
  options.ortho = options.ortho && kinds.ortho;
  options.dsm = options.dsm && kinds.dsm;
  if (!kinds.video) options.video_seconds = 0.0;
  if (kinds.along_cameras) options.video_path = "cameras";
  const bool along_cameras = options.video_seconds > 0.0 && options.video_path == "cameras";
  survey::Survey survey;
  const bool from_photos = options.ortho && options.ortho_source == "photos";
  if (kinds.elevations || along_cameras || from_photos) survey = survey::LoadRefinedSurvey(pipeline.project.SurveyFolder());
  const std::filesystem::path folder = pipeline.project.ProductsFolder();
  SceneSession session(pipeline.comm, pipeline.project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
  const scene::Scene& scene = session.scene();
  base::ThreadPool& threads = session.threads();
  std::filesystem::create_directories(folder);
  if (options.ortho || options.dsm) {
    const std::unique_ptr<products::TileService> tiles = session.TileServiceFor(pipeline.project.SurveyFolder());
    const products::MapPhotos photos{survey, products::PictureMemory(pipeline.settings.run.MemoryLimitBytes()), threads, tiles.get()};
    const products::MapProducts made = products::MakeMapProducts(scene, options, folder, threads, from_photos ? &photos : nullptr);
    products::LogMaps(made, folder);
    if (made.painted) pipeline.rendering_s += made.painted->painting_s;
  }
  const scene::Appearance appearance = products::AppearanceOf(options.exposure, scene.info());
  if (kinds.elevations) {
    products::WriteElevationsOfWalls(scene.info(), survey, products::CasterOf(scene, appearance, threads), options, pipeline.settings.run.image_width,
                                     folder, true);
  }
  if (options.video_seconds > 0.0 && !image::CanWriteVideos()) {
    base::LogWarning(
        "no video was made: the program ffmpeg is not installed. Install it (Debian, Ubuntu: apt install ffmpeg), then: skyquilt render {} --video",
        pipeline.project.folder.string());
  } else if (options.video_seconds > 0.0) {
    const std::filesystem::path file = folder / (options.video_path + ".mp4");
    const std::vector<products::View> views =
        along_cameras ? products::PathAlongCameras(survey, options) : products::BuiltInPath(scene.info(), options);
    scene::Appearance for_people = appearance;
    for_people.plain_surround = options.plain_surround;
    const products::RenderStats stats = products::RenderVideo(products::RendererOf(scene, for_people, threads), views, options.video_fps, file);
    base::LogInfo("video of {} frames, {} rays/s: {}", stats.views, base::FormatCount(stats.RaysPerSecond()), file.string());
  }
  return StageStamp::kDone;
}

std::string EvaluateBody(Pipeline& pipeline, const StageStamp& stamp) {
  const Project& project = pipeline.project;
  SceneSession session(pipeline.comm, project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
  base::ThreadPool& threads = session.threads();
  const survey::Survey survey = survey::LoadRefinedSurvey(project.SurveyFolder());
  const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
  std::filesystem::create_directories(project.PixelCacheFile().parent_path());
  const image::PixelCache pixels =
      image::PixelCache::Open(project.PixelCacheFile(), PixelSources(survey), pipeline.settings.run.image_width, threads);
  const std::optional<scene::TrainReport> training = scene::TryReadTrainReport(project.TrainReport());
  const std::optional<trust::Trust> trust = TrustOfScene(project);
  const std::optional<evaluate::metrics::RunTimes> times = pipeline.timed ? std::optional(pipeline.timed->Times()) : std::nullopt;
  const evaluate::EvaluateInput input{.scene = &session.scene(),
                                      .survey = &survey,
                                      .blocks = &blocks,
                                      .pixels = &pixels,
                                      .project_folder = project.folder,
                                      .trust = trust ? &*trust : nullptr,
                                      .training = training ? &*training : nullptr,
                                      .config_text = pipeline.settings.Toml(),
                                      .vertical = geo::VerticalNamed(pipeline.settings.products.vertical),
                                      .options = pipeline.settings.evaluate,
                                      .progress_file = project.EvaluateProgressFile(),
                                      .progress_key = ScoresKey(pipeline, stamp),
                                      .times = times ? &*times : nullptr};
  pipeline.metrics = evaluate::Evaluate(input, threads);
  const evaluate::metrics::Metrics& metrics = pipeline.metrics;
  if (metrics.times && !metrics.times->scores_given_up.empty()) pipeline.timed->GaveUp("evaluate", "scores", metrics.times->scores_given_up);
  base::LogInfo(
      "{} held-out photos: PSNR {:.2f} dB, SSIM {:.3f}, FLIP {:.3f} over the {:.0f} % of pixels that are covered; PSNR of full frames {:.2f} dB",
      metrics.photos.size(), metrics.psnr, metrics.ssim, metrics.flip, 100.0 * metrics.coverage, metrics.psnr_full_frame);
  if (metrics.has_truth) {
    base::LogInfo("depth error against ground truth: median {:.2f} m, RMSE {:.2f} m", metrics.depth_median_abs_m, metrics.depth_rmse_m);
  }
  if (const evaluate::photos::KeptPointErrors& kept = metrics.kept_points; kept.rays > 0) {
    base::LogInfo("distance error against {} sparse points kept from training: median {:+.2f} GSD, NMAD {:.2f} GSD", kept.points, kept.median_gsd,
                  kept.nmad_gsd);
  }
  base::LogInfo("report: {}", (project.ReportFolder() / "index.html").string());
  return StageStamp::kDone;
}

}  // namespace skyquilt::coordinator
