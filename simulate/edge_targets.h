// Slanted-edge targets, from which the sharpness of a map or a photo is measured (MTF): squares on open ground, one half black, the other white.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/enu_frame.h"
#include "simulate/flight.h"
#include "simulate/place_spec.h"
#include "simulate/target_paint.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

struct EdgeTarget {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // on the ground; ENU metres
  PaintedTarget paint;                               // the line between both halves is 5 degrees counter-clockwise of the map's north
};

// `wanted` targets, or fewer where there is no room: in the sun, off the roads, away from `others`, seen by at least kMinTargetViews photos, each far
// from those before it. They are 60 pixels of the photos wide and at least 4 m; smaller, down to 4 m, where that makes room for all of them. Their
// halves look about 40 and 215 of 255 in a normally exposed photo. The same for any number of threads.
std::vector<EdgeTarget> ChooseEdgeTargets(const World& world, const PlaceSpec& place, const std::vector<PhotoPlan>& photos,
                                          const geo::EnuFrame& frame, const std::vector<PaintedTarget>& others, int wanted,
                                          base::ThreadPool& threads);
// JSON: `targets` with `centre_enu`, `side_m`, `yaw_deg` (of one side, counter-clockwise from east) and `black_half`.
void WriteEdgeTargets(const std::vector<EdgeTarget>& targets, const std::filesystem::path& file);

}  // namespace skyquilt::simulate
