// The pieces of a survey's mesh: each is fused, cut along the lattice into tiles, simplified and kept in a file, by whichever process. The same bytes
// for any number of threads and processes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/gis/boundary.h"
#include "core/scene/scene.h"
#include "surface/fusion/fuse.h"
#include "surface/mesh.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct PiecePlan {
  FuseOptions fuse;
  std::vector<LatticeBox> pieces;
  double needs_bytes = 0.0;  // memory for the largest of them
};

class PieceFuser {
 public:
  // info: origin and extent place the boundary, which is in coordinates of the maps. work_folder: has views.bin; the pieces go to its folder pieces.
  PieceFuser(PiecePlan plan, const scene::SceneInfo& info, std::optional<gis::Boundary> boundary, std::filesystem::path work_folder);
  // For another process that sees the work folder: everything but the pictures of depth, whose key it checks. Write throws base::InputError when the
  // file cannot be written, Read when it or the pictures cannot be read, are damaged, or do not belong together.
  void Write(const std::filesystem::path& job, const std::string& views_key) const;
  static PieceFuser Read(const std::filesystem::path& job, DepthViews* views);

  const PiecePlan& plan() const { return plan_; }
  // Whether the piece's file is there; it may be damaged.
  bool IsMade(size_t piece) const;
  // The tiles of a piece from its file; without one, or where it is damaged, they are fused and saved. Throws base::InputError and base::Interrupted.
  std::vector<MeshTile> Make(size_t piece, const DepthViews& views, base::ThreadPool& threads) const;

 private:
  std::filesystem::path FileOf(size_t piece) const;
  void CutToBoundary(std::vector<MeshTile>* tiles) const;

  PiecePlan plan_;
  scene::SceneInfo place_;  // origin and extent only
  std::optional<gis::Boundary> boundary_;
  std::filesystem::path work_folder_;
};

}  // namespace skyquilt::surface
