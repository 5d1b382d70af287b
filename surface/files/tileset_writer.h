// tiles/: 3D Tiles 1.1 (OGC 22-025r4), an explicit quadtree of the tiles of all levels with glTF contents.
// Boxes are in the survey's ENU frame; the root's transform takes it to EPSG:4978. Contents have glTF's axes, y up, which readers turn to z up; their
// vertices are relative to the middle of the tile, where single precision is fine enough, and the node's translation moves them to their place.
// EPSG:4978 knows only heights above the ellipsoid: where the survey's are above EGM96, everything is raised by the geoid (EarthPlace).
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "core/base/output_file.h"
#include "surface/files/earth_place.h"
#include "surface/files/file_writer.h"

namespace skyquilt::surface {

class TilesetWriter : public FileWriter {
 public:
  // Keeps a reference to the frame. Throws base::InputError when heights have to be converted and PROJ has no geoid.
  TilesetWriter(const MapFrame& frame, double tile_size_m, const std::filesystem::path& folder);

  // Throws std::logic_error for a tile that was added before.
  void AddTile(const TexturedTile& tile, const MapVertices* in_map) override;
  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  struct Node {
    Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  // ENU; of all that is below it, too, once linked
    double error_m = 0.0;
    std::vector<TileId> children;
  };

  void WriteContent(const std::string& name, const TexturedTile& tile, Node* node);
  // The tiles that nothing stands above.
  std::vector<TileId> Link();

  const MapFrame& frame_;
  EarthPlace earth_;
  double tile_size_m_;
  std::filesystem::path folder_;              // of the tiles, once complete
  std::optional<base::PartialPath> partial_;  // the same until then; from the first tile on
  std::map<TileId, Node> nodes_;
  uint64_t bytes_ = 0;
};

}  // namespace skyquilt::surface
