#include "evaluate/surface/surface_scorer.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/log.h"
#include "evaluate/surface/decks.h"
#include "evaluate/surface/f_score.h"
#include "evaluate/surface/surface_json.h"

namespace skyquilt::evaluate::surface {
namespace {

void AddScoresInSpace(const EvaluateInput& input, const SurfaceMesh& mesh, const raytrace::TracedScene& traced, const photos::HeldOutScorer& scorer,
                      base::ThreadPool& threads, SurfaceScores* scores) {
  const survey::Survey& survey = *input.survey;
  std::error_code ignored;
  // A local frame has no metres and no north to compare with.
  if (!survey.truth || !survey.georeferenced || !std::filesystem::is_regular_file(survey.truth->surface_ply, ignored)) return;
  base::LogInfo("the mesh is compared with the true surface");
  const TrueSurface truth = ReadTrueSurface(survey.truth->surface_ply, survey.origin);
  const std::vector<geo::BlockBox>& boxes = scorer.area().boxes;
  const SeenSurface seen(truth, scorer.training(), scorer.views(), boxes);
  const SurfacePair pair{mesh, truth, seen, boxes, input.scene->info().gsd_m};
  const std::vector<SurfaceSample> samples = SampleMesh(pair);

  SurfaceComparison comparison = CompareSurfaces(pair, samples, threads);
  scores->agreement = std::move(comparison.all);
  const std::vector<ScoredClass> classes = ScoredClasses();
  if (scores->classes.empty()) {
    for (const ScoredClass& one : classes) scores->classes.emplace_back().name = one.name;
  }
  for (size_t i = 0; i < classes.size(); ++i) scores->classes[i].agreement = std::move(comparison.by_class[i]);

  if (!(pair.gsd_m > 0.0) || !std::filesystem::is_regular_file(survey.truth->buildings_json, ignored)) return;
  const std::vector<photos::RoofArea> roofs = photos::ReadFlatRoofs(survey.truth->buildings_json);
  const DeckScore decks = ScoreDecks(mesh, samples, truth, traced, seen.traced(), roofs, 2.0 * pair.gsd_m, threads);
  scores->deck_samples = decks.samples;
  scores->decks_within_2_gsd = decks.share_within;
}

}  // namespace

SurfaceScorer::SurfaceScorer(SurfaceMesh mesh) : mesh_(std::move(mesh)), painter_(mesh_) {}

image::Image8 SurfaceScorer::Score(const photos::ScoredPhoto& photo, base::ThreadPool& threads) {
  SurfacePicture picture = painter_.Paint(photo.task.camera, photo.task.cam_from_enu, threads);
  photos::ApplyResponse(photo.task.camera, photo.recording, picture.colors, threads);
  return photos_.Add(photo.task, photo.findings, picture);
}

SurfaceScores SurfaceScorer::Result(const EvaluateInput& input, const photos::HeldOutScorer& scorer, base::ThreadPool& threads) const {
  SurfaceScores scores;
  photos_.Fill(&scores);
  scores.record = ReadSurfaceRecord(input.project_folder / "surface" / "surface.json");
  if (scores.record.triangles < 0) scores.record.triangles = static_cast<int64_t>(mesh_.triangle.size());
  AddScoresInSpace(input, mesh_, painter_.traced(), scorer, threads, &scores);
  return scores;
}

}  // namespace skyquilt::evaluate::surface
