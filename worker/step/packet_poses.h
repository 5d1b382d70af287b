// From the gradients of a packet's features and directions to those of its rays. Distances, lengths and footprints of samples count as constant, and
// the positions of a sample move together. Needs an encoding with slopes (encoding::Encoding::HasSlope).
#pragma once

#include "worker/step/packet_samples.h"

namespace skyquilt::worker {

class PacketPoses {
 public:
  explicit PacketPoses(const PacketShared& shared) : shared_(shared) {}

  // After the networks' backward pass, with s.a.by_direction: writes s.step->ray_gradients of the packet's rays.
  void Add(const PacketSamples& s);

 private:
  const PacketShared& shared_;
  std::vector<float> by_position_, of_part_;  // 3 rows of the packet's stride, unit frame
};

}  // namespace skyquilt::worker
