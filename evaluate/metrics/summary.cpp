#include "evaluate/metrics/summary.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/system.h"
#include "evaluate/metrics/warnings.h"

namespace skyquilt::evaluate::metrics {

namespace {

double MeanOver(const std::vector<photos::PhotoScore>& photos, double photos::PhotoScore::*value) {
  std::vector<double> values;
  values.reserve(photos.size());
  for (const photos::PhotoScore& photo : photos) values.push_back(photo.*value);
  return MeanOfMeasured(values);
}

constexpr size_t kFewestBytesPerPhoto = 160;  // of its numbers; names may be short

// Calls visit with every member of a score. The list must be complete: this does not compile otherwise.
template <typename Score, typename Visit>
void VisitMembers(Score& score, Visit visit) {
  auto& [photo, name, width, height, used_pixels, covered_pixels, exposure_gain, predicted_stops, psnr_db, psnr_1000_db, expected_psnr_db,
         psnr_exif_gain_db, psnr_normal_db, ssim_normal, psnr_normal_fitted_db, ssim, flip, psnr_posed_db, psnr_resected_db, resected_px,
         psnr_full_db, ssim_full, flip_full, lpips, right_half_db, right_half_fitted_db, fitted_stops, tiles_db, tiles_gains_db, tiles_shading_db,
         depth_rmse_m, depth_median_abs_m, render_seconds] = score;
  visit(photo, name, width, height, used_pixels, covered_pixels, exposure_gain, predicted_stops, psnr_db, psnr_1000_db, expected_psnr_db,
        psnr_exif_gain_db, psnr_normal_db, ssim_normal, psnr_normal_fitted_db, ssim, flip, psnr_posed_db, psnr_resected_db, resected_px, psnr_full_db,
        ssim_full, flip_full, lpips, right_half_db, right_half_fitted_db, fitted_stops, tiles_db, tiles_gains_db, tiles_shading_db, depth_rmse_m,
        depth_median_abs_m, render_seconds);
}

void AddMeans(const Scores& scores, Metrics* metrics) {
  metrics->psnr = scores.Psnr();
  metrics->psnr_1000 = MeanOver(scores.photos, &photos::PhotoScore::psnr_1000_db);
  metrics->psnr_normal = MeanOver(scores.photos, &photos::PhotoScore::psnr_normal_db);
  metrics->ssim_normal = MeanOver(scores.photos, &photos::PhotoScore::ssim_normal);
  metrics->psnr_posed = MeanOver(scores.photos, &photos::PhotoScore::psnr_posed_db);
  metrics->psnr_resected = MeanOver(scores.photos, &photos::PhotoScore::psnr_resected_db);
  metrics->psnr_exif_gain = MeanOver(scores.photos, &photos::PhotoScore::psnr_exif_gain_db);
  metrics->ssim = MeanOver(scores.photos, &photos::PhotoScore::ssim);
  metrics->flip = MeanOver(scores.photos, &photos::PhotoScore::flip);
  metrics->psnr_full_frame = MeanOver(scores.photos, &photos::PhotoScore::psnr_full_db);
  metrics->ssim_full_frame = MeanOver(scores.photos, &photos::PhotoScore::ssim_full);
  metrics->flip_full_frame = MeanOver(scores.photos, &photos::PhotoScore::flip_full);
  metrics->psnr_right_half = MeanOver(scores.photos, &photos::PhotoScore::right_half_db);
  metrics->psnr_right_half_fitted = MeanOver(scores.photos, &photos::PhotoScore::right_half_fitted_db);
  metrics->psnr_tiles = MeanOver(scores.photos, &photos::PhotoScore::tiles_db);
  metrics->psnr_tiles_gains = MeanOver(scores.photos, &photos::PhotoScore::tiles_gains_db);
  metrics->psnr_tiles_shading = MeanOver(scores.photos, &photos::PhotoScore::tiles_shading_db);
  metrics->psnr_normal_fitted = MeanOver(scores.photos, &photos::PhotoScore::psnr_normal_fitted_db);
  metrics->lpips = MeanOver(scores.photos, &photos::PhotoScore::lpips);
  metrics->coverage = scores.Coverage();
}

void AddPooled(const scene::SceneInfo& info, const Scores& scores, Metrics* metrics) {
  for (size_t b = 0; b < info.blocks.size(); ++b) {
    metrics->blocks.push_back({info.blocks[b].name, skyquilt::metrics::PsnrOf(scores.per_block[b]), photos::PixelsOf(scores.per_block[b])});
  }
  metrics->psnr_interior_db = skyquilt::metrics::PsnrOf(scores.seams.AllInterior());
  metrics->psnr_matched_interior_db = scores.seams.MatchedInteriorDb();
  metrics->psnr_seam_db = skyquilt::metrics::PsnrOf(scores.seams.AllSeam());
  metrics->seam_psnr_gap_db = scores.seams.GapDb();
  metrics->trust = trust::ScoreTrust(scores.trust);
  metrics->exposure_seam = scores.exposure_seams.border;
  metrics->exposure_seam_control = scores.exposure_seams.control;
  if (!metrics->has_truth) return;
  const skyquilt::metrics::DepthErrors errors = scores.depth.Result();
  metrics->depth_rmse_m = errors.rmse_m;
  metrics->depth_median_abs_m = errors.median_abs_m;
  metrics->classes = scores.classes.Result();
  const photos::FlatRoofScore roofs = scores.flat_roofs.Result();
  metrics->flat_roofs = roofs.roofs;
  metrics->flat_roof_rms_m = roofs.spread.rms_m;
  metrics->flat_roof_nmad_m = roofs.spread.nmad_m;
  metrics->floater_opacity = scores.floaters.Mean();
  metrics->floater_profile = scores.floaters.Profile();
}

void AddSurveyFacts(const survey::Survey& survey, Metrics* metrics) {
  metrics->has_truth = survey.truth.has_value() && survey.georeferenced;
  metrics->georeferenced = survey.georeferenced;
  metrics->geo_fit = survey.fit;
  metrics->control = survey.control;
  for (const survey::Problem& problem : survey.problems) metrics->problem_codes.push_back(problem.code);
  metrics->median_agl_m = survey.MedianAgl();
  std::vector<double> relative;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.relative_altitude_m) relative.push_back(*photo.relative_altitude_m);
  }
  metrics->median_relative_altitude_m = MedianOfMeasured(std::move(relative));
  metrics->n_photos = static_cast<int>(survey.photos.size());
  metrics->n_unregistered = static_cast<int>(survey.unregistered.size());
  metrics->n_test = static_cast<int>(std::count_if(survey.photos.begin(), survey.photos.end(), [](const auto& photo) { return photo.is_test; }));
  metrics->resected_holdout = survey.resected_holdout;
}

// Two networks may be called the same.
std::string LpipsNote(const std::filesystem::path& network) {
  if (network.empty()) return "not measured: evaluate.lpips_network is not set";
  return "full frame, network " + network.filename().string() + ", SHA-256 " + base::Sha256Hex(base::ReadFile(network));
}

}  // namespace

void Scores::Add(const photos::ScoredPhoto& photo) {
  const photos::PhotoResult& findings = photo.findings;
  photos.push_back(findings.score);
  for (size_t b = 0; b < per_block.size(); ++b) per_block[b] += findings.per_block[b];
  seams += findings.seams;
  if (!findings.true_depth.Empty()) depth.Add(findings.z_depth, findings.true_depth, &findings.scored);
  classes.Add(photo.task, findings);
  flat_roofs.Add(photo.task, findings);
  floaters += photo.floaters;
  trust.Add(photo.trust.sample);
}

void Scores::Save(base::BytePacker* out) const {
  out->AddCount(photos.size());
  for (const photos::PhotoScore& photo : photos) {
    VisitMembers(photo, [out](const auto&... member) { (out->Add(member), ...); });
  }
  out->Add(per_block);
  out->Add(seams);
  depth.Save(out);
  classes.Save(out);
  flat_roofs.Save(out);
  out->Add(floaters);
  trust.Save(out);
}

void Scores::Load(base::ByteUnpacker* in) {
  const size_t n_boxes = per_block.size();
  photos.resize(in->TakeCount(kFewestBytesPerPhoto));
  for (photos::PhotoScore& photo : photos) {
    VisitMembers(photo, [in](auto&... member) { (in->Take(&member), ...); });
  }
  in->Take(&per_block);
  if (per_block.size() != n_boxes) in->Fail();
  in->Take(&seams);
  depth.Load(in);
  classes.Load(in);
  flat_roofs.Load(in);
  in->Take(&floaters);
  trust.Load(in);
}

double Scores::Psnr() const {
  return MeanOver(photos, &photos::PhotoScore::psnr_db);
}

double Scores::Coverage() const {
  int64_t used = 0, covered = 0;
  for (const photos::PhotoScore& photo : photos) {
    used += photo.used_pixels;
    covered += photo.covered_pixels;
  }
  return used > 0 ? static_cast<double>(covered) / static_cast<double>(used) : kNotMeasured;
}

Metrics MetricsBeforeScoring(const EvaluateInput& input) {
  const scene::SceneInfo& info = input.scene->info();
  const std::filesystem::path network = input.options.lpips_network;
  Metrics metrics;
  AddSurveyFacts(*input.survey, &metrics);
  if (input.training != nullptr) {
    metrics.train_seconds = input.training->TrainSeconds();
    metrics.samples_per_second = input.training->SamplesPerSecond();
    metrics.peak_rss_bytes = input.training->PeakRssBytes();
    metrics.ranks = std::max(input.training->ranks, 1);
    metrics.threads = input.training->threads;
  }
  metrics.parameters = info.parameters;
  metrics.config = input.config_text.empty() ? info.config : input.config_text;
  metrics.gsd_m = info.gsd_m > 0.0 ? info.gsd_m : kNotMeasured;
  metrics.lpips_note = LpipsNote(network);
  metrics.machine = base::MachineDescription();
  metrics.date = base::UtcTimestamp();
  return metrics;
}

void Summarise(const EvaluateInput& input, const Scores& scores, Metrics* metrics) {
  metrics->photos = scores.photos;
  metrics->image_width = scores.photos.empty() ? 0 : scores.photos.front().width;
  AddMeans(scores, metrics);
  AddPooled(input.scene->info(), scores, metrics);
  metrics->rendering = input.scene->statistics();
  metrics->evaluate_peak_rss_bytes = base::PeakRssBytes();
  metrics->warnings = CollectWarnings(*input.survey, *input.blocks, input.training, *metrics);
}

}  // namespace skyquilt::evaluate::metrics
