#include "surface/files/tileset_writer.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/ecef.h"
#include "surface/files/gltf_document.h"

namespace skyquilt::surface {

namespace {

using Json = nlohmann::ordered_json;

// A tile is replaced by finer ones where its error covers more than 16 pixels, by the default of the usual viewers. A coarse tile of flat ground has
// nearly no geometric error but a blurred texture: with this factor its texels cover at most 2 pixels before it is replaced.
constexpr double kErrorOfTexel = 8.0;
constexpr double kLeastErrorOfDiagonal = 1e-3;
constexpr double kLeastHalfBox_m = 0.01;  // boxes without volume confuse readers

Json BoxOf(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  const Eigen::Vector3d middle = 0.5 * (min + max);
  const Eigen::Vector3d half = 0.5 * (max - min);
  return {{"box", Json::array({middle.x(), middle.y(), middle.z(), half.x(), 0.0, 0.0, 0.0, half.y(), 0.0, 0.0, 0.0, half.z()})}};
}

Json ColumnMajor(const Eigen::Matrix4d& transform) {
  Json values = Json::array();
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) values.push_back(transform(row, column));
  }
  return values;
}

template <typename Nodes>
Json TileJson(const Nodes& nodes, const TileId& id) {
  const auto& node = nodes.at(id);
  Json tile = {{"boundingVolume", BoxOf(node.min, node.max)}, {"geometricError", node.error_m}};
  tile["content"] = {{"uri", id.Name() + ".glb"}};
  if (node.children.empty()) return tile;
  tile["children"] = Json::array();
  for (const TileId& child : node.children) tile["children"].push_back(TileJson(nodes, child));
  return tile;
}

}  // namespace

TilesetWriter::TilesetWriter(const MapFrame& frame, double tile_size_m, const std::filesystem::path& folder)
    : frame_(frame), earth_(frame), tile_size_m_(tile_size_m), folder_(folder / "tiles") {}

void TilesetWriter::AddTile(const TexturedTile& tile, const MapVertices* /*in_map*/) {
  SKYQUILT_CHECK(!nodes_.contains(tile.id), "tile " + tile.id.Name() + " was added twice");
  if (!partial_) {
    partial_.emplace(folder_);
    std::error_code error;
    std::filesystem::create_directory(partial_->path(), error);
    if (error) base::ThrowFileError(partial_->path(), "cannot be created", error.value());
  }
  WriteContent(tile.id.Name(), tile, &nodes_[tile.id]);
}

void TilesetWriter::WriteContent(const std::string& name, const TexturedTile& tile, Node* node) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(tile.position.size());
  for (const Eigen::Vector3d& position : tile.position) positions.push_back(earth_.PositionOf(position));
  Eigen::Vector3d min = positions.front();
  Eigen::Vector3d max = min;
  for (const Eigen::Vector3d& position : positions) {
    min = min.cwiseMin(position);
    max = max.cwiseMax(position);
  }
  const Eigen::Vector3d middle = 0.5 * (min + max);
  node->min = middle.array() - kLeastHalfBox_m;
  node->max = middle.array() + kLeastHalfBox_m;
  node->error_m = std::max(tile.error_m, kErrorOfTexel * TexelSize(tile));

  GltfPrimitive primitive;
  primitive.name = name;
  primitive.position.reserve(positions.size());
  for (const Eigen::Vector3d& position : positions) {
    const Eigen::Vector3f relative = (position - middle).cast<float>();
    // The box holds what is in the file, after rounding.
    node->min = node->min.cwiseMin(middle + relative.cast<double>());
    node->max = node->max.cwiseMax(middle + relative.cast<double>());
    primitive.position.push_back(YUp(relative));
  }
  for (const Eigen::Vector3f& normal : tile.normal) primitive.normal.push_back(YUp(normal));
  primitive.uv = tile.uv;
  primitive.triangle = tile.triangle;
  primitive.jpeg = tile.atlas_jpeg;

  GltfPlace place;
  place.crs = frame_.georeferenced() ? "east-north-up frame of tileset.json, y up" : frame_.CrsName() + ", y up";
  place.vertical = earth_.VerticalName();
  place.translation = {middle.x(), middle.z(), -middle.y()};
  GltfDocument document;
  const std::vector<uint8_t> binary = document.Add(primitive);
  // The folder is renamed as a whole, so its files have their names from the start.
  const std::filesystem::path glb = partial_->path() / (name + ".glb");
  base::OutputFile file(glb);
  file.Append(document.Head(place, glb));
  file.Append(binary);
  file.Complete();
  file.Publish();
  bytes_ += file.size();
}

std::vector<TileId> TilesetWriter::Link() {
  std::vector<TileId> top;
  int top_level = 0;
  for (auto& [id, node] : nodes_) {
    node.children.clear();
    top_level = std::max(top_level, id.level);
  }
  // Finer levels come first, so a tile has all its children when it is added to what is above it.
  for (auto& [id, node] : nodes_) {
    double finest_m = 0.0;
    for (const TileId& child : node.children) {
      node.min = node.min.cwiseMin(nodes_.at(child).min);
      node.max = node.max.cwiseMax(nodes_.at(child).max);
      finest_m = std::max(finest_m, nodes_.at(child).error_m);
    }
    if (node.children.empty()) {
      node.error_m = 0.0;
    } else {
      node.error_m = std::max(node.error_m, kLeastErrorOfDiagonal * (node.max - node.min).norm());
      if (!(node.error_m > finest_m)) node.error_m = 2.0 * finest_m;
    }
    // The tile right above may be missing, when nothing of it was left.
    TileId above = id.Parent();
    while (above.level <= top_level && !nodes_.contains(above)) above = above.Parent();
    if (above.level <= top_level) {
      nodes_.at(above).children.push_back(id);
    } else {
      top.push_back(id);
    }
  }
  return top;
}

void TilesetWriter::Complete() {
  if (nodes_.empty()) return;
  const std::vector<TileId> top = Link();
  Eigen::Vector3d min = nodes_.at(top.front()).min;
  Eigen::Vector3d max = nodes_.at(top.front()).max;
  double error_m = 0.0;
  for (const TileId& id : top) {
    min = min.cwiseMin(nodes_.at(id).min);
    max = max.cwiseMax(nodes_.at(id).max);
    error_m = std::max(error_m, nodes_.at(id).error_m);
  }
  // Viewers show nothing where this error covers too few pixels: where the survey is a dot.
  const double whole_m = std::max(2.0 * error_m, (max - min).norm());
  Json root;
  if (top.size() == 1) {
    root = TileJson(nodes_, top.front());
  } else {
    root = {{"boundingVolume", BoxOf(min, max)}, {"geometricError", whole_m}};
    root["children"] = Json::array();
    for (const TileId& id : top) root["children"].push_back(TileJson(nodes_, id));
  }
  root["refine"] = "REPLACE";
  if (frame_.georeferenced()) root["transform"] = ColumnMajor(geo::EcefFromEnu(earth_.origin()));

  Json tileset;
  tileset["asset"] = {{"version", "1.1"}, {"extras", {{"generator", "Skyquilt"}}}};
  Json& extras = tileset["asset"]["extras"];
  extras["crs"] = frame_.georeferenced() ? "EPSG:4978" : "local frame, metres, z up; not placed on Earth";
  extras["verticalDatum"] = earth_.VerticalName();
  extras["tileSize"] = tile_size_m_;
  if (earth_.raised()) extras[kSurveyTransform] = ColumnMajor(geo::EcefFromEnu(frame_.origin()));
  tileset["geometricError"] = whole_m;
  tileset["root"] = root;
  base::OutputFile file(partial_->path() / "tileset.json");
  file.Append(base::JsonText(tileset, 1) + "\n");
  file.Complete();
  file.Publish();
  bytes_ += file.size();
  base::SyncPath(partial_->path());
}

void TilesetWriter::Publish() {
  if (partial_) partial_->Publish();
}

std::vector<WrittenFile> TilesetWriter::Rows() const {
  if (nodes_.empty()) return {};
  const int levels = nodes_.rbegin()->first.level - nodes_.begin()->first.level + 1;
  return {{.file = "tiles/tileset.json",
           .content = "textured mesh in levels of detail",
           .format = "3D Tiles 1.1",
           .crs = frame_.georeferenced() ? "EPSG:4978" : frame_.CrsName(),
           .vertical = earth_.VerticalName(),
           .bytes = static_cast<int64_t>(bytes_),
           .detail = base::CountText(static_cast<int64_t>(nodes_.size()), "tile") + " in " + base::CountText(levels, "level")}};
}

}  // namespace skyquilt::surface
