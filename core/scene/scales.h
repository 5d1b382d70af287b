// Which scales a scene knows: the widths of the footprints with which its blocks were trained (core/render/footprint.h), and the warning of
// renderings far beyond them.
#pragma once

#include <span>

#include "core/checkpoint/archive.h"
#include "core/render/ray.h"

namespace skyquilt::scene {

struct Scales {
  int multisample = 0;                                  // positions per sample, the most of all blocks; 0: points, without footprints
  double footprint_min_m = 0.0, footprint_max_m = 0.0;  // metres per pixel, of all blocks; 0 for points

  bool Cones() const { return multisample > 0; }
};

// Of a scene's blocks, from their attributes.
Scales GetScales(const checkpoint::ArchiveReader& scene);

// Logs one warning when many pixels are more than twice as wide as the widest, or less than half as wide as the narrowest footprint that was trained.
class ScaleCheck {
 public:
  explicit ScaleCheck(const Scales& scales) : scales_(scales) {}
  // rays and colors have the same length.
  void Check(std::span<const render::Ray> rays, std::span<const render::RayColor> colors);

 private:
  Scales scales_;
  bool warned_ = false;
};

}  // namespace skyquilt::scene
