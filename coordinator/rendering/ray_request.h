// Rays on their way between ranks, as bytes. All ranks run the same program on machines of one byte order.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coordinator/ranks/failure.h"
#include "core/scene/paged_rays.h"

namespace skyquilt::coordinator {

// To a rank: take these rays on.
struct RayRequest {
  uint64_t id = 0;
  render::EngineOptions options;
  std::vector<render::Ray> rays;
  std::vector<scene::RayInFlight> in_flight;  // one per ray
};

// Back from it: in the order of the request's rays.
struct RayReply {
  uint64_t id = 0;
  int64_t samples = 0;
  int64_t field_loads = 0;                    // of the rank, so far
  std::vector<scene::RayInFlight> in_flight;  // of arrived ones only `owner` counts
  std::vector<render::RayColor> colors;       // of arrived ones, in order
  Failure failure;                            // with it no rays come back
};

// Rays of one camera share most numbers, and fresh ones need none: 24 bytes per ray then, at most 152.
std::string ToBytes(const RayRequest& request);
std::string ToBytes(const RayReply& request);
// Throw std::runtime_error on bytes that are not theirs.
RayRequest RayRequestFromBytes(const std::string& bytes);
RayReply RayReplyFromBytes(const std::string& bytes);

}  // namespace skyquilt::coordinator
