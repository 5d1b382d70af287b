// Fields with random parameters and occupancy, for tests of rendering that need no trained scene.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/random.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// A block with the core box [low, high], metres. A larger density_bias gives higher densities. `contracted`: mapped like a context.
inline TrainedField RandomField(uint64_t seed, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double margin_m, double density_bias,
                                bool contracted = false, encoding::Kind encoding = encoding::Kind::kHash, int density_hidden_layers = 1) {
  TrainedField f;
  f.box.min_enu = low;
  f.box.max_enu = high;
  f.box.margin_m = margin_m;
  const Eigen::Vector3d map_min = f.box.TrainMin(), map_max = f.box.TrainMax();
  f.map = contracted ? encoding::SpaceMap::Contracted(map_min, map_max) : encoding::SpaceMap::Box(map_min, map_max);
  f.step_m = 0.25;
  f.config.encoding = encoding;
  f.config.density_hidden_layers = density_hidden_layers;
  f.config.grid.levels = 4;
  f.config.grid.log2_table_size = 10;
  f.config.grid.base_resolution = 4;
  f.config.grid.finest_resolution = 32;
  for (int axis = 0; axis < 3; ++axis) f.config.grid.extent[axis] = std::min(1.0, f.map.extent()[axis]);
  f.config.hidden = 16;
  f.config.density_bias = density_bias;
  f.occupancy = field::OccupancyGrid::Make(f.config.grid.extent, 0.5 * f.map.units_per_metre(), 100'000);
  base::Random random(seed);
  const field::HashField shape(f.config);
  f.parameters.grid.resize(static_cast<size_t>(shape.GridParameters()));
  f.parameters.networks.resize(static_cast<size_t>(shape.NetworkParameters()));
  shape.Initialize(random, f.parameters.grid, f.parameters.networks);
  for (float& value : f.parameters.grid) value = 4.0F * (random.Uniform() - 0.5F);
  for (auto&& cell : f.occupancy.occupied) cell = random.Uniform() < 0.7F;
  f.BuildNetworks();
  return f;
}

// The same field with a normal head of random weights.
inline TrainedField WithHead(TrainedField f, uint64_t seed) {
  base::Random random(seed);
  f.config.normal_head = true;
  for (int i = 0; i < field::kNormalRows * field::kGeometryRows; ++i) {
    f.parameters.networks.push_back(i < 3 * field::kGeometryRows ? random.Uniform() - 0.5F : 0.0F);
  }
  f.BuildNetworks();
  return f;
}

}  // namespace skyquilt::render
