// Scenes of several blocks, and rays of every kind through them.
#pragma once

#include <rapidcheck.h>

#include <vector>

#include "core/render/ray_engine.h"
#include "tests/support/random_field.h"

namespace skyquilt::render {

// rows x columns blocks of 5 m x 5 m and of heights between 2 and 5 m from (0, 0) on, with a context around them if wanted.
struct BlockScene {
  BlockScene(int rows, int columns, double margin_m, bool hard_borders, bool with_context) {
    constexpr double kEdge_m = 5.0;
    blocks.reserve(static_cast<size_t>(rows) * static_cast<size_t>(columns));
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const Eigen::Vector3d low(kEdge_m * column, kEdge_m * row, 0.3 * (column % 3));
        const Eigen::Vector3d high(kEdge_m * (column + 1), kEdge_m * (row + 1), 2.0 + row % 4);
        blocks.push_back(RandomField(100 + blocks.size(), low, high, margin_m, -2.0));
        if (hard_borders) blocks.back().blend_m = 0.0;
      }
    }
    for (const TrainedField& block : blocks) fields.blocks.push_back(&block);
    if (!with_context) return;
    context.push_back(RandomField(7, {0.0, 0.0, -0.5}, {kEdge_m * columns, kEdge_m * rows, 6.0}, 0.0, -3.0, true));
    fields.context = &context.front();
  }
  BlockScene(const BlockScene&) = delete;

  std::vector<TrainedField> blocks, context;
  FieldSet fields;
};

// Scenes with margins and without, hard borders, with and without a context, and of one block.
inline const std::vector<const BlockScene*>& BlockScenes() {
  static const BlockScene smooth(4, 5, 0.6, false, true), hard(3, 4, 0.6, true, true), touching(4, 4, 0.0, false, true),
      alone(1, 1, 1.0, false, true), bare(5, 3, 1.2, false, false);
  static const std::vector<const BlockScene*> all = {&smooth, &hard, &touching, &alone, &bare};
  return all;
}

// From inside, above, below and far outside; often along an axis, a border or a diagonal; sometimes only a part of the ray.
inline Ray AnyRay() {
  Ray ray;
  const auto coordinate = [] { return *rc::gen::element(1.0, 0.1, 10.0) * 0.5 * *rc::gen::inRange(-20, 61); };
  ray.origin_enu.x() = coordinate();
  ray.origin_enu.y() = coordinate();
  ray.origin_enu.z() = 0.25 * *rc::gen::inRange(-8, 60);
  do {
    for (int axis = 0; axis < 3; ++axis) ray.direction_enu[axis] = *rc::gen::element(0.0, 0.0, 1.0, -1.0, 0.37, -0.81, 1e-9, -0.05);
  } while (ray.direction_enu.norm() < 1e-3);
  ray.direction_enu.normalize();
  if (*rc::gen::inRange(0, 4) == 0) {
    ray.t_near = 0.5 * *rc::gen::inRange(0, 20);
    ray.t_far = ray.t_near + 0.5 * *rc::gen::inRange(0, 40);
  }
  if (*rc::gen::inRange(0, 3) == 0) ray.pixel_pitch = 0.02F;
  return ray;
}

}  // namespace skyquilt::render
