// Messages that carry rays from rank 0 to a rank that renders them, and back. All ranks must run the same program on machines of one byte order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "coordinator/ranks/failure.h"
#include "core/scene/paged_renderer.h"

namespace skyquilt::coordinator {

// To a rank: render these rays as far as its blocks reach.
struct RayRequest {
  uint64_t id = 0;
  render::EngineOptions options;
  std::vector<render::Ray> rays;
  std::vector<scene::RayInFlight> in_flight;  // one per ray
};

// The answer, in the order of the request's rays.
struct RayReply {
  uint64_t id = 0;                            // of the request
  int64_t samples = 0;                        // evaluated for this request
  int64_t field_loads = 0;                    // fields this rank has loaded from the scene file since it opened it
  std::vector<scene::RayInFlight> in_flight;  // one per ray; of finished rays (owner = kFinished) the other members are not sent
  std::vector<render::RayColor> colors;       // of the finished rays, in order
  Failure failure;                            // when set, there are no rays
};

// How many of the rays of one call a request gets: enough to keep a rank's cores busy while the next request is on its way, and so few that every
// rank gets several, or at least one.
constexpr size_t RaysPerRequest(size_t rays, int ranks) {
  constexpr size_t kFewest = 512, kMost = size_t{1} << 14U, kRequestsOfRank = 4;
  return std::clamp(rays / (kRequestsOfRank * static_cast<size_t>(ranks)), kFewest, kMost);
}

// A ray takes 24 bytes when the rays of the request differ only in direction and none has been rendered in part; otherwise at most 152, or with
// normals 176.
std::string ToBytes(const RayRequest& request);
std::string ToBytes(const RayReply& reply);
// Throw std::runtime_error for bytes that are not such a message.
RayRequest RayRequestFromBytes(const std::string& bytes);
RayReply RayReplyFromBytes(const std::string& bytes);

}  // namespace skyquilt::coordinator
