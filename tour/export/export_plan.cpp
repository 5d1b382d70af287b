#include "tour/export/export_plan.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "tour/export/disk_space.h"
#include "tour/export/project_file.h"
#include "tour/export/script_data.h"
#include "tour/format/asset_check.h"
#include "tour/format/asset_name.h"
#include "tour/format/tour_file.h"

namespace skyquilt::tour {
namespace {

namespace fs = std::filesystem;

constexpr int kLargestBuildingsPart = 8;
constexpr int kPlacesPerWay = 16;

bool IsPlainFile(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(file, error));
}

// Files that CheckAsset refuses, with the reason.
using Refusals = std::map<std::string, std::string>;

// Whether the project has this asset as it was when it was uploaded.
bool IsGoodAsset(const fs::path& project, const std::string& name, uint64_t bytes, Refusals* refusals) {
  const std::optional<AssetName> asset = ParseAssetName(name);
  if (!asset || bytes > kMaxAssetBytes) return false;
  const fs::path file = AssetFolder(project) / asset->File();
  std::error_code error;
  if (!IsPlainFile(file) || fs::file_size(file, error) != bytes || error) return false;
  const std::string content = base::ReadFile(file);
  if (base::Sha256Hex(content) != asset->digest) return false;
  try {
    CheckAsset(asset->type, {reinterpret_cast<const uint8_t*>(content.data()), content.size()});
    return true;
  } catch (const base::Refused& refused) {
    refusals->emplace(name, refused.what());
    return false;
  }
}

// Eyes of the stops, and places on straight lines between each and the next.
std::vector<Eigen::Vector3d> PlacesOf(const Tour& tour) {
  std::vector<Eigen::Vector3d> places;
  for (size_t i = 0; i < tour.stops.size(); ++i) {
    const Eigen::Vector3d& eye = tour.stops[i].pose.eye_enu;
    places.push_back(eye);
    if (i + 1 == tour.stops.size()) break;
    const Eigen::Vector3d way = tour.stops[i + 1].pose.eye_enu - eye;
    for (int k = 1; k < kPlacesPerWay; ++k) places.emplace_back(eye + way * k / kPlacesPerWay);
  }
  return places;
}

std::vector<std::string> UsedAssets(const Tour& tour) {
  std::set<std::string> used;
  for (const Stop& stop : tour.stops) {
    if (stop.picture) used.insert(*stop.picture);
  }
  for (const Thing& thing : tour.things) {
    if (thing.kind == ThingKind::kModel) used.insert(thing.asset);
  }
  return {used.begin(), used.end()};
}

}  // namespace

TourContent ReadContent(const fs::path& project) {
  TourContent content;
  LoadTourToPlay(project);  // says best what is wrong with the file
  content.tour_json = base::ReadFile(TourFile(project));
  std::map<std::string, bool> good;
  Refusals refusals;
  content.playable = ReadTourToPlay(content.tour_json, [&](const std::string& name, uint64_t bytes) {
    const auto known = good.find(name);
    if (known != good.end()) return known->second;
    return good[name] = IsGoodAsset(project, name, bytes, &refusals);
  });
  // Beside the sentences that say which stop or thing goes without it.
  for (const auto& [name, reason] : refusals) {
    content.playable.missing.push_back("The file tour/assets/" + name + " is left out: " + reason + ". Upload another in 'skyquilt view --edit'.");
  }
  if (content.playable.tour.stops.empty()) {
    throw base::InputError(TourFile(project), "has no stops", "Add some with 'skyquilt view --edit'");
  }
  content.assets = UsedAssets(content.playable.tour);
  return content;
}

int64_t FixedFiles::Bytes() const {
  int64_t bytes = 0;
  for (const auto& [name, content] : contents) bytes += ScriptBytes(name, static_cast<int64_t>(content.size()));
  for (const auto& [name, file] : files) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (error) base::ThrowFileError(file, "cannot be read", error.value());
    bytes += ScriptBytes(name, static_cast<int64_t>(size));
  }
  return bytes;
}

FixedFiles CollectFixedFiles(const ExportInput& input, const ExportParts& parts, const TourContent& content) {
  FixedFiles fixed;
  fixed.contents["tour.json"] = content.tour_json;
  for (const std::string& asset : content.assets) fixed.files["assets/" + asset] = AssetFolder(input.project) / asset;
  if (const fs::path measurements = input.project / "measurements.geojson"; IsPlainFile(measurements)) {
    fixed.files["measurements.geojson"] = measurements;
  }
  if (!parts.buildings.empty() && IsPlainFile(parts.buildings)) {
    const auto bytes = static_cast<int64_t>(fs::file_size(parts.buildings));
    if (bytes <= input.options.SizeBytes() / kLargestBuildingsPart) {
      fixed.files["buildings/buildings.json"] = parts.buildings;
    } else {
      base::LogWarning("the tour goes without the measures of buildings, which are too large ({})", MegabytesText(bytes));
    }
  }
  if (parts.terrain) fixed.contents["terrain.bin"] = parts.terrain();
  if (parts.orthophoto) fixed.contents["orthophoto.jpg"] = parts.orthophoto();
  const ExportedFiles exported{.tiles = !parts.tiles.empty(),
                               .terrain = fixed.contents.contains("terrain.bin"),
                               .orthophoto = fixed.contents.contains("orthophoto.jpg"),
                               .buildings = fixed.files.contains("buildings/buildings.json")};
  fixed.contents["project.json"] = ExportedProjectJson(parts.project_json, exported);
  return fixed;
}

ExportPlan PlanExport(const fs::path& out, int64_t limit_bytes, int64_t other_bytes, std::span<const StopPictures> pictures, const TileTree* tree,
                      const Tour& tour, base::ThreadPool& threads) {
  ExportPlan plan;
  const int64_t room = limit_bytes - other_bytes;
  const int64_t least_tiles = tree != nullptr ? tree->Least().bytes : 0;
  const int64_t all_tiles = tree != nullptr ? tree->All().bytes : 0;
  // Half of the room, more where the surface needs less; and all that the coarsest surface leaves, if that is what it takes.
  plan.pictures = FitPicturesOfStops(pictures, std::max(room / 2, room - all_tiles), threads);
  if (!plan.pictures.fits) plan.pictures.fits = plan.pictures.bytes <= room - least_tiles;
  if (!plan.pictures.fits) {
    const int64_t needed = other_bytes + plan.pictures.bytes + least_tiles;
    throw base::InputError(out, "the tour does not fit into " + MegabytesText(limit_bytes) + ": it needs at least " + MegabytesText(needed),
                           "Give a larger --size, smaller pictures (tour.panorama_width, tour.still_width, tour.still_height), or fewer stops");
  }
  plan.bytes = other_bytes + plan.pictures.bytes;
  if (tree != nullptr) {
    plan.tiles = tree->Choose(limit_bytes - plan.bytes, PlacesOf(tour));
    plan.bytes += plan.tiles->bytes;
  }
  return plan;
}

}  // namespace skyquilt::tour
