// Parts of a job that the other ranks make while they render a scene for rank 0 (serve_rays.h): tiles of an orthophoto, pieces of a mesh. Each rank
// has some parts at a time and gets the next ones when they are done, so that a slow rank makes fewer. Rank 0 makes none meanwhile. The same bytes as
// in a single process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "coordinator/ranks/rank_group.h"
#include "core/base/packed_bytes.h"
#include "core/base/thread_pool.h"
#include "core/comm/communicator.h"
#include "products/photo_map/tile_service.h"
#include "surface/piece_service.h"

namespace skyquilt::coordinator {

// Rank 0's side.
class RankParts {
 public:
  struct Job {
    std::string kind;                                                        // see OpenPartMaker
    nlohmann::json setup;                                                    // what a rank needs to open the job
    std::string what;                                                        // "the orthophoto", for messages
    std::string parts;                                                       // "tiles"
    std::string done;                                                        // "painted"
    std::function<size_t(int threads)> at_once;                              // parts that a rank with so many threads gets at a time
    std::function<void(std::span<const size_t>, base::BytePacker&)> ask;     // packs what a rank must know of these parts
    std::function<void(std::span<const size_t>, base::ByteUnpacker&)> take;  // unpacks what a rank answers
  };

  // members: the ranks that render.
  RankParts(comm::Communicator& comm, std::vector<GroupMember> members) : comm_(comm), members_(std::move(members)) {}
  // Calls job.take, in this thread, for all parts that were made. Ranks that fail make no more, with a warning; parts that nobody made are left.
  // Throws base::Interrupted and what the functions throw.
  void Make(const Job& job, size_t n_parts);
  const std::vector<GroupMember>& members() const { return members_; }

 private:
  comm::Communicator& comm_;
  std::vector<GroupMember> members_;
};

// survey_folder: of the project; ranks that do not see the same survey and photos paint nothing, with a warning.
std::unique_ptr<products::TileService> TilesOnRanks(comm::Communicator& comm, std::vector<GroupMember> members, std::filesystem::path survey_folder);
std::unique_ptr<surface::PieceService> PiecesOnRanks(comm::Communicator& comm, std::vector<GroupMember> members);

// The other ranks' side: a job that is open.
class PartMaker {
 public:
  PartMaker() = default;
  virtual ~PartMaker() = default;
  PartMaker(const PartMaker&) = delete;
  PartMaker& operator=(const PartMaker&) = delete;
  virtual void Make(base::ByteUnpacker& request, base::BytePacker& reply) = 0;
};

// memory_bytes: that this rank may use for everything. Throws base::InputError when survey, photos or files are not those of rank 0.
std::unique_ptr<PartMaker> OpenPartMaker(const nlohmann::json& setup, double memory_bytes, base::ThreadPool& threads);
// The answer to a kTagJobOpen message; leaves `maker` null when the job cannot be opened, which the answer says.
std::string OpenJob(const std::string& setup, double memory_bytes, base::ThreadPool& threads, std::unique_ptr<PartMaker>* maker);
// The answer to a kTagParts message. Failures are part of it.
std::string AnswerParts(PartMaker& maker, const std::string& request);

}  // namespace skyquilt::coordinator
