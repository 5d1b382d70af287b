// A radiance field with its parameters, occupancy grid and place in the survey: written by training, read by rendering.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "core/encoding/space_map.h"
#include "core/field/hash_field.h"
#include "core/field/occupancy_grid.h"
#include "core/field/parameters.h"
#include "core/geo/block_box.h"

namespace skyquilt::render {

struct TrainedField {
  std::string name;
  field::FieldConfig config;
  encoding::SpaceMap map;
  geo::BlockBox box;     // its core box; the map of a block covers the core box and its margin
  double blend_m = 0.0;  // half width of the blending ramp at the faces of the core box; BuildNetworks() sets it to the margin; 0: hard border
  double step_m = 0.1;   // marching step without contraction, metres; log density refers to this length
  field::Parameters parameters;
  field::OccupancyGrid occupancy;
  // Widths of the footprints with which a field with cones was trained, metres (core/render/footprint.h).
  double footprint_min_m = 0.0, footprint_max_m = std::numeric_limits<double>::infinity();
  // Training record.
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;  // evaluated in all steps together

  // Built from the above by BuildNetworks().
  std::unique_ptr<field::HashField> field;
  field::NetworkWeights weights;
  void BuildNetworks();
  int64_t ParameterCount() const { return static_cast<int64_t>(parameters.Count()); }
};

}  // namespace skyquilt::render
