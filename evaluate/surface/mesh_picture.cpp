#include "evaluate/surface/mesh_picture.h"

#include <algorithm>
#include <limits>

#include "core/base/cancel.h"

namespace skyquilt::evaluate::surface {

SurfacePainter::SurfacePainter(const SurfaceMesh& mesh, int64_t cache_bytes)
    : mesh_(mesh), traced_(mesh.position, mesh.triangle), cache_bytes_(cache_bytes), texture_(mesh.atlas.size()), last_use_(mesh.atlas.size(), 0) {}

std::vector<SurfacePainter::Hit> SurfacePainter::Trace(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu,
                                                       base::ThreadPool& threads) const {
  const auto width = static_cast<size_t>(camera.width);
  std::vector<Hit> hits(width * static_cast<size_t>(camera.height));
  const Eigen::Quaterniond enu_from_cam = cam_from_enu.rotation.conjugate();
  const Eigen::Vector3f origin = (cam_from_enu.OriginInSource() - mesh_.middle).cast<float>();
  threads.ParallelFor(camera.height, [&](int64_t row, int) {
    base::ThrowIfCancelled();
    for (size_t first = 0; first < width; first += raytrace::kPacket) {
      raytrace::RayPacket rays{};
      const size_t n = std::min(raytrace::kPacket, width - first);
      for (size_t lane = 0; lane < n; ++lane) {
        const Eigen::Vector2d pixel(static_cast<double>(first + lane) + 0.5, static_cast<double>(row) + 0.5);
        const Eigen::Vector3d direction = enu_from_cam * camera.RayFromImg(pixel);
        rays.Set(lane, origin, direction.cast<float>(), 0.0F, std::numeric_limits<float>::infinity());
      }
      const uint32_t hit = traced_.Intersect(rays);
      for (size_t lane = 0; lane < n; ++lane) {
        if ((hit >> lane & 1U) == 0) continue;
        hits[static_cast<size_t>(row) * width + first + lane] = {rays.triangle[lane], rays.u[lane], rays.v[lane]};
      }
    }
  });
  return hits;
}

void SurfacePainter::Color(const Hit& hit, const image::Image8& texture, render::RayColor* color) const {
  const auto& corner = mesh_.triangle[hit.triangle];
  const Eigen::Vector2f uv = (1.0F - hit.u - hit.v) * mesh_.uv[corner[0]] + hit.u * mesh_.uv[corner[1]] + hit.v * mesh_.uv[corner[2]];
  // Positions between the middles of the pixels. NaN and what lies outside become the nearest pixel.
  const auto place = [](float share, int size) {
    const float at = share * static_cast<float>(size) - 0.5F;
    return at > 0.0F ? std::min(at, static_cast<float>(size - 1)) : 0.0F;
  };
  const float x = place(uv.x(), texture.width), y = place(uv.y(), texture.height);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, texture.width - 1), y1 = std::min(y0 + 1, texture.height - 1);
  const float right = x - static_cast<float>(x0), lower = y - static_cast<float>(y0);
  const uint8_t *a = texture.At(x0, y0), *b = texture.At(x1, y0), *c = texture.At(x0, y1), *d = texture.At(x1, y1);
  for (int i = 0; i < 3; ++i) {
    const float upper_row = (1.0F - right) * static_cast<float>(a[i]) + right * static_cast<float>(b[i]);
    const float lower_row = (1.0F - right) * static_cast<float>(c[i]) + right * static_cast<float>(d[i]);
    color->rgb_srgb[i] = ((1.0F - lower) * upper_row + lower * lower_row) / 255.0F;
  }
  color->opacity = 1.0F;
}

// Drops the textures that were not used for longest until the others fit; those in `kept` go last.
void SurfacePainter::Forget(const std::vector<size_t>& kept) {
  for (const size_t tile : kept) last_use_[tile] = ++uses_;
  int64_t bytes = 0;
  std::vector<size_t> held;
  for (size_t tile = 0; tile < texture_.size(); ++tile) {
    if (texture_[tile].Empty()) continue;
    bytes += static_cast<int64_t>(texture_[tile].data.size());
    held.push_back(tile);
  }
  std::sort(held.begin(), held.end(), [this](size_t a, size_t b) { return last_use_[a] < last_use_[b]; });
  for (size_t i = 0; i < held.size() && bytes > cache_bytes_; ++i) {
    bytes -= static_cast<int64_t>(texture_[held[i]].data.size());
    texture_[held[i]] = {};
  }
}

SurfacePicture SurfacePainter::Paint(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, base::ThreadPool& threads) {
  const std::vector<Hit> hits = Trace(camera, cam_from_enu, threads);
  SurfacePicture picture;
  picture.colors.resize(hits.size());
  picture.has_mesh.assign(hits.size(), 0);
  std::vector<std::vector<uint32_t>> pixels_of(mesh_.atlas.size());
  for (size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].triangle != raytrace::kNoTriangle) pixels_of[mesh_.AtlasOf(hits[i].triangle)].push_back(static_cast<uint32_t>(i));
  }
  std::vector<size_t> seen;
  for (size_t tile = 0; tile < pixels_of.size(); ++tile) {
    if (!pixels_of[tile].empty() && mesh_.HasTexture(tile)) seen.push_back(tile);
  }
  // Only as many tiles at once as there are threads, because their decoded textures are in memory beside the cache.
  const auto batch = static_cast<size_t>(threads.size());
  for (size_t first = 0; first < seen.size(); first += batch) {
    base::ThrowIfCancelled();
    const std::vector<size_t> tiles(seen.begin() + static_cast<std::ptrdiff_t>(first),
                                    seen.begin() + static_cast<std::ptrdiff_t>(std::min(first + batch, seen.size())));
    threads.ParallelFor(static_cast<int64_t>(tiles.size()), [&](int64_t task, int) {
      const size_t tile = tiles[static_cast<size_t>(task)];
      if (texture_[tile].Empty()) texture_[tile] = image::DecodeRgb8(mesh_.JpegOf(tile));
      const image::Image8& texture = texture_[tile];
      if (texture.Empty()) return;
      for (const uint32_t pixel : pixels_of[tile]) {
        Color(hits[pixel], texture, &picture.colors[pixel]);
        picture.has_mesh[pixel] = 1;
      }
    });
    Forget(tiles);
  }
  return picture;
}

}  // namespace skyquilt::evaluate::surface
