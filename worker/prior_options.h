// Options of the priors: losses that say what surfaces usually are, where colour alone does not. Section [priors]; only blocks are trained with them.
// What the defaults are worth: docs/benchmarks.md.
#pragma once

#include <vector>

#include "core/config/options.h"

namespace skyquilt::worker {

struct PriorOptions {
  // Weights relative to the photo loss; 0: off.
  double planar = 0.0;       // rays of one segment of a photo end on a plane (RobustLoss)
  double upright = 0.0;      // and that plane is level or vertical when it nearly is, and vertical ones follow the direction of the buildings there
  double planes = 0.01;      // rays that end near a plane of sparse points (worker/planes/point_planes.h) end on it
  double points = 0.05;      // rays towards sparse points end there (worker/losses/point_depth_loss.h)
  double free_space = 0.0;   // such rays lose no light well before their point (AddFreeSpaceLoss)
  double normals = 0.0;      // normals of the density, of a predicting head and of planes of sparse points agree (worker/losses/normal_loss.h)
  double orientation = 0.0;  // the density's normals face the camera
  // The weights are 0 up to the share `from` of the budget and rise linearly to their full size at `until`. Those of points and free_space fall
  // linearly from there to 0 at `points_end`: points bring surfaces near to where they belong, but in the end make them thinner than the steps that
  // sample them.
  double from = 0.3;
  double until = 0.6;
  double points_end = 0.8;
  double segment_share = 0.1;  // of the rays, for all but planes and points
  double point_share = 0.1;    // of the rays, for points

  // All weights 0.
  static PriorOptions Off();
  // Whether rays are drawn in groups within segments.
  bool Segments() const { return planar > 0.0 || upright > 0.0 || normals > 0.0 || orientation > 0.0; }
  // Whether planes of sparse points are needed.
  bool Planes() const { return planes > 0.0 || normals > 0.0; }
  // Whether rays are drawn towards sparse points.
  bool Points() const { return points > 0.0 || free_space > 0.0; }
  // Share of the full weights, 0..1; of points and free_space. progress: of the budget, 0..1.
  double Strength(double progress) const;
  double PointStrength(double progress) const;

  static std::vector<config::Field<PriorOptions>> Fields();
  // Throws base::UsageError that names the option and its rule.
  void Check(const std::string& section) const;
};

}  // namespace skyquilt::worker
