// Paints tiles of an orthophoto on the other ranks, which render a scene for rank 0 at that time (serve_rays.h). Each has as many tiles at a time as
// threads and gets the next ones when they are done, so that a slow rank paints fewer. Rank 0 paints none. The same bytes as in a single process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coordinator/ranks/rank_group.h"
#include "core/base/thread_pool.h"
#include "core/comm/communicator.h"
#include "products/photo_map/paint_job.h"
#include "products/photo_map/tile_service.h"

namespace skyquilt::coordinator {

// Rank 0's side.
class RankPainter : public products::TileService {
 public:
  // members: the ranks that render. survey_folder: of the project; ranks that do not see the same survey and photos paint nothing, with a warning.
  RankPainter(comm::Communicator& comm, std::vector<GroupMember> members, std::filesystem::path survey_folder);
  void Paint(const std::filesystem::path& job, std::span<const products::TileArea> tiles, const Take& take) override;

 private:
  comm::Communicator& comm_;
  std::vector<GroupMember> members_;
  std::filesystem::path survey_folder_;
  uint64_t next_request_ = 1;  // never used twice: answers to an earlier call may be late
};

// The other ranks' side.
class TilePainter {
 public:
  // setup: of a kTagPaint message. memory_bytes: that this rank may use for everything. Throws base::InputError when survey, photos or job are not
  // those of rank 0.
  TilePainter(const std::string& setup, double memory_bytes, base::ThreadPool& threads);
  // The answer to a kTagTiles message. Failures are part of it.
  std::string Answer(const std::string& request);

 private:
  base::ThreadPool& threads_;
  products::PaintJob job_;
};

}  // namespace skyquilt::coordinator
