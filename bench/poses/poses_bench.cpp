#include "bench/poses/poses_bench.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <utility>

#include "bench/poses/survey_size.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/list_files.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_run.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// More than these need a larger place than a town.
constexpr int kMostInTown = 100;
constexpr double kCityHeight_m = 100.0;
constexpr int kAllPhotos = 0;
// Another place is one with this added to the seed.
constexpr int kOtherSeed = 1000;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

simulate::SimulateOptions PlaceOf(const PosesBenchOptions& options) {
  simulate::SimulateOptions place = options.simulate;
  // The truth is read from the model, which must be in the frame of the tags.
  place.exact_frame = true;
  if (options.place) {
    place.place = *options.place;
  } else if (place.place == "town" && std::any_of(options.photos.begin(), options.photos.end(), [](int n) { return n > kMostInTown; })) {
    place.place = "smallcity";
    if (place.altitudes.empty()) place.altitudes = {kCityHeight_m};
  }
  return place;
}

// Makes each survey once: a place with a number of photos.
class Surveys {
 public:
  Surveys(fs::path folder, base::ThreadPool& threads) : folder_(std::move(folder)), threads_(threads) {}

  // `n`: kAllPhotos, or that many around the middle. `at_most`: fewer are enough when the place has no more.
  fs::path Make(const std::string& name, const simulate::SimulateOptions& options, int n, bool at_most) {
    const fs::path folder = folder_ / (name + (n == kAllPhotos ? "" : "_" + std::to_string(n)));
    if (!made_.insert(folder).second) return folder;
    simulate::Simulate(options, folder, threads_, [&](const simulate::PlaceSpec& place, const simulate::World& world) {
      std::vector<simulate::PhotoPlan> photos = simulate::PlanFlight(place, world.TakeoffHeight(place));
      for (simulate::PhotoPlan& photo : photos) photo.finds_points = false;
      if (n == kAllPhotos) return photos;
      if (static_cast<size_t>(n) > photos.size() && !at_most) {
        throw base::UsageError("--photos " + std::to_string(n) + ": place '" + place.name + "' has " + std::to_string(photos.size()) +
                               "; choose --place smallcity, lower simulate.altitudes, or raise simulate.forward_overlap and side_overlap");
      }
      return MiddlePhotos(std::move(photos), static_cast<size_t>(n));
    });
    return folder;
  }

 private:
  fs::path folder_;
  base::ThreadPool& threads_;
  std::set<fs::path> made_;
};

PosesRow FindAndJudge(const fs::path& folder, const TrueSet& truth, const std::string& way, const PosesBenchOptions& options,
                      base::ThreadPool& threads) {
  PosesRow row;
  row.way = way;
  row.n_files = truth.photos.size();
  row.score.n_photos = truth.CountOurs();
  prepare::poses::PoseOptions poses = options.poses;
  poses.fast = way == kFastWay;
  const fs::path images = folder / "images";
  const prepare::poses::ColmapJob job{.photo_root = images, .masks = {}, .folder = folder / way};
  const auto start = Clock::now();
  try {
    const prepare::input::PhotoSet photos =
        prepare::input::ReadPhotos(images, prepare::input::TakenNames(prepare::input::ListInput(images, {}, threads)), threads);
    const fs::path model = prepare::poses::RunColmap(job, photos.usable, poses, threads);
    row.seconds = SecondsSince(start);
    row.used = UsedWay(job.folder, model, poses.fast);
    row.score = JudgePoses(truth, survey::ReadColmapModel(model));
  } catch (const prepare::poses::NoModelError& error) {
    row.seconds = SecondsSince(start);
    row.failure = error.what();
  }
  return row;
}

}  // namespace

std::string UsedWay(const fs::path& job, const fs::path& model, bool fast) {
  if (!fast) return "COLMAP alone";
  const std::string inside = model.lexically_relative(job).generic_string();
  if (inside.starts_with("more_pairs/")) return inside.find("held_focal") == std::string::npos ? "more pairs" : "more pairs, tagged focal";
  return inside == "seeded" ? "tags and matches" : "mapper";
}

PosesResult RunPosesBench(const PosesBenchOptions& options) {
  const auto start = Clock::now();
  std::vector<PhotoSet> sets = options.sets;
  if (sets.empty()) {
    for (const std::string& name : PhotoSetNames()) sets.push_back(PhotoSetOf(name));
  }
  std::vector<int> sizes = options.photos;
  if (sizes.empty()) sizes.push_back(kAllPhotos);
  const std::vector<std::string> ways = options.ways.empty() ? std::vector<std::string>{kFastWay, kColmapWay} : options.ways;
  const simulate::SimulateOptions place = PlaceOf(options);
  simulate::SimulateOptions other = place;
  other.seed += kOtherSeed;
  simulate::SimulateOptions farm = place;
  farm.place = "solar_farm";
  farm.altitudes = options.simulate.altitudes;

  const fs::path work = options.folder / "poses_work";
  fs::remove_all(work);
  base::RequireWritableFolder(work);
  base::ThreadPool threads(options.threads);
  Surveys surveys(work, threads);
  PosesResult result;
  result.place = place.place;
  for (const PhotoSet set : sets) {
    for (const int n : sizes) {
      base::ThrowIfCancelled();
      const bool is_farm = set == PhotoSet::kSolarFarm;
      const fs::path survey = is_farm ? surveys.Make("solar_farm_place", farm, n, true) : surveys.Make("place", place, n, false);
      const fs::path elsewhere = set == PhotoSet::kOtherPlace ? surveys.Make("other_place_place", other, kIntruders, false) : fs::path();
      const fs::path folder = work / (std::string(NameOf(set)) + (n == kAllPhotos ? "" : "_" + std::to_string(n)));
      const TrueSet truth = MakePhotoSet(set, survey, elsewhere, folder / "images");
      for (const std::string& way : ways) {
        base::LogInfo("bench poses: {}, {} photos, {}", NameOf(set), truth.photos.size(), way);
        PosesRow row = FindAndJudge(folder, truth, way, options, threads);
        row.set = set;
        result.rows.push_back(std::move(row));
        result.seconds = SecondsSince(start);
        options.on_row(result);
      }
      if (!options.keep) fs::remove_all(folder);
    }
  }
  if (!options.keep) fs::remove_all(work);
  result.seconds = SecondsSince(start);
  return result;
}

std::vector<WayComparison> PosesResult::Comparisons() const {
  std::vector<WayComparison> comparisons;
  for (const PosesRow& fast : rows) {
    if (fast.way != kFastWay) continue;
    const auto colmap = std::find_if(
        rows.begin(), rows.end(), [&](const PosesRow& row) { return row.way == kColmapWay && row.set == fast.set && row.n_files == fast.n_files; });
    if (colmap != rows.end()) comparisons.push_back({&fast, &*colmap});
  }
  return comparisons;
}

std::vector<PosesSlope> PosesResult::Slopes() const {
  std::map<std::pair<PhotoSet, std::string>, std::pair<const PosesRow*, const PosesRow*>> ends;
  for (const PosesRow& row : rows) {
    auto& [few, many] = ends.try_emplace({row.set, row.way}, &row, &row).first->second;
    if (row.n_files < few->n_files) few = &row;
    if (row.n_files > many->n_files) many = &row;
  }
  std::vector<PosesSlope> slopes;
  for (const auto& [key, end] : ends) {
    const auto& [few, many] = end;
    if (few->n_files == many->n_files) continue;
    slopes.push_back({key.first, key.second, few->n_files, many->n_files, many->SecondsPerPhoto() / few->SecondsPerPhoto()});
  }
  return slopes;
}

}  // namespace skyquilt::bench
