// Renders images and videos of a scene to files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/trust/trust.h"
#include "products/normal_pictures.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

struct RenderStats {
  int64_t views = 0;
  int64_t rays = 0;
  double seconds = 0.0;  // rendering alone, without encoding
  double RaysPerSecond() const { return seconds > 0.0 ? static_cast<double>(rays) / seconds : 0.0; }
};

// What is written beside the colours of a view.
struct ViewImages {
  bool depth = true;
  std::optional<NormalKind> normals;
  const trust::Trust* trust = nullptr;  // null: no errors to expect
  bool cones = false;                   // of the scene (scene::Scales::Cones), for `trust`
};

// Writes <folder>/<name>.png (colours on black) and, if chosen, <folder>/<name>_depth.tiff: float, metres along the ray (not along the optical axis)
// to where the transmittance falls below one half, NaN where it never does; <folder>/<name>_normals.png (core/image/normal_image.h); and
// <folder>/<name>_trust.tiff and _trust.png: the error to expect (trust::TrustPicture), as numbers and as colours up to trust::kTopError. The folder
// is created; existing files are replaced. Throws base::InputError when a file cannot be written, and base::Interrupted between views.
RenderStats RenderViews(const ViewRenderer& renderer, const std::vector<View>& views, const std::filesystem::path& folder, const ViewImages& images,
                        base::ThreadPool& threads);

// Writes an MP4 with one frame per view. Throws std::logic_error unless all views have the same size with even width and height.
RenderStats RenderVideo(const ViewRenderer& renderer, const std::vector<View>& views, int fps, const std::filesystem::path& file);

// Images of rendered pixels, row-major: display values on black; median depth in metres along the ray, NaN where there is none.
image::Image8 ColorImage(const std::vector<render::RayColor>& colors, int width, int height);
image::ImageF DepthImage(const std::vector<render::RayColor>& colors, int width, int height);

}  // namespace skyquilt::products
