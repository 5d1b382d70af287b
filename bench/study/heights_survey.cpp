#include "bench/study/heights_survey.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;
using simulate::PhotoPlan;
using simulate::PlaceSpec;
using simulate::SimulateOptions;
using simulate::World;

constexpr double kBuildingClearance_m = 8.0;  // from buildings
constexpr double kPause_s = 1800.0;           // between flights, long enough to make them flights of their own
constexpr double kLeastSpread = 0.3;          // of the area's sides, over which the views of a height are spread
constexpr double kViewsPerPick = 2.0;         // planned per view, as some may be too close to buildings

void CheckPlan(const HeightsPlan& plan) {
  std::vector<int> all = plan.flights_m;
  all.insert(all.end(), plan.views_m.begin(), plan.views_m.end());
  if (plan.flights_m.empty()) throw base::UsageError("a survey from several heights needs at least one height to train with");
  for (const int height : all) {
    if (height < 1 || height > 999) throw base::UsageError(fmt::format("a height of {} m is not allowed: 1 to 999 m", height));
  }
  if (std::set<int>(all.begin(), all.end()).size() != all.size())
    throw base::UsageError(fmt::format("heights {} m: one is named twice", fmt::join(all, ", ")));
  if (plan.views < 1) throw base::UsageError(fmt::format("{} views per height: at least 1 is needed", plan.views));
  if (plan.test_every < 2) throw base::UsageError(fmt::format("every {}. photo held out: none is left to train with", plan.test_every));
}

// Of everything that the survey depends on.
std::string Identity(SimulateOptions options, const HeightsPlan& plan) {
  config::Sections sections;
  sections.Add("simulate", options, "");
  std::map<std::string, std::string> flat = config::Flatten(sections);
  flat["heights.plan"] = fmt::format("[{}] [{}] {} {}", fmt::join(plan.flights_m, ", "), fmt::join(plan.views_m, ", "), plan.views, plan.test_every);
  return config::Hash(flat);
}

bool IsComplete(const fs::path& folder, const std::string& identity) {
  if (!fs::exists(folder / "simulate.json") || !fs::exists(folder / "heights.json") || !fs::exists(folder / "holdout.txt")) return false;
  const nlohmann::json json = base::TryParseJson(base::ReadFile(folder / "heights.json"));
  return json.is_object() && json.value("identity", "") == identity;
}

// n of the items at even distances, in their order.
template <typename Item>
std::vector<Item> EvenlySpread(const std::vector<Item>& items, size_t n) {
  std::vector<Item> kept;
  kept.reserve(std::min(n, items.size()));
  for (size_t i = 0; i < items.size(); ++i) {
    if ((i + 1) * n / items.size() > i * n / items.size()) kept.push_back(items[i]);
  }
  return kept;
}

// The photos of one height, named after it, without those too close to a building. Errors of poses are not those of another height.
std::vector<PhotoPlan> Fly(PlaceSpec place, const World& world, int height_m) {
  std::fill(place.altitudes_agl_m.begin(), place.altitudes_agl_m.end(), height_m);
  place.seed += 1000003U * static_cast<uint32_t>(height_m);
  std::vector<PhotoPlan> photos = simulate::PlanFlight(place, world.TakeoffHeight(place));
  std::erase_if(photos, [&world](const PhotoPlan& photo) {
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    return std::any_of(world.buildings().begin(), world.buildings().end(), [&eye](const simulate::Building& building) {
      const double top = building.ground_z_m + building.ridge_height_m + building.parapet_height_m;
      return eye.z() < top + kBuildingClearance_m && building.DistanceTo(eye.head<2>()) < kBuildingClearance_m;
    });
  });
  for (PhotoPlan& photo : photos) photo.name = HeightPrefix(height_m) + photo.name;
  return photos;
}

std::vector<PhotoPlan> WholeFlight(const PlaceSpec& place, const World& world, int height_m) {
  double own_m = 0.0;
  for (const double altitude : place.altitudes_agl_m) own_m += altitude / static_cast<double>(place.altitudes_agl_m.size());
  // The distance between photos stays that of the place's own flight.
  const double factor = own_m / height_m;
  PlaceSpec flown = place;
  for (double* overlap : {&flown.forward_overlap, &flown.side_overlap, &flown.oblique_overlap}) *overlap = 1.0 - factor * (1.0 - *overlap);
  return Fly(std::move(flown), world, height_m);
}

std::vector<PhotoPlan> Views(const PlaceSpec& place, const World& world, int height_m, int count) {
  const Eigen::Vector2d frame = height_m * Eigen::Vector2d(place.camera.width / place.camera.FocalX(), place.camera.height / place.camera.FocalY());
  const Eigen::Vector2d middle = 0.5 * (place.area_min + place.area_max);
  const Eigen::Vector2d area = place.area_max - place.area_min;
  // Frames that are larger than the area see beyond it wherever they are; so their views are only spread enough to differ.
  const Eigen::Vector2d spread = (area - frame).cwiseMax(kLeastSpread * area);
  const double cell = std::sqrt(spread.prod() / (kViewsPerPick * count));
  const Eigen::Vector2d spacing =
      spread.binaryExpr(Eigen::Vector2d::Constant(cell), [](double side, double wanted) { return side / std::max(1.0, std::ceil(side / wanted)); });
  PlaceSpec flown = place;
  flown.area_min = middle - 0.5 * spread;
  flown.area_max = middle + 0.5 * spread;
  flown.flight_inset_m = 0.0;
  flown.oblique_lines = 0;
  flown.side_overlap = 1.0 - spacing.x() / frame.x();
  flown.forward_overlap = 1.0 - spacing.y() / frame.y();
  std::vector<PhotoPlan> photos = EvenlySpread(Fly(std::move(flown), world, height_m), static_cast<size_t>(count));
  for (PhotoPlan& photo : photos) {
    photo.true_depth = true;
    photo.finds_points = false;
  }
  return photos;
}

std::vector<PhotoPlan> PlanPhotos(const HeightsPlan& plan, const PlaceSpec& place, const World& world) {
  std::map<int, std::vector<PhotoPlan>> heights;
  size_t fewest = std::numeric_limits<size_t>::max();
  for (const int height : plan.flights_m) {
    heights[height] = WholeFlight(place, world, height);
    fewest = std::min(fewest, heights[height].size());
  }
  for (const int height : plan.flights_m) {
    heights[height] = EvenlySpread(heights[height], fewest);
    for (size_t i = 0; i < fewest; i += static_cast<size_t>(plan.test_every)) heights[height][i].true_depth = true;
  }
  for (const int height : plan.views_m) heights[height] = Views(place, world, height, plan.views);
  std::vector<PhotoPlan> all;
  double start_s = 0.0;
  for (const auto& [height, photos] : heights) {
    double last_s = 0.0;
    for (PhotoPlan photo : photos) {
      last_s = photo.time_s += start_s;
      all.push_back(std::move(photo));
    }
    if (!photos.empty()) start_s = last_s + kPause_s;
  }
  return all;
}

// Before the photos are rendered: the survey is complete with simulate.json, which is written last.
void WritePlan(const fs::path& folder, const std::string& identity, const HeightsPlan& plan, const std::vector<PhotoPlan>& photos) {
  std::string holdout;
  std::map<std::string, std::vector<std::string>> names;
  for (const PhotoPlan& photo : photos) {
    names[HeightPrefix(HeightOfPhoto(photo.name))].push_back(photo.name);
    if (photo.true_depth) holdout.append(photo.name).append("\n");
  }
  const nlohmann::ordered_json json = {{"about", "Simulated survey from several heights; names of the photos by the prefix of their height"},
                                       {"identity", identity},
                                       {"flights_m", plan.flights_m},
                                       {"views_m", plan.views_m},
                                       {"views", plan.views},
                                       {"test_every", plan.test_every},
                                       {"photos", names}};
  base::WriteFileAtomically(folder / "holdout.txt", holdout);
  base::WriteFileAtomically(folder / "heights.json", base::JsonText(json, 1) + "\n");
}

}  // namespace

fs::path SimulateHeights(const SimulateOptions& options, const HeightsPlan& plan, const fs::path& folder, base::ThreadPool& threads) {
  CheckPlan(plan);
  SimulateOptions still = options;
  still.gps_noise_m = still.exposure_drift_stops = still.exposure_jumps_stops = 0.0;
  still.exposure_error_stops = still.color_drift_stops = 0.0;
  still.moving_cars = 0;
  still.single_line = false;
  still.test_every = plan.test_every;
  const std::string identity = Identity(still, plan);
  fs::path holdout = fs::absolute(folder / "holdout.txt").lexically_normal();
  if (IsComplete(folder, identity)) {
    base::LogInfo("simulate: {} is complete", folder.string());
    return holdout;
  }
  simulate::Simulate(still, folder, threads, [&](const PlaceSpec& place, const World& world) {
    std::vector<PhotoPlan> photos = PlanPhotos(plan, place, world);
    WritePlan(folder, identity, plan, photos);
    return photos;
  });
  return holdout;
}

std::string HeightPrefix(int height_m) {
  return fmt::format("h{:03d}_", height_m);
}

int HeightOfPhoto(const std::string& name) {
  if (name.size() < 5 || name[0] != 'h' || name[4] != '_') return -1;
  if (!std::all_of(name.begin() + 1, name.begin() + 4, [](unsigned char c) { return std::isdigit(c) != 0; })) return -1;
  return std::stoi(name.substr(1, 3));
}

std::vector<std::string> HalfOfEach(std::vector<std::string> training) {
  std::sort(training.begin(), training.end());
  std::map<int, std::vector<std::string>> heights;
  for (std::string& name : training) heights[HeightOfPhoto(name)].push_back(std::move(name));
  size_t total = 0;
  for (const auto& [height, names] : heights) total = std::max(total, names.size());
  std::vector<std::string> chosen;
  chosen.reserve(total);
  size_t group = 0;
  for (const auto& [height, names] : heights) {
    const size_t share = (group + 1) * total / heights.size() - group * total / heights.size();
    ++group;
    const std::vector<std::string> part = EvenlySpread(names, std::min(share, names.size()));
    chosen.insert(chosen.end(), part.begin(), part.end());
  }
  return chosen;
}

}  // namespace skyquilt::bench
