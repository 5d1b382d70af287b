// Pictures and videos of a scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/image/image.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

struct RenderStats {
  int64_t views = 0;
  int64_t rays = 0;
  double seconds = 0.0;  // rendering alone, without encoding
  double RaysPerSecond() const { return seconds > 0.0 ? static_cast<double>(rays) / seconds : 0.0; }
};

// <folder>/<name>.png: colours over black. <folder>/<name>_depth.tiff: float, metres along the ray (not along the optical axis) to where the
// transmittance passes one half, NaN where it never does. The folder is created; existing files are replaced.
// Throws base::InputError (disk) and base::Interrupted between views.
RenderStats RenderViews(const ViewRenderer& renderer, const std::vector<View>& views, const std::filesystem::path& folder, bool with_depth);

// An MP4, one frame per view. All views have the same even size (throws std::logic_error otherwise).
RenderStats RenderVideo(const ViewRenderer& renderer, const std::vector<View>& views, int fps, const std::filesystem::path& file);

image::Image8 ColorImage(const std::vector<render::RayColor>& colors, int width, int height);
image::ImageF DepthImage(const std::vector<render::RayColor>& colors, int width, int height);

}  // namespace skyquilt::products
