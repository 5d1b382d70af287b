// Paints the cells of a raster with one ray each: pictures of a scene along parallel rays, from above (map_products.h) or straight on a wall
// (elevation.h).
#pragma once

#include <cstdint>
#include <vector>

#include "products/ray_caster.h"

namespace skyquilt::products {

// Cells of consecutive rows.
struct PaintedCells {
  std::vector<uint8_t> rgba;  // display values; alpha 0 where the scene has no surface, otherwise 255
  std::vector<float> place;   // of the surface along the cell's line, metres
};

class CellPainter {
 public:
  // Keeps a reference to the caster. min_opacity: cells with a lower opacity stay as they are. rays_per_call: of the caster, at least 1.
  CellPainter(const RayCaster& caster, double min_opacity, size_t rays_per_call = RaysPerCall(1))
      : caster_(caster), min_opacity_(min_opacity), rays_per_call_(rays_per_call) {}

  // The place of the surface becomes start_m - depth along the ray. Renders when many rays wait; Finish renders the rest, before other cells follow.
  void Add(const render::Ray& ray, size_t cell, double start_m, PaintedCells* cells);
  void Finish(PaintedCells* cells);
  // Cells that got colours so far.
  int64_t painted() const { return painted_; }

 private:
  const RayCaster& caster_;
  double min_opacity_;
  size_t rays_per_call_;
  int64_t painted_ = 0;
  // Rays that wait to be rendered, and the cells their results belong to.
  std::vector<render::Ray> rays_;
  std::vector<size_t> cell_;
  std::vector<double> start_m_;
  std::vector<render::RayColor> colors_;
};

}  // namespace skyquilt::products
