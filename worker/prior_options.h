// Options of the priors: losses that say what surfaces usually are, where colour alone does not. Section [priors]; only blocks are trained with them.
#pragma once

#include <vector>

#include "core/config/options.h"

namespace skyquilt::worker {

struct PriorOptions {
  // Weights relative to the photo loss; 0: off.
  double planar = 0.0;   // rays of one segment of a photo end on a plane (worker/losses/robust_loss.h)
  double upright = 0.0;  // and that plane is level or vertical when it nearly is
  double points = 0.0;   // rays towards sparse points end there (worker/losses/point_depth_loss.h)
  // The weights are 0 up to the share `from` of the budget, and rise linearly to their full size at `until`.
  double from = 0.3;
  double until = 0.6;
  double segment_share = 0.1;  // of the rays, for planar and upright
  double point_share = 0.05;   // of the rays, for points

  bool Segments() const { return planar > 0.0 || upright > 0.0; }
  bool On() const { return Segments() || points > 0.0; }
  // Share of the full weights, 0..1. progress: of the budget, 0..1.
  double Strength(double progress) const;

  static std::vector<config::Field<PriorOptions>> Fields();
  // Throws base::UsageError that names the option and its rule.
  void Check(const std::string& section) const;
};

}  // namespace skyquilt::worker
