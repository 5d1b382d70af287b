#include "products/cell_painter.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::products {
namespace {

uint8_t ToByte(float display_value) {
  return static_cast<uint8_t>(std::lround(255.0F * std::clamp(display_value, 0.0F, 1.0F)));
}

}  // namespace

void CellPainter::Add(const render::Ray& ray, size_t cell, double start_m, PaintedCells* cells) {
  rays_.push_back(ray);
  cell_.push_back(cell);
  start_m_.push_back(start_m);
  if (rays_.size() == rays_per_call_) Finish(cells);
}

void CellPainter::Finish(PaintedCells* cells) {
  colors_.assign(rays_.size(), {});
  caster_(rays_, colors_);
  for (size_t i = 0; i < rays_.size(); ++i) {
    const render::RayColor& color = colors_[i];
    if (!(static_cast<double>(color.opacity) >= min_opacity_)) continue;
    const size_t cell = cell_[i];
    // Rendered colours are premultiplied by opacity; the alpha of cells is 0 or 255.
    for (size_t c = 0; c < 3; ++c) {
      const float straight = color.rgb_srgb[c] / color.opacity;
      cells->rgba[4 * cell + c] = std::isfinite(straight) ? ToByte(straight) : uint8_t{0};
    }
    cells->rgba[4 * cell + 3] = 255;
    // With a least opacity below one half a ray may have no median depth.
    const float depth = std::isfinite(color.depth_median) ? color.depth_median : color.depth;
    if (std::isfinite(depth)) cells->place[cell] = static_cast<float>(start_m_[i] - static_cast<double>(depth));
    ++painted_;
  }
  rays_.clear();
  cell_.clear();
  start_m_.clear();
}

}  // namespace skyquilt::products
