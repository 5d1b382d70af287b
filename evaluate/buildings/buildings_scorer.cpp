#include "evaluate/buildings/buildings_scorer.h"

#include <cmath>
#include <vector>

#include "buildings/files/building_files.h"
#include "buildings/solids/build_solids.h"
#include "core/base/cancel.h"
#include "evaluate/buildings/detection.h"
#include "evaluate/buildings/measure_errors.h"

namespace skyquilt::evaluate::buildings {
namespace {

struct SolidFaults {
  bool solid = false, block = false;
};

bool IsFaulty(const skyquilt::buildings::Solid& solid) {
  return solid.Empty() || !CheckSolid(solid).empty();
}

void AddSolids(const std::vector<Building>& list, base::ThreadPool& threads, BuildingScores* scores) {
  std::vector<SolidFaults> faults(list.size());
  threads.ParallelFor(static_cast<int64_t>(list.size()), [&](int64_t task, int) {
    base::ThrowIfCancelled();
    const Building& building = list[static_cast<size_t>(task)];
    faults[static_cast<size_t>(task)] = {IsFaulty(building.lod22), IsFaulty(building.lod12)};
  });
  for (const SolidFaults& one : faults) {
    scores->solids_rejected += one.solid ? 1 : 0;
    scores->blocks_rejected += one.block ? 1 : 0;
  }
}

BuildingTruthScores AgainstTruth(const ComparedBuildings& compared) {
  BuildingTruthScores scores;
  for (const TrueFate fate : compared.matches.truth) scores.outlines_not_counted += fate == TrueFate::kNotCounted ? 1 : 0;
  for (const FoundFate fate : compared.matches.found) scores.found_not_counted += fate == FoundFate::kNotCounted ? 1 : 0;
  scores.detection = ScoreDetection(compared.set, *compared.truth, compared.matches);
  scores.roofs = ScoreMeasures(compared.set, *compared.truth, compared.matches);
  ScoreCorners(compared.set, *compared.truth, compared.matches, &scores);
  scores.each = ListOutcomes(compared.set, *compared.truth, compared.matches);
  return scores;
}

}  // namespace

std::optional<ComparedBuildings> LoadBuildingsOf(const std::filesystem::path& project_folder, const survey::Survey& survey) {
  const std::filesystem::path file = project_folder / "buildings" / "buildings.json";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  ComparedBuildings compared;
  compared.set = skyquilt::buildings::LoadBuildings(file);
  if (survey.truth && survey.georeferenced && std::filesystem::is_regular_file(survey.truth->buildings_json, ignored)) {
    compared.truth = ReadTrueBuildings(survey.truth->buildings_json, survey.origin);
    compared.matches = MatchBuildings(compared.set, *compared.truth);
  }
  return compared;
}

BuildingScores ScoreBuildings(const ComparedBuildings& compared, base::ThreadPool& threads) {
  BuildingScores scores;
  scores.found = static_cast<int64_t>(compared.set.buildings.size());
  scores.metric = compared.set.metric;
  scores.gsd_m = compared.set.gsd_m;
  for (const Building& building : compared.set.buildings) {
    scores.accepted += building.accepted ? 1 : 0;
    scores.blocks_instead += building.lod22_valid ? 0 : 1;
    const skyquilt::buildings::Measures& measures = building.measures;
    if (std::isfinite(measures.footprint_m2.value)) scores.footprint_m2 += measures.footprint_m2.value;
    if (std::isfinite(measures.volume_m3.value)) scores.volume_m3 += measures.volume_m3.value;
  }
  AddSolids(compared.set.buildings, threads, &scores);
  if (compared.truth) scores.truth = AgainstTruth(compared);
  return scores;
}

}  // namespace skyquilt::evaluate::buildings
