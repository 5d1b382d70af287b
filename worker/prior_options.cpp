#include "worker/prior_options.h"

#include <algorithm>

#include "core/base/errors.h"

namespace skyquilt::worker {

PriorOptions PriorOptions::Off() {
  PriorOptions off;
  off.planar = off.upright = off.planes = off.points = off.free_space = off.normals = off.orientation = 0.0;
  return off;
}

double PriorOptions::Strength(double progress) const {
  if (progress < from || progress <= 0.0) return 0.0;
  return progress < until ? (progress - from) / (until - from) : 1.0;
}

double PriorOptions::PointStrength(double progress) const {
  if (progress >= points_end) return 0.0;
  return Strength(progress) * std::min(1.0, (points_end - progress) / (points_end - until));
}

std::vector<config::Field<PriorOptions>> PriorOptions::Fields() {
  using config::Range;
  using O = PriorOptions;
  return {
      {"planar", &O::planar, Range{0, 1e3}, "weight of the loss that makes the surface plane within segments of a photo; 0: off"},
      {"upright", &O::upright, Range{0, 1e3},
       "weight of the loss that makes such planes level or vertical when they nearly are, and walls follow the direction of the buildings there; 0: "
       "off"},
      {"planes", &O::planes, Range{0, 1e3}, "weight of the loss that brings the surface onto planes of sparse points; 0: off"},
      {"points", &O::points, Range{0, 1e3}, "weight of the loss that brings the surface to the sparse points; 0: off"},
      {"free_space", &O::free_space, Range{0, 1e3},
       "weight of the loss that lets light pass well before the sparse points that a photo shows; 0: off"},
      {"normals", &O::normals, Range{0, 1e3},
       "weight of the loss that makes normals agree: those of the density, of a predicting head and of planes of sparse points; 0: off"},
      {"orientation", &O::orientation, Range{0, 1e3}, "weight of the loss that turns the normals of the density towards the camera; 0: off"},
      {"from", &O::from, Range{0, 1}, "share of the budget up to which these weights are 0"},
      {"until", &O::until, Range{0, 1}, "share of the budget at which they have their full size; between, they grow linearly"},
      {"points_end", &O::points_end, Range{0, 1},
       "share of the budget at which the weights of points and free_space have fallen back to 0: to the end, points would cost sharpness"},
      {"segment_share", &O::segment_share, Range{0, 0.5},
       "share of the rays that are drawn in groups within a segment, for all but planes and points"},
      {"point_share", &O::point_share, Range{0, 0.5}, "share of the rays that are drawn towards sparse points"},
  };
}

void PriorOptions::Check(const std::string& section) const {
  config::CheckRanges(section, *this);
  if (until < from)
    throw base::UsageError(section + ".until = " + std::to_string(until) + " is not allowed: it must not be below " + section + ".from");
  if (points_end < until)
    throw base::UsageError(section + ".points_end = " + std::to_string(points_end) + " is not allowed: it must not be below " + section + ".until");
}

}  // namespace skyquilt::worker
