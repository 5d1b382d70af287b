// The parts of the bench about buildings, and what they share.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/buildings_pool.h"
#include "bench/study/study.h"
#include "bench/study/study_benches.h"

namespace skyquilt::bench {

// Where the surface of a variant comes from.
enum class SurfaceSource {
  kTruth,   // the true depth of the simulated place
  kPoints,  // the sparse points alone
  kField,   // a trained scene
};
struct BuildingsVariant {
  std::string name, label;
  SurfaceSource source = SurfaceSource::kField;
  Variant training;  // name and label are set by the bench
  bool obliques = true;
};
// The variants of these names in the order of BuildingsVariantNames(). Throws base::UsageError for other names.
std::vector<BuildingsVariant> BuildingsVariants(const std::vector<std::string>& names);

// One variant in all towns, in the order of the seeds.
struct BuildingsResults {
  std::string name, label;
  bool obliques = true;
  std::vector<VariantResult> towns;
};

// Work of Study::RunUntrained: surface fused from true depth and colours of photos, and its buildings and scores. Throws base::UsageError when the
// survey has no true surface.
void MeasureFromTruth(coordinator::Pipeline& pipeline, VariantResult* result);
// The same from the sparse points alone.
void MeasureFromPoints(coordinator::Pipeline& pipeline, VariantResult* result);

// One row per variant: counts, completeness, correctness, quality, kinds of roof, uncertainties; with intervals.
BenchTable BuildingsTable(const std::vector<BuildingsResults>& results, const std::string& name);
// One row per variant and size of buildings.
BenchTable BuildingsSizeTable(const std::vector<BuildingsResults>& results, const std::string& name);
// One row per measure and variant.
BenchTable BuildingsMeasureTable(const std::vector<BuildingsResults>& results, const std::string& name);
// One row per variant and town.
BenchTable BuildingsTownTable(const std::vector<BuildingsResults>& results, const std::string& name);
// RMSE of each length, one chart per measure that any variant has.
std::vector<std::string> BuildingsCharts(const std::vector<BuildingsResults>& results);
// How many buildings there are, and for each variant which targets it meets.
std::vector<std::string> BuildingsVerdicts(const std::vector<BuildingsResults>& results);
// Completeness, correctness and errors of the variant that shows what the program does by default.
std::vector<BenchFigure> BuildingsFigures(const std::vector<BuildingsResults>& results);

// The plan of a town as an SVG figure: found footprints, over them true outlines. project_folder: of the variant, with buildings/. Empty when it has
// no buildings.json any more.
std::string BuildingsPlan(const std::string& title, const std::filesystem::path& project_folder, const survey::Survey& survey);

}  // namespace skyquilt::bench
