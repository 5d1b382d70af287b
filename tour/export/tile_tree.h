// The surface's 3D Tiles for an exported tour: those that its size allows.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::tour {

// tileset.json as surface/files/tileset_writer.h writes it: a tree in which finer tiles replace the one above them. So all children of a tile are
// kept, or none: a gap among them would be a gap in the surface.
class TileTree {
 public:
  struct Node {
    std::string file;             // below the folder; empty: only its children have content
    int64_t bytes = 0;            // of the script with it, see ScriptBytes
    double error_m = 0.0;         // geometric error: the detail that it lacks
    Eigen::AlignedBox3d box_enu;  // of all that is below it, too
    std::vector<size_t> children;
  };
  struct Choice {
    std::vector<bool> kept;  // per node
    int64_t bytes = 0;       // of the kept tiles and tileset.json
    size_t tiles = 0;        // with content
  };

  // Throws base::InputError when the set is damaged, or a tile is missing.
  explicit TileTree(const std::filesystem::path& folder);

  // In order of tileset.json; the root first.
  const std::vector<Node>& nodes() const { return nodes_; }
  Choice All() const;
  // The least that shows all of the surface.
  Choice Least() const;
  // As much as the bytes allow, finer where the surface is near these places, as a camera there sees it. Never less than Least(), even if that is too
  // much. The same places give the same choice.
  Choice Choose(int64_t limit_bytes, std::span<const Eigen::Vector3d> places) const;
  // tileset.json with the kept tiles; those without kept children are the finest (error 0).
  std::string Text(const Choice& choice) const;

  static std::string DataName(const std::string& file) { return "tiles/" + file; }

 private:
  size_t Add(const nlohmann::ordered_json& tile, const std::filesystem::path& folder, int depth);
  void Keep(size_t node, Choice* choice) const;
  // Bytes that replacing a kept tile by its children adds.
  int64_t CostOf(const std::vector<size_t>& children) const;

  nlohmann::ordered_json tileset_;
  std::filesystem::path file_;
  std::vector<Node> nodes_;
};

}  // namespace skyquilt::tour
