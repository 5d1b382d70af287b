#include "bench/study/growth_bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include "bench/poses/survey_size.h"
#include "coordinator/stages/pipeline.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "partition/block.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;
using coordinator::Pipeline;

std::string GrowthIdentity(coordinator::Settings settings, int photos, int ranks) {
  std::map<std::string, std::string> flat = config::Flatten(settings.AllSections());
  flat["scale.photos"] = std::to_string(photos);
  flat["scale.ranks"] = std::to_string(ranks);
  return config::Hash(flat);
}

// Runs a stage and measures it.
template <typename Work>
void MeasureStage(const std::string& name, GrowthRow* row, const Work& work) {
  base::ThrowIfCancelled();
  base::ResetPeakRss();
  const auto start = std::chrono::steady_clock::now();
  work();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row->stages.push_back({name, seconds, static_cast<double>(base::PeakRssBytes())});
  base::LogInfo("{} photos, {}: {:.1f} s, {:.0f} MB", row->photos, name, seconds, row->stages.back().peak_bytes / 1e6);
}

// The photos around the middle of the place, so that the area grows with their number, and all else stays as it is.
void SimulateMiddle(const GrowthOptions& options, int photos, const fs::path& folder) {
  base::ThreadPool threads(options.settings.run.UsableThreads());
  simulate::Simulate(options.settings.simulate, folder, threads, [&](const simulate::PlaceSpec& place, const simulate::World& world) {
    std::vector<simulate::PhotoPlan> flown = simulate::PlanFlight(place, world.TakeoffHeight(place));
    if (static_cast<size_t>(photos) > flown.size()) {
      throw base::UsageError(
          fmt::format("--photos {}: the flight over '{}' has {} photos; lower simulate.altitudes, or raise simulate.forward_overlap "
                      "and simulate.side_overlap",
                      photos, place.name, flown.size()));
    }
    return MiddlePhotos(std::move(flown), static_cast<size_t>(photos));
  });
}

void DescribeSurvey(const coordinator::Project& project, GrowthRow* row) {
  row->points = static_cast<int64_t>(survey::LoadSurvey(project.SurveyFolder()).points.size());
  for (const partition::Block& block : partition::LoadBlocks(project.BlocksFile()).blocks) {
    if (block.empty) continue;
    ++row->blocks;
    row->area_m2 += (block.max_enu - block.min_enu).head<2>().prod();
  }
}

GrowthRow MeasureSurvey(comm::Communicator& comm, const GrowthOptions& options, int photos, const fs::path& folder) {
  GrowthRow row;
  row.photos = photos;
  // Figures of a part of the stages, from before an interruption, would not be those of one run.
  fs::remove_all(folder);
  const fs::path simulated = folder / "simulated";
  MeasureStage("simulate", &row, [&] { SimulateMiddle(options, photos, simulated); });
  Pipeline pipeline{.comm = comm,
                    .project = coordinator::Project::Create(folder),
                    .settings = options.settings,
                    .quiet = options.quiet,
                    .verbose = options.verbose};
  MeasureStage("prepare", &row, [&] { coordinator::PrepareStage(pipeline, simulated, {}); });
  MeasureStage("partition", &row, [&] { coordinator::PartitionStage(pipeline); });
  DescribeSurvey(pipeline.project, &row);
  MeasureStage(kBudgetedStage, &row, [&] { coordinator::TrainStage(pipeline); });
  MeasureStage("merge", &row, [&] { coordinator::MergeStage(pipeline); });
  MeasureStage("products", &row, [&] { coordinator::ProductsStage(pipeline); });
  MeasureStage("surface", &row, [&] { coordinator::SurfaceStage(pipeline); });
  MeasureStage("evaluate", &row, [&] { coordinator::EvaluateStage(pipeline); });
  return row;
}

}  // namespace

const GrowthStage* GrowthRow::Find(const std::string& stage) const {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const GrowthStage& one) { return one.name == stage; });
  return found == stages.end() ? nullptr : &*found;
}

double GrowthRow::PeakBytes() const {
  double most = 0.0;
  for (const GrowthStage& stage : stages) most = std::max(most, stage.peak_bytes);
  return most;
}

double GrowthLaw::At(double photos) const {
  return factor * std::pow(photos, exponent);
}

GrowthLaw FitGrowth(std::vector<std::pair<double, double>> points) {
  std::sort(points.begin(), points.end());
  std::set<double> numbers;
  for (const auto& [photos, value] : points) numbers.insert(photos);
  if (numbers.size() < 2) throw base::UsageError("growth can only be told from at least two numbers of photos: give --photos 500,1000 or more");
  // Fixed costs would hide the growth of the small ones.
  const size_t used = std::max<size_t>(2, (numbers.size() + 1) / 2);
  const double from = *std::next(numbers.begin(), static_cast<std::ptrdiff_t>(numbers.size() - used));
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const auto& [photos, value] : points) {
    if (photos < from) continue;
    const double u = std::log(photos), v = std::log(value);
    n += 1.0;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  const double exponent = (n * xy - x * y) / (n * xx - x * x);
  return {std::exp((y - exponent * x) / n), exponent};
}

GrowthResult RunGrowthBench(comm::Communicator& comm, const GrowthOptions& options) {
  std::vector<int> sizes = options.photos;
  std::sort(sizes.begin(), sizes.end());
  if (sizes.empty() || std::adjacent_find(sizes.begin(), sizes.end()) != sizes.end()) {
    throw base::UsageError("--photos needs different numbers of photos");
  }
  const fs::path work = options.folder / "scale_work";
  base::RequireWritableFolder(work);
  GrowthResult result;
  result.memory_bytes = options.settings.run.MemoryLimitBytes();
  result.ranks = comm.size();
  for (const int photos : sizes) {
    const fs::path folder = work / std::to_string(photos), file = folder.string() + ".json";
    const std::string identity = GrowthIdentity(options.settings, photos, comm.size());
    GrowthRow row;
    if (fs::exists(file) && ParseGrowthRow(base::ReadFile(file), identity, &row)) {
      base::LogInfo("{} photos: nothing to do, the figures are saved", photos);
    } else {
      row = MeasureSurvey(comm, options, photos, folder);
      base::WriteFileAtomically(file, GrowthRowJson(row, identity));
      if (!options.keep) fs::remove_all(folder);
    }
    result.rows.push_back(std::move(row));
    options.on_row(result);
  }
  return result;
}

}  // namespace skyquilt::bench
