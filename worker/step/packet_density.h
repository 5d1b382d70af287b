// From the features of a packet's samples to optical depths, and from gradients by these to gradients by the networks' output.
#pragma once

#include "worker/step/packet_samples.h"

namespace skyquilt::worker {

// Upper limit of the logarithm of tau of a step, so that densities and their gradients stay finite.
constexpr float kMaxLogTau = 15.0F;

class PacketDensity {
 public:
  explicit PacketDensity(const PacketShared& shared) : shared_(shared) {}

  // First: the density network. Writes the geometry rows of s.a.
  void Forward(PacketSamples& s);
  // Then: keeps only the samples that light reaches and moves them to the front, because samples behind an opaque surface get neither colour nor
  // gradient. Writes s.live, s.views, s.tau and step.observed.
  void DropHidden(PacketSamples& s);
  // Or: keeps all. Writes s.views.
  static void KeepAll(PacketSamples& s);
  // After the losses: turns the gradients by tau into gradients by the log density, in place. Returns the number of samples that are far denser than
  // opaque.
  int64_t FinishGradient(PacketSamples& s) const;

 private:
  field::DensityActivation Activation() const { return shared_.field.config().density_activation; }
  // Finds the samples of a ray that light reaches and writes their optical depths to s.tau from first_live. Returns their number.
  int64_t LiveSamples(PacketSamples& s, size_t view, int64_t first_live);

  const PacketShared& shared_;
  std::vector<float> depth_, keep_;  // per sample before any is dropped: tau of a marching step; 1 for those to keep, else 0
  std::vector<float> slope_;         // per live sample: d tau / d log density; with exp it is tau and not kept here
};

}  // namespace skyquilt::worker
