#include "evaluate/evaluate.h"

#include <fmt/core.h>

#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "evaluate/buildings/buildings_report.h"
#include "evaluate/control/control_pictures.h"
#include "evaluate/metrics/summary.h"
#include "evaluate/ortho/ortho_scorer.h"
#include "evaluate/page/report_writer.h"
#include "evaluate/photos/choose_photos.h"
#include "evaluate/photos/held_out_scorer.h"
#include "evaluate/photos/kept_points.h"
#include "evaluate/photos/scored_pixels.h"
#include "evaluate/score_saver.h"
#include "evaluate/surface/surface_scorer.h"
#include "surface/make_surface.h"

namespace skyquilt::evaluate {

namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void CheckInput(const EvaluateInput& input) {
  SKYQUILT_CHECK(input.scene != nullptr && input.survey != nullptr && input.blocks != nullptr && input.pixels != nullptr,
                 "scene, survey, blocks and pixels must be set");
  SKYQUILT_CHECK(input.pixels->size() == input.survey->photos.size(), "the pixel cache must have one entry per photo of the survey");
  input.options.Check();
}

// Where to look for flat roofs; none without a truth that says so.
std::vector<photos::RoofArea> FlatRoofsOf(const survey::Survey& survey) {
  if (!survey.truth || !survey.georeferenced || !std::filesystem::is_regular_file(survey.truth->buildings_json)) return {};
  return photos::ReadFlatRoofs(survey.truth->buildings_json);
}

// Nothing when no surface was made, or it is not finished.
std::unique_ptr<surface::SurfaceScorer> SurfaceOf(const EvaluateInput& input) {
  if (!std::filesystem::is_regular_file(input.project_folder / "surface" / "surface.json")) return nullptr;
  try {
    const std::vector<std::filesystem::path> tiles = skyquilt::surface::FinestTileFiles(input.project_folder / "cache" / "surface");
    return tiles.empty() ? nullptr : std::make_unique<surface::SurfaceScorer>(surface::SurfaceMesh::FromFiles(tiles));
  } catch (const base::InputError& error) {
    throw base::InputError(error.file(), "is damaged, or cannot be read", "Run 'skyquilt surface' again with --restart");
  }
}

metrics::Scores NoScores(const EvaluateInput& input, const photos::HeldOutScorer& scorer) {
  metrics::Scores scores(scorer.n_boxes());
  scores.flat_roofs = photos::FlatRoofPoints(FlatRoofsOf(*input.survey));
  return scores;
}

// What takes part in the scoring of the photos.
struct PhotoLoop {
  const EvaluateInput& input;
  Clock::time_point start;  // of the evaluation
  photos::HeldOutScorer& scorer;
  surface::SurfaceScorer* made;  // null without a surface
  page::ReportPictures& pictures;
  ScoreSaver& saver;
  metrics::Scores& scores;
};

void ScoreAndAdd(const PhotoLoop& loop, int photo, base::ThreadPool& threads) {
  photos::ScoredPhoto scored = loop.scorer.Score(photo, loop.pictures.ShowsNormal(photo), threads);
  if (loop.made != nullptr) scored.mesh = loop.made->Score(scored, threads);
  loop.pictures.Write(scored);
  const std::filesystem::path& pixels_folder = loop.input.options.scored_pixels_folder;
  if (!pixels_folder.empty()) photos::WriteScoredPixels(scored, pixels_folder);
  loop.scores.Add(scored);
}

// Whether there is time for one more photo, where there is a total time.
bool HasTime(const PhotoLoop& loop, size_t scored_here) {
  const metrics::RunTimes* times = loop.input.times;
  return times == nullptr || metrics::HasTimeToScore(*times, loop.scores.photos.size(), scored_here, SecondsSince(loop.start));
}

// Goes on after the photos that an earlier evaluation has scored.
void ScorePhotos(const PhotoLoop& loop, const std::vector<int>& held_out, base::ThreadPool& threads) {
  loop.saver.Resume();
  const std::vector<photos::PhotoScore>& photos = loop.scores.photos;
  const size_t earlier = photos.size();
  base::Progress progress("evaluate", static_cast<double>(held_out.size()), "photos", static_cast<double>(photos.size()));
  try {
    while (photos.size() < held_out.size() && HasTime(loop, photos.size() - earlier)) {
      base::ThrowIfCancelled();
      ScoreAndAdd(loop, held_out[photos.size()], threads);
      loop.saver.SaveWhenDue();
      progress.Advance(1.0, fmt::format("{} {:.2f} dB", photos.back().name, photos.back().psnr_db));
    }
    loop.scores.exposure_seams = photos::MeasureExposureSeams(*loop.input.scene, loop.scorer.training(), threads);
  } catch (const base::Interrupted&) {
    // Thrown while a photo is rendered, before anything of it is added.
    loop.saver.Save();
    throw;
  }
  progress.Finish(fmt::format("PSNR {:.2f} dB, coverage {:.1f} %", loop.scores.Psnr(), 100.0 * loop.scores.Coverage()));
}

// The times up to this stage, and of this one (here_s: without what earlier runs did) up to the writing of the report, which takes seconds.
metrics::RunTimes WithEvaluation(metrics::RunTimes times, double seconds, double here_s) {
  for (metrics::StageTimes& stage : times.stages) {
    if (stage.stage == "evaluate") stage.took_s = seconds;
  }
  times.used_s += here_s;
  return times;
}

}  // namespace

metrics::Metrics Evaluate(const EvaluateInput& input, base::ThreadPool& threads) {
  CheckInput(input);
  const Clock::time_point start = Clock::now();
  base::RequireWritableFolder(input.ReportFolder() / "images");
  metrics::Metrics metrics = metrics::MetricsBeforeScoring(input);

  std::vector<int> held_out = photos::SelectEvenly(photos::HeldOutPhotos(*input.survey), input.options.max_photos);
  if (input.times != nullptr) held_out = photos::SpreadOrder(held_out);
  photos::HeldOutScorer scorer(input);
  page::ReportPictures pictures(input, held_out);
  const std::unique_ptr<surface::SurfaceScorer> made = SurfaceOf(input);
  std::optional<buildings::BuildingsReport> found = buildings::CollectBuildings(input);
  metrics::Scores scores = NoScores(input, scorer);
  ScoreSaver saver(input, held_out, {.scores = &scores, .surface = made ? &made->photos() : nullptr, .pictures = &pictures.written()});
  ScorePhotos({input, start, scorer, made.get(), pictures, saver, scores}, held_out, threads);
  if (made) metrics.surface = made->Result(input, scorer, threads);
  if (found) metrics.buildings = buildings::ScoreBuildings(found->compared, threads);
  std::optional<ortho::OrthoResult> map = ortho::ScoreOrtho(input.project_folder / "products", *input.survey, input.scene->info(), threads);
  if (map) metrics.ortho = map->scores;
  metrics.kept_points = photos::MeasureKeptPoints(*input.scene, *input.survey, *input.pixels, scorer.area().boxes, threads);
  const double here_s = SecondsSince(start);
  metrics.evaluate_seconds = saver.earlier_s() + here_s;

  if (input.times != nullptr) {
    metrics.times = WithEvaluation(*input.times, metrics.evaluate_seconds, here_s);
    if (scores.photos.size() < held_out.size()) {
      metrics.times->scores_given_up = fmt::format("{} of {} held-out photos are scored", scores.photos.size(), held_out.size());
      metrics.times->given_up.push_back(metrics.times->scores_given_up);
      base::LogWarning("for {} in all: {}", base::FormatDuration(metrics.times->within_s), metrics.times->scores_given_up);
    }
  }
  metrics::Summarise(input, scores, &metrics);
  for (const metrics::Warning& warning : metrics.warnings) base::LogWarning("{}. {}", warning.finding, warning.advice);
  std::vector<control::MarkPicture> marks;
  if (input.options.report_photos > 0) marks = control::WriteMarkPictures(*input.survey, input.scene, input.ReportFolder(), threads);
  page::WriteReport(input, metrics, pictures, std::move(marks), found ? &*found : nullptr,
                    map ? std::move(map->crops) : std::vector<ortho::OrthoCrop>{});
  saver.Remove();
  return metrics;
}

}  // namespace skyquilt::evaluate
