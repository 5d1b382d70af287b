// How poses are refined while a field trains (pose_learner.h).
#pragma once

namespace skyquilt::worker {

struct PoseLearnerOptions {
  bool on = false;
  double rate_px = 0.02;  // of Adam at first, whitened units: about pixels per step of a photo; > 0
  double sigma_px = 2.0;  // of the prior, whitened units; > 0
};

}  // namespace skyquilt::worker
