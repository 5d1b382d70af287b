#include "tour/export/tile_tree.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <system_error>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "surface/files/earth_place.h"
#include "tour/export/script_data.h"

namespace skyquilt::tour {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kDeepest = 64;
constexpr double kNearestPlace_m = 1.0;
constexpr const char* kTilesetName = "tileset.json";
constexpr const char* kMakeSurfaceAgain = "Make the surface again with 'skyquilt surface' and --restart";

bool IsTileFile(const std::string& name) {
  if (name.size() < 5 || name.size() > 60 || !name.ends_with(".glb")) return false;
  return std::all_of(name.begin(), name.end() - 4, [](unsigned char c) { return std::isdigit(c) != 0 || c == '_' || c == '-'; });
}

Eigen::AlignedBox3d BoxFrom(const OrderedJson& volume) {
  const auto& box = volume.at("box");
  std::array<double, 12> v{};
  for (size_t i = 0; i < v.size(); ++i) v[i] = box.at(i).get<double>();
  const Eigen::Vector3d middle(v[0], v[1], v[2]);
  const Eigen::Vector3d half(std::abs(v[3]) + std::abs(v[6]) + std::abs(v[9]), std::abs(v[4]) + std::abs(v[7]) + std::abs(v[10]),
                             std::abs(v[5]) + std::abs(v[8]) + std::abs(v[11]));
  return {Eigen::Vector3d(middle - half), Eigen::Vector3d(middle + half)};
}

// Without the tiles that are not kept; `next` counts the tiles in the order in which they were read.
OrderedJson Trimmed(const OrderedJson& tile, const std::vector<bool>& kept, size_t* next) {
  ++*next;
  OrderedJson trimmed = tile;
  trimmed.erase("children");
  OrderedJson children = OrderedJson::array();
  if (tile.contains("children")) {
    for (const OrderedJson& child : tile["children"]) {
      const bool keep = kept[*next];
      OrderedJson below = Trimmed(child, kept, next);
      if (keep) children.push_back(std::move(below));
    }
  }
  if (children.empty()) {
    trimmed["geometricError"] = 0.0;
  } else {
    trimmed["children"] = std::move(children);
  }
  return trimmed;
}

}  // namespace

TileTree::TileTree(const std::filesystem::path& folder) : file_(folder / kTilesetName) {
  try {
    tileset_ = OrderedJson::parse(base::ReadFile(file_));
    // Tours show tiles beside what is in the survey's frame.
    surface::StandInSurvey(&tileset_);
    Add(tileset_.at("root"), folder, 0);
  } catch (const OrderedJson::exception& damage) {
    throw base::InputError(file_, std::string("is damaged: ") + damage.what(), kMakeSurfaceAgain);
  }
}

size_t TileTree::Add(const OrderedJson& tile, const std::filesystem::path& folder, int depth) {
  if (depth > kDeepest) throw base::InputError(file_, "has too many levels", kMakeSurfaceAgain);
  const size_t index = nodes_.size();
  nodes_.emplace_back();
  nodes_[index].box_enu = BoxFrom(tile.at("boundingVolume"));
  nodes_[index].error_m = tile.at("geometricError").get<double>();
  if (tile.contains("content")) {
    const auto name = tile["content"].at("uri").get<std::string>();
    if (!IsTileFile(name)) throw base::InputError(file_, "has a tile that is not ours: " + name, kMakeSurfaceAgain);
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(folder / name, error);
    if (error) base::ThrowFileError(folder / name, "cannot be read", error.value());
    nodes_[index].file = name;
    nodes_[index].bytes = ScriptBytes(DataName(name), static_cast<int64_t>(bytes));
  }
  if (tile.contains("children")) {
    for (const OrderedJson& child : tile["children"]) {
      const size_t below = Add(child, folder, depth + 1);
      nodes_[index].children.push_back(below);
    }
  }
  return index;
}

int64_t TileTree::CostOf(const std::vector<size_t>& children) const {
  int64_t bytes = 0;
  for (const size_t child : children) {
    bytes += nodes_[child].bytes;
    if (nodes_[child].file.empty()) bytes += CostOf(nodes_[child].children);
  }
  return bytes;
}

// A tile without content shows nothing unless its children are there.
void TileTree::Keep(size_t node, Choice* choice) const {
  choice->kept[node] = true;
  choice->bytes += nodes_[node].bytes;
  if (!nodes_[node].file.empty()) {
    ++choice->tiles;
    return;
  }
  for (const size_t child : nodes_[node].children) Keep(child, choice);
}

TileTree::Choice TileTree::Least() const {
  Choice choice;
  choice.kept.assign(nodes_.size(), false);
  // The whole tree's, which is the longest.
  choice.bytes = ScriptBytes(DataName(kTilesetName), static_cast<int64_t>(base::JsonText(tileset_).size()));
  Keep(0, &choice);
  return choice;
}

TileTree::Choice TileTree::All() const {
  Choice choice = Least();
  for (size_t node = 0; node < nodes_.size(); ++node) {
    if (!choice.kept[node]) Keep(node, &choice);
  }
  return choice;
}

TileTree::Choice TileTree::Choose(int64_t limit_bytes, std::span<const Eigen::Vector3d> places) const {
  // How large the detail that a tile lacks looks from the nearest place.
  const auto looks = [&](size_t node) {
    double distance = places.empty() ? kNearestPlace_m : std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& place : places) distance = std::min(distance, nodes_[node].box_enu.exteriorDistance(place));
    return nodes_[node].error_m / std::max(distance, kNearestPlace_m);
  };
  using Entry = std::pair<double, size_t>;
  const auto later = [](const Entry& a, const Entry& b) { return a.first < b.first || (a.first == b.first && a.second > b.second); };
  std::priority_queue<Entry, std::vector<Entry>, decltype(later)> waiting(later);
  const std::function<void(size_t)> wait = [&](size_t node) {
    if (!nodes_[node].file.empty() && !nodes_[node].children.empty()) waiting.emplace(looks(node), node);
    if (nodes_[node].file.empty()) std::for_each(nodes_[node].children.begin(), nodes_[node].children.end(), wait);
  };
  Choice choice = Least();
  wait(0);
  while (!waiting.empty()) {
    const size_t node = waiting.top().second;
    waiting.pop();
    // One that is too large does not keep smaller ones away.
    if (choice.bytes + CostOf(nodes_[node].children) > limit_bytes) continue;
    for (const size_t child : nodes_[node].children) {
      Keep(child, &choice);
      wait(child);
    }
  }
  return choice;
}

std::string TileTree::Text(const Choice& choice) const {
  OrderedJson trimmed = tileset_;
  size_t next = 0;
  trimmed["root"] = Trimmed(tileset_["root"], choice.kept, &next);
  return base::JsonText(trimmed);
}

}  // namespace skyquilt::tour
