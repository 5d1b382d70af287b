#include "evaluate/evaluate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/system.h"
#include "core/metrics/depth_errors.h"
#include "core/metrics/lpips.h"
#include "core/metrics/psnr.h"
#include "core/scene/scene.h"
#include "evaluate/air_opacity.h"
#include "evaluate/brightness_report.h"
#include "evaluate/footprint_steps.h"
#include "evaluate/load_task.h"
#include "evaluate/photo_recording.h"
#include "evaluate/photo_scorer.h"
#include "evaluate/report_images.h"
#include "evaluate/report_page.h"
#include "evaluate/train_log.h"
#include "evaluate/warnings.h"

namespace skyquilt::evaluate {

namespace {

constexpr float kErrorHigh = 0.25F;  // display values at the top of the error colours

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// `count` of the entries, evenly spread; all when count is 0 or enough.
std::vector<int> EvenlySpread(const std::vector<int>& entries, int count) {
  const size_t n = entries.size();
  if (count <= 0 || static_cast<size_t>(count) >= n) return entries;
  std::vector<int> chosen;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i) chosen.push_back(entries[(2 * i + 1) * n / (2 * static_cast<size_t>(count))]);
  return chosen;
}

SceneArea AreaOf(const scene::SceneInfo& info) {
  SceneArea area;
  for (const scene::SceneBlock& block : info.blocks) area.boxes.push_back({block.min_enu, block.max_enu, block.margin_m});
  if (area.boxes.empty()) area.boxes.push_back({info.min_enu, info.max_enu, 0.0});
  area.heights = {info.min_enu.z(), info.max_enu.z()};
  return area;
}

std::vector<TrainingView> ViewsOf(const EvaluateInput& input) {
  std::vector<TrainingView> views;
  for (size_t i = 0; i < input.survey->photos.size(); ++i) {
    const survey::Photo& photo = input.survey->photos[i];
    if (photo.is_test) continue;
    const camera::Camera& camera = input.survey->cameras[static_cast<size_t>(photo.camera)];
    views.push_back({camera.Resized(input.pixels->Width(i), input.pixels->Height(i)), photo.cam_from_enu, input.pixels->Mask(i)});
  }
  return views;
}

double LpipsOf(metrics::Lpips& network, const PhotoTask& task, const image::Image8& render) {
  image::Image8 used;
  if (!task.mask.empty()) {
    used = image::Image8(task.photo.width, task.photo.height, 1);
    used.data = task.mask;
  }
  return network.Distance(image::ToImageF(render), image::ToImageF(task.photo), used.Empty() ? nullptr : &used);
}

void FillSurveyFacts(const EvaluateInput& input, const scene::SceneInfo& info, const TrainLog& log, Metrics* metrics) {
  const survey::Survey& survey = *input.survey;
  metrics->has_truth = survey.truth.has_value();
  metrics->train_seconds = log.TrainSeconds();
  metrics->samples_per_second = log.SamplesPerSecond();
  metrics->peak_rss_bytes = log.peak_rss_bytes;
  metrics->parameters = info.parameters;
  metrics->ranks = input.ranks > 0 ? input.ranks : std::max(log.ranks, 1);
  metrics->threads = log.threads;
  metrics->config = input.config_text.empty() ? info.config : input.config_text;
  metrics->georeferenced = survey.georeferenced;
  metrics->geo_fit = survey.fit;
  metrics->median_agl_m = survey.MedianAgl();
  std::vector<double> relative;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.relative_altitude_m) relative.push_back(*photo.relative_altitude_m);
  }
  metrics->median_relative_altitude_m = MedianOfMeasured(std::move(relative));
  metrics->gsd_m = info.gsd_m > 0.0 ? info.gsd_m : kNotMeasured;
  metrics->n_photos = static_cast<int>(survey.photos.size());
  metrics->n_unregistered = static_cast<int>(survey.unregistered.size());
  metrics->n_test = static_cast<int>(std::count_if(survey.photos.begin(), survey.photos.end(), [](const auto& photo) { return photo.is_test; }));
  metrics->machine = base::MachineDescription();
  metrics->date = base::UtcTimestamp();
}

// Pictures of an earlier evaluation with other options would only take room.
void RemoveStalePictures(const std::filesystem::path& report_folder, const std::vector<PhotoImages>& images) {
  std::set<std::string> kept;
  for (const PhotoImages& one : images) kept.insert({one.photo, one.render, one.error, one.depth});
  std::vector<std::filesystem::path> stale;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(report_folder / "images", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("photo_") && !kept.contains("images/" + name)) stale.push_back(entry.path());
  }
  for (const std::filesystem::path& file : stale) std::filesystem::remove(file, ignored);
}

// Sums over the photos that the means over photos cannot give.
struct Pools {
  std::vector<metrics::SquaredError> per_block;
  SeamErrors seams;
  metrics::DepthErrorCollector depth;
  AirOpacity air;
};

void FillMeans(const scene::SceneInfo& info, const Pools& pools, Metrics* metrics) {
  std::vector<double> psnr, psnr_exif_gain, psnr_normal, ssim_normal, ssim, psnr_full, ssim_full, right, right_fitted, lpips;
  int64_t used = 0, covered = 0;
  for (const PhotoScore& score : metrics->photos) {
    psnr.push_back(score.psnr_db);
    psnr_exif_gain.push_back(score.psnr_exif_gain_db);
    psnr_normal.push_back(score.psnr_normal_db);
    ssim_normal.push_back(score.ssim_normal);
    ssim.push_back(score.ssim);
    psnr_full.push_back(score.psnr_full_db);
    ssim_full.push_back(score.ssim_full);
    right.push_back(score.right_half_db);
    right_fitted.push_back(score.right_half_fitted_db);
    lpips.push_back(score.lpips);
    used += score.used_pixels;
    covered += score.covered_pixels;
  }
  metrics->psnr = MeanOfMeasured(psnr);
  metrics->psnr_normal = MeanOfMeasured(psnr_normal);
  metrics->ssim_normal = MeanOfMeasured(ssim_normal);
  metrics->psnr_exif_gain = MeanOfMeasured(psnr_exif_gain);
  metrics->ssim = MeanOfMeasured(ssim);
  metrics->psnr_full_frame = MeanOfMeasured(psnr_full);
  metrics->ssim_full_frame = MeanOfMeasured(ssim_full);
  metrics->psnr_right_half = MeanOfMeasured(right);
  metrics->psnr_right_half_fitted = MeanOfMeasured(right_fitted);
  metrics->lpips = MeanOfMeasured(lpips);
  metrics->coverage = used > 0 ? static_cast<double>(covered) / static_cast<double>(used) : kNotMeasured;
  for (size_t b = 0; b < info.blocks.size(); ++b) {
    metrics->blocks.push_back({info.blocks[b].name, metrics::PsnrOf(pools.per_block[b]), PixelsOf(pools.per_block[b])});
  }
  metrics->psnr_interior_db = metrics::PsnrOf(pools.seams.AllInterior());
  metrics->psnr_matched_interior_db = pools.seams.MatchedInteriorDb();
  metrics->psnr_seam_db = metrics::PsnrOf(pools.seams.AllSeam());
  metrics->seam_psnr_gap_db = pools.seams.GapDb();
  if (metrics->has_truth) {
    const metrics::DepthErrors errors = pools.depth.Result();
    metrics->depth_rmse_m = errors.rmse_m;
    metrics->depth_median_abs_m = errors.median_abs_m;
    metrics->air_opacity = pools.air.Mean();
    metrics->air_profile = pools.air.Profile();
  }
}

}  // namespace

void EvaluateOptions::Visit(config::OptionVisitor& v) {
  v.Field("image_width", image_width, "width in pixels at which held-out photos are scored; 0: the training width");
  v.Field("lpips_network", lpips_network, "ONNX file of an LPIPS network; empty: LPIPS is not measured");
  v.Field("max_photos", max_photos, "score at most so many held-out photos, evenly spread; 0: all");
  v.Field("exif_gain", exif_gain, "render each held-out photo at the exposure its EXIF states");
  v.Field("predicted_gain", predicted_gain, "and with what the photos taken before and after it needed beside theirs, where gains were learned");
  v.Field("normal_photos", normal_photos,
          "folder of the same photos, normally exposed: what is shown at normal brightness is scored against them too; empty: none");
  v.Field("normal_stops", normal_stops, "stops by which normal brightness is raised for that, -10..10");
  v.Field("report_photos", report_photos, "held-out photos with pictures in the report, evenly spread; all are in its tables");
  v.Field("report_image_width", report_image_width, "largest width in pixels of the report's pictures");
}

Metrics Evaluate(const EvaluateInput& input, base::ThreadPool& threads) {
  SKYQUILT_CHECK(input.scene != nullptr && input.survey != nullptr && input.blocks != nullptr && input.pixels != nullptr,
                 "scene, survey, blocks and pixels");
  SKYQUILT_CHECK(input.pixels->size() == input.survey->photos.size(), "one cached photo per photo of the survey");
  const EvaluateOptions& options = input.options;
  if (options.image_width < 0 || options.max_photos < 0 || options.report_photos < 0 || options.report_image_width < 16 ||
      !(std::abs(options.normal_stops) <= 10.0)) {
    throw base::UsageError(
        "evaluate: image_width, max_photos and report_photos must not be negative, report_image_width at least 16, normal_stops from -10 to 10");
  }
  const auto start = std::chrono::steady_clock::now();
  const std::filesystem::path report_folder = input.project_folder / "report";
  base::RequireWritableFolder(report_folder / "images");
  const std::filesystem::path checkpoints = input.project_folder / "checkpoints";
  const TrainLog log = ReadTrainLog(input.train_json.empty() ? input.project_folder / "train.json" : input.train_json, checkpoints);
  const scene::Scene& scene = *input.scene;
  const scene::SceneInfo& info = scene.info();
  const SceneArea area = AreaOf(info);
  const std::vector<TrainingView> training = ViewsOf(input);
  const TrainingViews views(training);
  std::optional<metrics::Lpips> lpips;
  if (!options.lpips_network.empty()) lpips.emplace(options.lpips_network);

  Metrics metrics;
  FillSurveyFacts(input, info, log, &metrics);
  metrics.lpips_note =
      lpips ? "full frame, network " + std::filesystem::path(options.lpips_network).filename().string() : "not measured: no network file was given";
  std::vector<int> held_out;
  for (size_t i = 0; i < input.survey->photos.size(); ++i) {
    if (input.survey->photos[i].is_test) held_out.push_back(static_cast<int>(i));
  }
  held_out = EvenlySpread(held_out, options.max_photos);
  const std::vector<int> pictured = options.report_photos == 0 ? std::vector<int>() : EvenlySpread(held_out, options.report_photos);

  BrightnessReport brightness = CollectBrightness(info, *input.survey, *input.pixels);
  const std::vector<int> contrasted = options.report_photos == 0 ? std::vector<int>() : ChooseViews(info, *input.survey, held_out);
  brightness.views.resize(contrasted.size());

  Pools pools;
  pools.per_block.resize(area.boxes.size());
  std::vector<PhotoImages> images;
  base::Progress progress("evaluate", static_cast<double>(held_out.size()), "photos");
  for (const int index : held_out) {
    base::ThrowIfCancelled();
    const survey::Photo& photo = input.survey->photos[static_cast<size_t>(index)];
    const PhotoTask task = LoadTask(*input.survey, *input.pixels, index, options.image_width);
    const double gain = TaggedGain(photo, info.response.reference_exposure, options.exif_gain);
    const auto render_start = std::chrono::steady_clock::now();
    std::vector<render::RayColor> rendered = scene.RenderCamera(task.camera, task.cam_from_enu, {scene::Look::kRecorded, {}}, threads);
    const Recording tagged = TaggedRecording(info.response, photo.camera, gain);
    const Recording predicted = options.predicted_gain ? PredictedRecording(info.response, static_cast<size_t>(index), tagged) : tagged;
    const bool differs = predicted.log_gain != tagged.log_gain;
    const std::vector<render::RayColor> as_reference = differs ? rendered : std::vector<render::RayColor>();
    Record(task.camera, predicted, rendered, threads);
    const double render_seconds = SecondsSince(render_start);
    PhotoFindings findings = ScorePhoto(task, rendered, views, area, threads);
    PhotoScore& score = findings.score;
    score.photo = index;
    score.name = photo.name;
    score.exposure_gain = gain;
    for (size_t c = 0; c < 3; ++c) score.predicted_stops[c] = static_cast<double>(predicted.log_gain[c] - tagged.log_gain[c]) / std::numbers::ln2;
    score.psnr_exif_gain_db = differs ? PsnrRecorded(task, tagged, as_reference, findings.scored, threads) : score.psnr_db;
    score.render_seconds = render_seconds;
    if (lpips) score.lpips = LpipsOf(*lpips, task, findings.render);
    for (size_t b = 0; b < pools.per_block.size(); ++b) pools.per_block[b] += findings.per_block[b];
    pools.seams += findings.seams;
    if (!findings.true_depth.Empty()) {
      pools.depth.Add(findings.z_depth, findings.true_depth, &findings.scored);
      pools.air += MeasureAirOpacity(scene, task, findings, threads);
    }
    images.emplace_back();
    if (std::find(pictured.begin(), pictured.end(), index) != pictured.end()) {
      images.back() = WritePhotoImages({&task.photo, &findings.render, &findings.z_depth, findings.scored.data}, report_folder,
                                       fmt::format("photo_{:05d}", index), options.report_image_width, kErrorHigh);
    }
    const auto place = std::find(contrasted.begin(), contrasted.end(), index);
    if (place != contrasted.end() || !options.normal_photos.empty()) {
      scene::Appearance appearance;
      appearance.log_gain.fill(static_cast<float>(options.normal_stops * std::numbers::ln2));
      const std::vector<render::RayColor> normal = scene.RenderCamera(task.camera, task.cam_from_enu, appearance, threads);
      if (place != contrasted.end()) {
        const auto nth = static_cast<size_t>(place - contrasted.begin());
        BrightnessView& view = brightness.views[nth];
        view = WriteBrightnessView(task.photo, findings.render, PictureOf(normal, task.camera.width, task.camera.height), report_folder,
                                   fmt::format("brightness_{}", nth), options.report_image_width);
        view.name = photo.name;
        view.stops = ExposureStops(info.response, static_cast<size_t>(index));
      }
      if (!options.normal_photos.empty()) {
        const NormalScore against = ScoreNormal(std::filesystem::path(options.normal_photos) / photo.name, normal, findings.scored);
        score.psnr_normal_db = against.psnr_db;
        score.ssim_normal = against.ssim;
      }
    }
    if (metrics.image_width == 0) metrics.image_width = score.width;
    metrics.photos.push_back(score);
    progress.Advance(1.0, fmt::format("{} {:.2f} dB", photo.name, score.psnr_db));
  }
  FillMeans(info, pools, &metrics);
  const FootprintSteps steps = MeasureFootprintSteps(scene, training, threads);
  metrics.footprint_step = steps.border;
  metrics.footprint_step_control = steps.control;
  progress.Finish(fmt::format("PSNR {:.2f} dB, coverage {:.1f} %", metrics.psnr, 100.0 * metrics.coverage));
  metrics.evaluate_seconds = SecondsSince(start);
  metrics.rendering = scene.statistics();
  metrics.evaluate_peak_rss_bytes = base::PeakRssBytes();
  metrics.warnings = CollectWarnings(*input.survey, *input.blocks, log, metrics);
  for (const std::string& warning : metrics.warnings) spdlog::warn("{}", warning);

  ReportInput page;
  page.title = std::filesystem::absolute(input.project_folder).lexically_normal().filename().string();
  if (page.title.empty()) page.title = std::filesystem::absolute(input.project_folder).lexically_normal().parent_path().filename().string();
  page.metrics = &metrics;
  page.survey = input.survey;
  page.blocks = input.blocks;
  page.log = &log;
  page.brightness = &brightness;
  page.images = std::move(images);
  page.background = CopyMapBackground(input.project_folder / "products", report_folder);
  page.color_ramp = WriteColorRamp(report_folder);
  page.error_high = static_cast<double>(kErrorHigh);
  base::WriteFileAtomically(report_folder / "index.html", BuildReportPage(page));
  if (!brightness.Empty()) base::WriteFileAtomically(report_folder / "brightness.json", BrightnessJson(brightness));
  RemoveStalePictures(report_folder, page.images);
  // Last, because its presence says that the evaluation is complete.
  base::WriteFileAtomically(report_folder / "metrics.json", MetricsJson(metrics));
  return metrics;
}

}  // namespace skyquilt::evaluate
