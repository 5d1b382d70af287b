#include "bench/study/seeding_bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "bench/poses/survey_size.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "core/base/thread_pool.h"
#include "prepare/poses/seed/seed_poses.h"
#include "simulate/place_spec.h"
#include "simulate/sparse_points.h"
#include "simulate/world.h"

namespace skyquilt::bench {
namespace {

std::vector<int> Ascending(std::vector<int> numbers, const char* flag) {
  std::sort(numbers.begin(), numbers.end());
  if (numbers.empty() || std::adjacent_find(numbers.begin(), numbers.end()) != numbers.end()) {
    throw base::UsageError(fmt::format("{} needs different numbers", flag));
  }
  return numbers;
}

std::vector<survey::ColmapPoint> PointsFrom(const simulate::World& world, const simulate::PlaceSpec& place,
                                            const std::vector<simulate::PhotoPlan>& photos, double per_photo, base::ThreadPool& threads) {
  std::vector<simulate::SurfaceSeed> seeds;
  for (int i = 0; i < static_cast<int>(photos.size()); ++i) {
    const int count = std::max(1, static_cast<int>(std::lround(per_photo)));
    const std::vector<simulate::SurfaceSeed> chosen = simulate::ChooseSeeds(place.camera, i, count, place.seed);
    seeds.insert(seeds.end(), chosen.begin(), chosen.end());
  }
  return simulate::MakeSparsePoints(world, place.camera, photos, seeds, place.seed, threads);
}

// Points that the photos show, so many that each photo has about the wanted number of features.
std::vector<survey::ColmapPoint> PointsOfFlight(const simulate::World& world, const simulate::PlaceSpec& place,
                                                const std::vector<simulate::PhotoPlan>& photos, const SeedingOptions& options,
                                                base::ThreadPool& threads) {
  // So many photos show a point inside the flight; fewer at its edge and behind buildings, which a first trial tells.
  const double views = 1.0 / ((1.0 - place.forward_overlap) * (1.0 - place.side_overlap));
  const double per_photo = options.features_per_photo / (views * options.errors.seen_share);
  std::vector<survey::ColmapPoint> points = PointsFrom(world, place, photos, per_photo, threads);
  double sightings = 0.0;
  for (const survey::ColmapPoint& point : points) sightings += static_cast<double>(point.image_ids.size());
  const double found = sightings * options.errors.seen_share / static_cast<double>(std::max<size_t>(1, photos.size()));
  if (!(found > 0.0)) return points;
  return PointsFrom(world, place, photos, per_photo * options.features_per_photo / found, threads);
}

SeedingRow MeasureSeeding(const SimulatedTracks& tracks, int n_threads) {
  SeedingRow row;
  row.photos = static_cast<int>(tracks.input.photos.size());
  row.threads = n_threads;
  row.pairs = tracks.input.pairs.size();
  row.matches = tracks.n_matches;
  row.wrong = tracks.n_wrong;
  row.features_per_photo = static_cast<double>(tracks.n_features) / std::max(1, row.photos);
  row.score.n_photos = tracks.truth.CountOurs();
  base::ThreadPool threads(n_threads);
  base::ResetPeakRss();
  row.input_bytes = static_cast<double>(base::PeakRssBytes());
  const auto start = std::chrono::steady_clock::now();
  const std::optional<prepare::poses::SeededModel> seeded = prepare::poses::SeedPoses(tracks.input, threads, &row.failure);
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.peak_bytes = static_cast<double>(base::PeakRssBytes());
  if (!seeded) return row;
  row.points = seeded->model.points.size();
  row.median_error = seeded->median_error;
  row.score = JudgePoses(tracks.truth, seeded->model);
  return row;
}

}  // namespace

SeedingResult RunSeedingBench(const SeedingOptions& options) {
  const std::vector<int> sizes = Ascending(options.photos, "--photos"), counts = Ascending(options.threads, "--threads");
  const simulate::PlaceSpec place = simulate::ResolvePlace(options.simulate);
  base::ThreadPool threads(counts.back());
  const simulate::World world(place, options.simulate.light_intensity, threads);
  std::vector<simulate::PhotoPlan> flight = simulate::PlanFlight(place, world.TakeoffHeight(place));
  if (static_cast<size_t>(sizes.back()) > flight.size()) {
    throw base::UsageError(
        fmt::format("--photos {}: the flight over '{}' has {} photos; lower simulate.altitudes, or raise simulate.forward_overlap "
                    "and simulate.side_overlap",
                    sizes.back(), place.name, flight.size()));
  }
  simulate::ApplyTagFaults(place.tag_faults, place.seed, flight);
  const geo::EnuFrame frame({options.simulate.latitude_deg, options.simulate.longitude_deg, options.simulate.height_m});

  SeedingResult result{.place = place.name, .errors = options.errors, .rows = {}};
  for (const int n : sizes) {
    const std::vector<simulate::PhotoPlan> photos = MiddlePhotos(flight, static_cast<size_t>(n));
    const SimulatedTracks tracks = MakeTracks(place.camera, photos, PointsOfFlight(world, place, photos, options, threads), frame, options.errors);
    for (const int n_threads : counts) {
      base::ThrowIfCancelled();
      const SeedingRow row = MeasureSeeding(tracks, n_threads);
      base::LogInfo("{} photos, {} thread{}: {:.1f} s, {:.0f} MB, {} of {} right{}", n, n_threads, n_threads == 1 ? "" : "s", row.seconds,
                    row.peak_bytes / 1e6, row.score.right, n, row.failure.empty() ? "" : ": " + row.failure);
      result.rows.push_back(row);
      options.on_row(result);
    }
  }
  return result;
}

}  // namespace skyquilt::bench
