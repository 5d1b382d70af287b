#include "products/render_views.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/image/normal_image.h"
#include "core/image/video_writer.h"
#include "core/scene/camera_rays.h"

namespace skyquilt::products {
namespace {

// Renders one view and adds it to the statistics.
std::vector<render::RayColor> Render(const ViewRenderer& renderer, const View& view, RenderStats* stats) {
  base::ThrowIfCancelled();
  const auto begin = std::chrono::steady_clock::now();
  std::vector<render::RayColor> colors = renderer(view);
  stats->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  stats->rays += static_cast<int64_t>(colors.size());
  ++stats->views;
  return colors;
}

image::ImageF ErrorsToExpect(const ViewImages& images, const View& view, const std::vector<render::RayColor>& colors, base::ThreadPool& threads) {
  const scene::CameraRays camera(view.camera, view.cam_from_enu, images.cones);
  const trust::RowRays rays = [&](int row, std::span<render::Ray> of_row) { camera.MakeRow(row, of_row); };
  return trust::TrustOf(*images.trust, view.camera.width, view.camera.height, colors, rays, threads).error;
}

std::string RateText(const RenderStats& stats) {
  return base::FormatCount(stats.RaysPerSecond()) + " rays/s";
}

}  // namespace

image::Image8 ColorImage(const std::vector<render::RayColor>& colors, int width, int height) {
  image::Image8 picture(width, height, 3);
  SKYQUILT_CHECK(colors.size() * 3 == picture.data.size(), std::to_string(colors.size()));
  for (size_t i = 0; i < colors.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = colors[i].rgb_srgb[c];
      picture.data[3 * i + c] = std::isfinite(value) ? static_cast<uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))) : uint8_t{0};
    }
  }
  return picture;
}

image::ImageF DepthImage(const std::vector<render::RayColor>& colors, int width, int height) {
  image::ImageF depth(width, height, 1);
  SKYQUILT_CHECK(colors.size() == depth.data.size(), std::to_string(colors.size()));
  std::transform(colors.begin(), colors.end(), depth.data.begin(), [](const render::RayColor& color) { return color.depth_median; });
  return depth;
}

RenderStats RenderViews(const ViewRenderer& renderer, const std::vector<View>& views, const std::filesystem::path& folder, const ViewImages& images,
                        base::ThreadPool& threads) {
  RenderStats stats;
  base::RequireWritableFolder(folder);
  base::Progress progress("render", static_cast<double>(views.size()), "views");
  for (const View& view : views) {
    const std::vector<render::RayColor> colors = Render(renderer, view, &stats);
    image::SavePng(ColorImage(colors, view.camera.width, view.camera.height), folder / (view.name + ".png"));
    if (images.depth) image::SaveFloatTiff(DepthImage(colors, view.camera.width, view.camera.height), folder / (view.name + "_depth.tiff"));
    if (images.normals) image::SaveNormals(NormalsOfView(*images.normals, view, colors, threads), folder / (view.name + "_normals.png"));
    if (images.trust != nullptr) {
      const image::ImageF error = ErrorsToExpect(images, view, colors, threads);
      image::SaveFloatTiff(error, folder / (view.name + "_trust.tiff"));
      image::SavePng(image::Colorize(error, 0.0F, trust::kTopError), folder / (view.name + "_trust.png"));
    }
    progress.Advance(1.0, RateText(stats));
  }
  progress.Finish(RateText(stats));
  return stats;
}

RenderStats RenderVideo(const ViewRenderer& renderer, const std::vector<View>& views, int fps, const std::filesystem::path& file) {
  SKYQUILT_CHECK(!views.empty(), "a video without frames");
  RenderStats stats;
  if (file.has_parent_path()) base::RequireWritableFolder(file.parent_path());
  image::VideoWriter video(file, views.front().camera.width, views.front().camera.height, fps);
  base::Progress progress("video", static_cast<double>(views.size()), "frames");
  for (const View& view : views) {
    video.Write(ColorImage(Render(renderer, view, &stats), view.camera.width, view.camera.height));
    progress.Advance(1.0, RateText(stats));
  }
  video.Close();
  progress.Finish(RateText(stats));
  return stats;
}

}  // namespace skyquilt::products
