// Renders the context along a packet's rays: in front of the block's ground plan and, where light passes through the block, behind it. Only for
// blocks that are trained in front of one.
#pragma once

#include <utility>
#include <vector>

#include "core/render/ray_engine.h"
#include "worker/step/packet_samples.h"

namespace skyquilt::worker {

class PacketContext {
 public:
  // shared.context must not be null.
  explicit PacketContext(const PacketShared& shared);

  // After PacketDensity::DropHidden, before the losses. Writes the colours in front and behind to s.views.
  void Render(PacketSamples& s);

 private:
  void AddPieces(const PacketSamples& s, size_t view);

  const PacketShared& shared_;
  render::RayRenderer renderer_;
  // Intervals of rays that are rendered.
  std::vector<render::Ray> pieces_;
  std::vector<render::RayColor> colors_;
  std::vector<std::pair<size_t, bool>> owner_;  // view, and whether its interval is behind the block
};

}  // namespace skyquilt::worker
