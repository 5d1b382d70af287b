#include "coordinator/rendering/serve_rays.h"

#include <sys/stat.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "coordinator/ranks/rank_group.h"
#include "coordinator/ranks/rank_messages.h"
#include "coordinator/rendering/block_owners.h"
#include "coordinator/rendering/rank_parts.h"
#include "coordinator/rendering/ray_request.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/thread_pool.h"
#include "core/scene/paged_renderer.h"
#include "core/scene/scene_file.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

// Size and time of a file, which all ranks must see alike; null when it cannot be looked at.
json LookAt(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return nullptr;
  return {{"bytes", status.st_size}, {"seconds", status.st_mtim.tv_sec}, {"nanoseconds", status.st_mtim.tv_nsec}};
}

// Renders rays with the blocks of a scene that this rank owns.
class RayServer {
 public:
  RayServer(const std::filesystem::path& scene_h5, const json& part)
      : threads_(part.at("threads").get<int>()),
        store_(OpenStore(scene_h5, part.at("memory_bytes").get<double>())),
        segments_(store_.Blocks()),
        rays_(store_, segments_, threads_),
        number_(part.at("number").get<int>()),
        owner_(part.at("owner").get<std::vector<int>>()) {
    SKYQUILT_CHECK(owner_.size() == static_cast<size_t>(store_.size()), "all ranks see the same scene");
  }

  RayReply Carry(RayRequest request) {
    RayReply reply{.id = request.id, .in_flight = {}, .colors = {}, .failure = {}};
    try {
      for (scene::RayInFlight& ray_in_flight : request.in_flight) ray_in_flight.owner = number_;
      reply.samples = rays_.Continue(request.rays, request.in_flight, request.options, number_, Owner());
      for (const scene::RayInFlight& ray_in_flight : request.in_flight) {
        if (ray_in_flight.owner == scene::kFinished) reply.colors.push_back(render::FinalColor(ray_in_flight.state));
      }
      reply.in_flight = std::move(request.in_flight);
    } catch (...) {
      reply.failure = CurrentFailure();
    }
    reply.field_loads = store_.loads();
    return reply;
  }
  base::ThreadPool& threads() { return threads_; }

 private:
  scene::PagedRenderer::Owner Owner() const {
    const bool alone = std::all_of(owner_.begin(), owner_.end(), [this](int number) { return number == number_; });
    if (alone) return {};
    return [this](std::span<const int> blocks) { return OwnerOf(owner_, blocks, number_); };
  }
  static scene::FieldStore OpenStore(const std::filesystem::path& scene_h5, double memory_bytes) {
    checkpoint::ArchiveReader reader = scene::OpenScene(scene_h5);
    const bool hard = scene::BordersOf(reader) == scene::Borders::kHard;
    return {std::move(reader), scene_h5, memory_bytes, hard};
  }

  base::ThreadPool threads_;
  scene::FieldStore store_;
  render::RaySegments segments_;
  scene::PagedRenderer rays_;
  int number_;
  std::vector<int> owner_;
};

}  // namespace

std::string RenderingSetup(const std::filesystem::path& scene_h5, const RunOptions& options, bool verbose, bool quiet) {
  const json setup = {{"scene", std::filesystem::absolute(scene_h5).string()},
                      {"threads", options.threads},
                      {"memory_gb", options.memory_gb},
                      {"memory_share", options.memory_share},
                      {"file", LookAt(scene_h5)},
                      {"verbose", verbose},
                      {"quiet", quiet}};
  return base::JsonText(setup);
}

void ServeRays(comm::Communicator& comm, const std::string& setup_text) {
  ServeRankGroup(comm, [&](json& hello) {
    const json setup = base::ParseJson(setup_text);
    base::InitLog(setup.at("verbose").get<bool>(), "rank " + std::to_string(comm.rank()));
    if (setup.at("quiet").get<bool>()) base::SetLogLevel(base::LogLevel::kWarning);
    base::Progress::SetQuiet(true);
    RunOptions options;
    options.threads = setup.at("threads").get<int>();
    options.memory_gb = setup.at("memory_gb").get<double>();
    options.memory_share = setup.at("memory_share").get<double>();
    const std::filesystem::path scene_h5 = setup.at("scene").get<std::string>();
    // Checked before Register, so that rank 0 hears of it before it sends rays.
    if (!std::filesystem::exists(scene_h5)) throw base::InputError(scene_h5, "no such file", "All ranks must see the same project folder");
    if (LookAt(scene_h5) != setup.at("file")) {
      throw base::InputError(scene_h5, "is not the file that rank 0 sees", "Wait until all hosts see the same file, then try again");
    }
    hello["threads"] = options.UsableThreads();
    hello["memory_bytes"] = options.MemoryLimitBytes();
    const json part = base::ParseJson(Register(comm, hello, kTagAssignment));
    RayServer server(scene_h5, part);
    std::unique_ptr<PartMaker> maker;
    while (true) {
      const comm::Message message = WaitForMessage(comm);
      if (message.tag == kTagDone) return;
      if (message.tag == kTagJobEnd) maker.reset();
      if (message.tag == kTagRays) comm.Send(0, kTagRayReply, ToBytes(server.Carry(RayRequestFromBytes(message.bytes))));
      if (message.tag == kTagJobOpen) {
        maker.reset();
        comm.Send(0, kTagJobReady, OpenJob(message.bytes, part.at("memory_bytes").get<double>(), server.threads(), &maker));
      }
      if (message.tag == kTagParts && maker) comm.Send(0, kTagPartsMade, AnswerParts(*maker, message.bytes));
      // Otherwise the reply might stay unsent while this rank works on the next request.
      comm.WaitUntilSent();
    }
  });
}

}  // namespace skyquilt::coordinator
