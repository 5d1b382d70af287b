// The jobs whose parts ranks can make.
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "coordinator/rendering/rank_parts.h"
#include "core/base/errors.h"
#include "core/survey/refined_poses.h"
#include "products/map_products.h"
#include "products/photo_map/paint_job.h"
#include "surface/piece_fuser.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;
using products::PhotoMapRows;
using products::TileArea;

constexpr const char* kOrthophoto = "orthophoto";
constexpr const char* kMesh = "mesh";
constexpr double kMeshMemory = 2.0;  // a rank's limit: stage "surface" gives half of it to the scene's fields, which ranks report

std::string Absolute(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).string();
}

class RankPainter : public products::TileService {
 public:
  RankPainter(comm::Communicator& comm, std::vector<GroupMember> members, std::filesystem::path survey_folder)
      : ranks_(comm, std::move(members)), survey_folder_(std::move(survey_folder)) {}

  void Paint(const std::filesystem::path& job, std::span<const TileArea> tiles, const Take& take) override {
    ranks_.Make({.kind = kOrthophoto,
                 .setup = {{"survey", Absolute(survey_folder_)}, {"job", Absolute(job)}},
                 .what = "the orthophoto",
                 .parts = "tiles",
                 .done = "painted",
                 .at_once = [](int threads) { return static_cast<size_t>(threads); },
                 .ask =
                     [&](std::span<const size_t> parts, base::BytePacker& request) {
                       std::vector<TileArea> areas;
                       for (const size_t tile : parts) areas.push_back(tiles[tile]);
                       request.Add(areas);
                     },
                 .take =
                     [&](std::span<const size_t> parts, base::ByteUnpacker& reply) {
                       for (const size_t tile : parts) {
                         PhotoMapRows cells;
                         reply.Take(&cells.rgba);
                         reply.Take(&cells.sources);
                         take(tile, std::move(cells));
                       }
                     }},
                tiles.size());
  }

 private:
  RankParts ranks_;
  std::filesystem::path survey_folder_;
};

class RankFuser : public surface::PieceService {
 public:
  RankFuser(comm::Communicator& comm, std::vector<GroupMember> members) : ranks_(comm, std::move(members)) {}

  int Makers() const override { return static_cast<int>(ranks_.members().size()); }
  double MemoryBytes() const override {
    double least = std::numeric_limits<double>::infinity();
    for (const GroupMember& member : ranks_.members()) {
      if (member.memory_bytes > 0.0) least = std::min(least, kMeshMemory * member.memory_bytes);
    }
    return least;
  }
  void Make(const std::filesystem::path& job, std::span<const size_t> pieces, const Made& made) override {
    ranks_.Make({.kind = kMesh,
                 .setup = {{"job", Absolute(job)}},
                 .what = "the mesh",
                 .parts = "pieces",
                 .done = "fused",
                 .at_once = [](int /*threads*/) { return size_t{1}; },
                 .ask = [&](std::span<const size_t> parts, base::BytePacker& request) { request.Add(static_cast<uint64_t>(pieces[parts[0]])); },
                 .take = [&](std::span<const size_t> parts, base::ByteUnpacker&) { made(pieces[parts[0]]); }},
                pieces.size());
  }

 private:
  RankParts ranks_;
};

class TilePainter : public PartMaker {
 public:
  TilePainter(const json& setup, double memory_bytes, base::ThreadPool& threads)
      : threads_(threads),
        job_(survey::LoadRefinedSurvey(setup.at("survey").get<std::string>()), setup.at("job").get<std::string>(),
             products::PictureMemory(memory_bytes), threads) {}

  void Make(base::ByteUnpacker& request, base::BytePacker& reply) override {
    const auto areas = request.Take<std::vector<TileArea>>();
    std::vector<PhotoMapRows> painted(areas.size());
    threads_.ParallelFor(static_cast<int64_t>(areas.size()), [&](int64_t task, int /*thread*/) {
      const auto i = static_cast<size_t>(task);
      job_.map().PaintTile(areas[i], &painted[i]);
    });
    for (const PhotoMapRows& cells : painted) {
      reply.Add(cells.rgba);
      reply.Add(cells.sources);
    }
  }

 private:
  base::ThreadPool& threads_;
  products::PaintJob job_;
};

class MeshPieces : public PartMaker {
 public:
  MeshPieces(const json& setup, base::ThreadPool& threads)
      : threads_(threads), fuser_(surface::PieceFuser::Read(setup.at("job").get<std::string>(), &views_)) {}

  // The piece is in its file then.
  void Make(base::ByteUnpacker& request, base::BytePacker& /*reply*/) override {
    const auto piece = request.Take<uint64_t>();
    SKYQUILT_CHECK(piece < fuser_.plan().pieces.size(), "ranks know the same pieces");
    fuser_.Make(piece, views_, threads_);
  }

 private:
  base::ThreadPool& threads_;
  surface::DepthViews views_;
  surface::PieceFuser fuser_;
};

}  // namespace

std::unique_ptr<products::TileService> TilesOnRanks(comm::Communicator& comm, std::vector<GroupMember> members, std::filesystem::path survey_folder) {
  return std::make_unique<RankPainter>(comm, std::move(members), std::move(survey_folder));
}

std::unique_ptr<surface::PieceService> PiecesOnRanks(comm::Communicator& comm, std::vector<GroupMember> members) {
  return std::make_unique<RankFuser>(comm, std::move(members));
}

std::unique_ptr<PartMaker> OpenPartMaker(const json& setup, double memory_bytes, base::ThreadPool& threads) {
  if (setup.at("kind") == kMesh) return std::make_unique<MeshPieces>(setup, threads);
  return std::make_unique<TilePainter>(setup, memory_bytes, threads);
}

}  // namespace skyquilt::coordinator
