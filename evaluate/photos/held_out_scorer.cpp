#include "evaluate/photos/held_out_scorer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/survey/view_kind.h"
#include "evaluate/photos/load_held_out_photo.h"
#include "evaluate/photos/resect_photo.h"
#include "evaluate/photos/training_depths.h"

namespace skyquilt::evaluate::photos {

namespace {

SceneArea AreaOf(const scene::SceneInfo& info, const survey::Survey& survey) {
  SceneArea area;
  for (const scene::SceneBlock& block : info.blocks) area.boxes.push_back({block.min_enu, block.max_enu, block.margin_m});
  if (area.boxes.empty()) area.boxes.push_back({info.min_enu, info.max_enu, 0.0});
  area.heights = {info.min_enu.z(), info.max_enu.z()};
  area.shading = FittedShading::Of(info.response);
  if (survey::LooksLevel(survey)) area.points = survey.points;
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

// Normals of rendered rays as an image; NaN where there is none.
image::ImageF NormalsOf(std::span<const render::RayColor> rendered, const image::Image8& size, const float (render::RayColor::*normal)[3]) {
  image::ImageF normals(size.width, size.height, 3, std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < rendered.size(); ++i) {
    const float(&n)[3] = rendered[i].*normal;
    if (n[0] != 0.0F || n[1] != 0.0F || n[2] != 0.0F) std::copy_n(n, 3, normals.data.data() + 3 * i);
  }
  return normals;
}

double LpipsOf(skyquilt::metrics::Lpips& network, const HeldOutPhoto& task, const image::Image8& render) {
  const image::Image8 used = task.UsedPixels();
  return network.Distance(image::ToImageF(render), image::ToImageF(task.photo), used.Empty() ? nullptr : &used);
}

}  // namespace

HeldOutScorer::HeldOutScorer(const EvaluateInput& input)
    : input_(input), area_(AreaOf(input.scene->info(), *input.survey)), training_(ViewsOf(input)), views_(training_) {
  if (input.options.field_normals && !input.scene->info().density_normals) {
    base::LogWarning(
        "The scene's encoding has no normals of the density, so they are not scored. evaluate.field_normals needs \"hash\" or \"voxels\"");
  }
  if (!input.options.lpips_network.empty()) lpips_.emplace(input.options.lpips_network);
}

HeldOutScorer::Recordings HeldOutScorer::RecordingsOf(int photo) const {
  const brightness::Response& response = input_.scene->info().response;
  const survey::Photo& taken = input_.survey->photos[static_cast<size_t>(photo)];
  Recordings recordings;
  recordings.gain = TaggedGain(taken, response.reference_exposure, input_.options.exif_gain);
  recordings.tagged = TaggedResponse(response, taken.camera, recordings.gain);
  recordings.predicted =
      input_.options.predicted_gain ? PredictedResponse(response, static_cast<size_t>(photo), recordings.tagged) : recordings.tagged;
  return recordings;
}

bool HeldOutScorer::LooksAreAlike() const {
  return !input_.scene->info().luminance.On() && input_.options.normal_stops == 0.0 && !input_.options.field_normals;
}

PhotoResult HeldOutScorer::ScoreRecorded(int photo, const HeldOutPhoto& task, base::ThreadPool& threads, std::vector<render::RayColor>* as_rendered,
                                         PhotoTrust* trust) const {
  const Recordings recordings = RecordingsOf(photo);
  const auto start = std::chrono::steady_clock::now();
  // A field whose encoding has no slope cannot be rendered with normals, not even with those of a head.
  const bool field_normals = input_.options.field_normals && input_.scene->info().density_normals && !task.true_normals.Empty();
  const scene::Appearance appearance{.look = scene::Rendition::kRecorded, .normals = field_normals};
  std::vector<render::RayColor> rendered = input_.scene->RenderCamera(task.camera, task.cam_from_enu, appearance, threads);
  const std::vector<render::RayColor> as_reference = recordings.Differ() ? rendered : std::vector<render::RayColor>();
  if (as_rendered != nullptr) *as_rendered = rendered;
  std::vector<skyquilt::trust::PixelFacts> facts;
  if (input_.trust != nullptr) facts = FactsOfPhoto(*input_.trust, task, input_.scene->info().scales.Cones(), rendered, threads);
  ApplyResponse(task.camera, recordings.predicted, rendered, threads);
  const double render_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  PhotoResult findings = ScorePhoto(task, rendered, unhidden_ ? *unhidden_ : views_, area_, threads);
  if (field_normals) findings.density_normals = NormalsOf(rendered, findings.scored, &render::RayColor::density_normal);
  if (field_normals && input_.scene->info().normal_head) {
    findings.head_normals = NormalsOf(rendered, findings.scored, &render::RayColor::predicted_normal);
  }
  if (input_.options.resect) ScoreResected(task, recordings.predicted, rendered, threads, &findings);
  if (input_.trust != nullptr) *trust = CompareTrust(*input_.trust, facts, task, rendered, findings.scored, threads);
  PhotoScore& score = findings.score;
  score.photo = photo;
  score.expected_psnr_db = trust->expected_psnr_db;
  score.name = input_.survey->photos[static_cast<size_t>(photo)].name;
  score.exposure_gain = recordings.gain;
  for (size_t c = 0; c < 3; ++c) {
    score.predicted_stops[c] = static_cast<double>(recordings.predicted.log_gain[c] - recordings.tagged.log_gain[c]) / std::numbers::ln2;
  }
  score.psnr_exif_gain_db = recordings.Differ() ? PsnrWithResponse(task, recordings.tagged, as_reference, findings.scored, threads) : score.psnr_db;
  score.render_seconds = render_seconds;
  return findings;
}

void HeldOutScorer::ScoreResected(const HeldOutPhoto& task, const PhotoResponse& recording, std::span<const render::RayColor> as_given,
                                  base::ThreadPool& threads, PhotoResult* findings) const {
  std::vector<double> depths;
  for (size_t i = 0; i < as_given.size(); ++i) {
    const auto depth = static_cast<double>(as_given[i].depth_median);
    if (findings->scored.data[i] != 0 && depth > 0.0 && std::isfinite(depth)) depths.push_back(depth);
  }
  if (depths.empty()) return;
  const PhotoRenderer render = [&](const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) {
    std::vector<render::RayColor> made = input_.scene->RenderCamera(camera, cam_from_enu, {.look = scene::Rendition::kRecorded}, threads);
    ApplyResponse(camera, recording, made, threads);
    return made;
  };
  const ResectedPhoto resected = ResectPhoto(task, findings->scored, as_given, base::Median(std::move(depths)), render);
  findings->score.psnr_posed_db = resected.given_db;
  findings->score.psnr_resected_db = resected.resected_db;
  findings->score.resected_px = resected.moved_px;
}

std::vector<render::RayColor> HeldOutScorer::RenderNormal(const HeldOutPhoto& task, base::ThreadPool& threads) const {
  scene::Appearance appearance;
  appearance.log_gain.fill(static_cast<float>(input_.options.normal_stops * std::numbers::ln2));
  return input_.scene->RenderCamera(task.camera, task.cam_from_enu, appearance, threads);
}

ScoredPhoto HeldOutScorer::Score(int photo, bool keep_normal, base::ThreadPool& threads) {
  if (!unhidden_ && survey::LooksLevel(*input_.survey)) unhidden_.emplace(WithDepths(training_, *input_.scene, threads));
  ScoredPhoto scored;
  scored.task = LoadHeldOutPhoto(*input_.survey, *input_.pixels, photo, input_.options.image_width);
  const std::filesystem::path normal_photos = input_.options.normal_photos;
  const bool shows_normal = keep_normal || !normal_photos.empty();
  scored.findings = ScoreRecorded(photo, scored.task, threads, shows_normal && LooksAreAlike() ? &scored.normal : nullptr, &scored.trust);
  scored.recording = RecordingsOf(photo).predicted;
  PhotoScore& score = scored.findings.score;
  if (lpips_) score.lpips = LpipsOf(*lpips_, scored.task, scored.findings.render);
  if (!scored.findings.true_depth.Empty()) scored.floaters = MeasureFloaterOpacity(*input_.scene, scored.task, scored.findings, threads);
  if (shows_normal && !LooksAreAlike()) scored.normal = RenderNormal(scored.task, threads);
  if (!normal_photos.empty()) {
    const NormalScore against = ScoreNormal(normal_photos / score.name, scored.normal, scored.findings.scored);
    score.psnr_normal_db = against.psnr_db;
    score.ssim_normal = against.ssim;
    score.psnr_normal_fitted_db = against.psnr_fitted_db;
  }
  return scored;
}

}  // namespace skyquilt::evaluate::photos
