#include "coordinator/rendering/rank_painter.h"

#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <utility>

#include "coordinator/ranks/failure.h"
#include "coordinator/ranks/rank_messages.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/packed_bytes.h"
#include "products/map_products.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;
using products::PhotoMapRows;
using products::TileArea;

constexpr const char* kUnreadable = "a message about tiles of an orthophoto cannot be read";

// What rank 0 knows of a rank while it paints.
struct Painter {
  int threads = 1;
  bool ready = false;
  uint64_t request = 0;
  std::vector<size_t> tiles;  // that it paints now
};

products::PaintJob OpenJob(const json& setup, double memory_bytes, base::ThreadPool& threads) {
  return {survey::LoadSurvey(setup.at("survey").get<std::string>()), setup.at("job").get<std::string>(), products::PictureMemory(memory_bytes),
          threads};
}

// Tells all ranks that the job is over, after an exception too.
class PaintingRanks {
 public:
  PaintingRanks(comm::Communicator& comm, std::map<int, Painter>& painters, const std::string& setup) : comm_(comm), painters_(painters) {
    for (const auto& [rank, painter] : painters_) comm_.Send(rank, kTagPaint, setup);
  }
  ~PaintingRanks() {
    for (const auto& [rank, painter] : painters_) comm_.Send(rank, kTagPaintEnd, "");
  }
  PaintingRanks(const PaintingRanks&) = delete;
  PaintingRanks& operator=(const PaintingRanks&) = delete;

 private:
  comm::Communicator& comm_;
  std::map<int, Painter>& painters_;
};

}  // namespace

RankPainter::RankPainter(comm::Communicator& comm, std::vector<GroupMember> members, std::filesystem::path survey_folder)
    : comm_(comm), members_(std::move(members)), survey_folder_(std::move(survey_folder)) {}

void RankPainter::Paint(const std::filesystem::path& job, std::span<const TileArea> tiles, const Take& take) {
  std::map<int, Painter> painters;  // by rank
  for (const GroupMember& member : members_) painters[member.rank].threads = member.threads;
  const json setup = {{"survey", std::filesystem::absolute(survey_folder_).string()}, {"job", std::filesystem::absolute(job).string()}};
  const PaintingRanks ranks(comm_, painters, base::JsonText(setup));
  std::deque<size_t> waiting(tiles.size());
  std::iota(waiting.begin(), waiting.end(), size_t{0});
  size_t taken = 0;
  std::set<int> painted_by;
  const auto drop = [&](int rank, const Failure& failure) {
    if (failure.kind == Failure::kInterrupted) Throw(failure);
    base::LogWarning("{} does not paint the orthophoto, others do: {}", comm_.NameOf(rank), failure.Text());
    Painter& painter = painters.at(rank);
    waiting.insert(waiting.begin(), painter.tiles.begin(), painter.tiles.end());
    painter.tiles.clear();
    painter.ready = false;
  };
  size_t starting = painters.size();
  while (taken < tiles.size()) {
    bool anyone = starting > 0;
    for (auto& [rank, painter] : painters) {
      if (painter.ready && painter.tiles.empty() && !waiting.empty()) {
        base::BytePacker request;
        request.Add(painter.request = next_request_++);
        std::vector<TileArea> areas;
        while (!waiting.empty() && static_cast<int>(areas.size()) < painter.threads) {
          painter.tiles.push_back(waiting.front());
          areas.push_back(tiles[waiting.front()]);
          waiting.pop_front();
        }
        request.Add(areas);
        comm_.Send(rank, kTagTiles, request.Take());
      }
      anyone = anyone || painter.ready;
    }
    if (!anyone) break;  // the caller paints
    const comm::Message message = comm_.Receive();
    const auto at = painters.find(message.source);
    if (at == painters.end()) continue;
    Painter& painter = at->second;
    if (message.tag == kTagPaintReady) {
      --starting;
      painter.ready = message.bytes.empty();
      if (!painter.ready) drop(message.source, FailureFromJson(base::ParseJson(message.bytes)));
    }
    if (message.tag != kTagTilesPainted) continue;
    base::ByteUnpacker reply(message.bytes, kUnreadable);
    if (reply.Take<uint64_t>() != painter.request || painter.tiles.empty()) continue;
    if (const auto failure = reply.Take<std::string>(); !failure.empty()) {
      drop(message.source, FailureFromJson(base::ParseJson(failure)));
      continue;
    }
    for (const size_t tile : std::exchange(painter.tiles, {})) {
      PhotoMapRows cells;
      reply.Take(&cells.rgba);
      reply.Take(&cells.sources);
      take(tile, std::move(cells));
      ++taken;
    }
    reply.End();
    painted_by.insert(message.source);
  }
  if (taken > 0) base::LogInfo("{} tiles of the orthophoto painted by {} other rank{}", taken, painted_by.size(), painted_by.size() == 1 ? "" : "s");
}

TilePainter::TilePainter(const std::string& setup, double memory_bytes, base::ThreadPool& threads)
    : threads_(threads), job_(OpenJob(base::ParseJson(setup), memory_bytes, threads)) {}

std::string TilePainter::Answer(const std::string& request) {
  base::ByteUnpacker unpacker(request, kUnreadable);
  const auto number = unpacker.Take<uint64_t>();
  base::BytePacker reply;
  reply.Add(number);
  try {
    const auto areas = unpacker.Take<std::vector<TileArea>>();
    std::vector<PhotoMapRows> painted(areas.size());
    threads_.ParallelFor(static_cast<int64_t>(areas.size()), [&](int64_t task, int /*thread*/) {
      const auto i = static_cast<size_t>(task);
      job_.map().PaintTile(areas[i], &painted[i]);
    });
    reply.Add(std::string());
    for (const PhotoMapRows& cells : painted) {
      reply.Add(cells.rgba);
      reply.Add(cells.sources);
    }
  } catch (...) {
    base::BytePacker failure;
    failure.Add(number);
    failure.Add(base::JsonText(ToJson(CurrentFailure())));
    return failure.Take();
  }
  return reply.Take();
}

}  // namespace skyquilt::coordinator
