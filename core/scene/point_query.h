// What a scene says at single points, for those who ask for places instead of pictures: density and colour of all its fields together, blended as in
// renderings.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>

#include "core/base/thread_pool.h"
#include "core/render/ground_index.h"
#include "core/render/point_query.h"
#include "core/scene/field_store.h"

namespace skyquilt::scene {

struct PointColor {
  float density = 0.0F;  // optical depth per metre; 0 where a rendering takes no samples; NaN for a point that is not finite
  // Display values at reference exposure, as the plain rendition of a concealing field has them: the fields' colours by their densities. NaN where
  // the density is 0, or when no colours were asked for.
  float rgb_srgb[3] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN()};
};

struct PointOptions {
  double footprint_m = 0.0;  // width of the pixel that a point stands for; 0: the finest that each field was trained with
  bool colors = true;
};

// x_in_enu: survey ENU, metres, double. direction_enu: from the viewer to the points, length 1: one for all of them or one for each. out: as many as
// points. Field by field, so that a scene larger than memory can be asked too; the same bits for any memory and number of threads. Throws
// base::Interrupted when cancelled, base::UsageError when one block and the context do not fit in memory.
void QueryPoints(FieldStore& store, const render::GroundIndex& index, std::span<const Eigen::Vector3d> x_in_enu,
                 std::span<const Eigen::Vector3d> direction_enu, const PointOptions& options, std::span<PointColor> out, base::ThreadPool& threads);

}  // namespace skyquilt::scene
