#include "worker/prior_options.h"

#include <algorithm>

#include "core/base/errors.h"

namespace skyquilt::worker {

PriorOptions PriorOptions::Off() {
  PriorOptions off;
  off.planar = off.upright = off.planes = off.points = off.normals = off.orientation = 0.0;
  return off;
}

double PriorOptions::Strength(double progress) const {
  if (progress < from || progress <= 0.0) return 0.0;
  if (progress < until) return (progress - from) / (until - from);
  if (until >= 1.0) return 1.0;
  return 1.0 + (final_share - 1.0) * std::min(1.0, (progress - until) / (1.0 - until));
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
      {"normals", &O::normals, Range{0, 1e3},
       "weight of the loss that makes normals agree: those of the density, of a predicting head and of planes of sparse points; 0: off"},
      {"orientation", &O::orientation, Range{0, 1e3}, "weight of the loss that turns the normals of the density towards the camera; 0: off"},
      {"from", &O::from, Range{0, 1}, "share of the budget up to which these weights are 0"},
      {"until", &O::until, Range{0, 1}, "share of the budget at which they have their full size; between, they grow linearly"},
      {"final_share", &O::final_share, Range{0, 1},
       "share of their full size that they have at the end, to which they fall linearly: what holds a surface may cost sharpness in long trainings"},
      {"segment_share", &O::segment_share, Range{0, 0.5},
       "share of the rays that are drawn in groups within a segment, for all but planes and points"},
      {"point_share", &O::point_share, Range{0, 0.5}, "share of the rays that are drawn towards sparse points"},
  };
}

void PriorOptions::Check(const std::string& section) const {
  config::CheckRanges(section, *this);
  if (until < from)
    throw base::UsageError(section + ".until = " + std::to_string(until) + " is not allowed: it must not be below " + section + ".from");
}

}  // namespace skyquilt::worker
