// A field with its parameters, occupancy and place in the survey: what training leaves behind and rendering reads.
#pragma once

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
  geo::BlockBox box;     // whose ground it answers for; of a block, the map spans it with its margin
  double blend_m = 0.0;  // half width of the ramp at its faces; BuildNetworks() makes it the margin, 0 is a hard border
  double step_m = 0.1;   // marching step inside the uncontracted part = the length that log density refers to
  field::Parameters parameters;
  field::OccupancyGrid occupancy;
  // Training record.
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;

  // Built from the above by BuildNetworks().
  std::unique_ptr<field::HashField> field;
  field::NetworkWeights weights;
  void BuildNetworks();
  int64_t ParameterCount() const { return static_cast<int64_t>(parameters.Count()); }
};

}  // namespace skyquilt::render
