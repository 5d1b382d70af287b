// The colours of a packet's live samples, and from gradients by these to gradients by the colour network's output.
#pragma once

#include "worker/step/packet_samples.h"

namespace skyquilt::worker {

class PacketColor {
 public:
  explicit PacketColor(const PacketShared& shared) : shared_(shared) {}

  // After PacketDensity::DropHidden or KeepAll: the colour network. Writes s.a.color_raw and s.rgb.
  void Forward(PacketSamples& s) const;
  // After the losses: turns the gradients by rgb into gradients by color_raw, in place. Returns the number of colours, of samples and channels, that
  // are within 2 % of an end of their range.
  int64_t FinishGradient(PacketSamples& s) const;
  // After the networks' backward pass: writes the gradients by the codes of the packet's rays, if the step has codes.
  void SumCodeGradients(const PacketSamples& s) const;

 private:
  const PacketShared& shared_;
};

}  // namespace skyquilt::worker
