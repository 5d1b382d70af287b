#include "core/trust/trust.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/checkpoint/user_block.h"

namespace skyquilt::trust {
namespace {

constexpr const char* kKind = "trust";
constexpr int kVersion = 1;

float Channel(const render::RayColor& color, int c) {
  const float value = color.rgb_srgb[c];
  return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F;
}

// Largest slope over the colours, by central differences; one-sided at the rim.
float GradientAt(int x, int y, int width, int height, std::span<const render::RayColor> colors) {
  const int left = std::max(x - 1, 0), right = std::min(x + 1, width - 1), above = std::max(y - 1, 0), below = std::min(y + 1, height - 1);
  const auto at = [&](int u, int v) -> const render::RayColor& {
    return colors[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)];
  };
  float largest = 0.0F;
  for (int c = 0; c < 3; ++c) {
    const float dx = right > left ? (Channel(at(right, y), c) - Channel(at(left, y), c)) / static_cast<float>(right - left) : 0.0F;
    const float dy = below > above ? (Channel(at(x, below), c) - Channel(at(x, above), c)) / static_cast<float>(below - above) : 0.0F;
    largest = std::max(largest, std::hypot(dx, dy));
  }
  return largest;
}

bool ShowsSurface(const render::RayColor& color) {
  return std::isfinite(color.depth_median) && color.opacity > 0.0F;
}

}  // namespace

void Save(const Trust& trust, const std::filesystem::path& file) {
  checkpoint::ArchiveWriter writer(kKind, kVersion);
  writer.SetAttribute("scene", trust.scene);
  trust.evidence.Put(writer);
  trust.model.Put(writer);
  writer.Commit(file);
}

std::filesystem::path TrustFileOf(const std::filesystem::path& scene_h5) {
  return std::filesystem::absolute(scene_h5).lexically_normal().parent_path() / "trust.h5";
}

std::string SceneIdentity(const std::filesystem::path& scene_h5) {
  std::ifstream file(scene_h5, std::ios::binary);
  std::string first(checkpoint::kUserBlockBytes, '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (!file) throw base::InputError(scene_h5, "cannot be read, or is not a scene", "Merge the scene again: skyquilt merge PROJECT --restart");
  return base::HashHex(first);
}

Trust LoadTrustOf(const std::filesystem::path& scene_h5) {
  const std::filesystem::path file = TrustFileOf(scene_h5);
  if (!std::filesystem::exists(file)) {
    throw base::InputError(file, "does not exist: it is not known how far the scene can be trusted",
                           "Merge the scene again with trust.tiles above 0: skyquilt merge PROJECT --restart");
  }
  const checkpoint::ArchiveReader reader(file);
  if (reader.kind() != kKind) {
    throw base::InputError(file, "is a " + reader.kind() + " file, not a trust file", "Merge the scene again: skyquilt merge PROJECT --restart");
  }
  reader.RequireVersion(kVersion);
  Trust trust{EvidenceCells::Get(reader, file), ErrorModel::Get(reader, file), reader.StringAttribute("scene")};
  if (trust.scene != SceneIdentity(scene_h5)) {
    throw base::InputError(file, "is of another scene", "Merge the scene again: skyquilt merge PROJECT --restart");
  }
  return trust;
}

std::vector<PixelFacts> FactsOf(const EvidenceCells& evidence, int width, int height, std::span<const render::RayColor> colors, const RowRays& rays,
                                base::ThreadPool& threads) {
  const size_t columns = static_cast<size_t>(width);
  SKYQUILT_CHECK(colors.size() == columns * static_cast<size_t>(height), "one colour per pixel");
  std::vector<PixelFacts> facts(colors.size());
  threads.ParallelFor(height, [&](int64_t row, int /*thread*/) {
    std::vector<render::Ray> of_row(columns);
    rays(static_cast<int>(row), of_row);
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(row) * columns + static_cast<size_t>(x);
      const render::RayColor& color = colors[i];
      PixelFacts& fact = facts[i];
      fact.opacity = color.opacity;
      fact.gradient = GradientAt(x, static_cast<int>(row), width, height, colors);
      fact.spread_pixels = std::numeric_limits<float>::quiet_NaN();
      if (!ShowsSurface(color)) continue;
      const render::Ray& ray = of_row[static_cast<size_t>(x)];
      const auto depth = static_cast<double>(color.depth_median);
      fact.evidence = evidence.At(ray.origin_enu + depth * ray.direction_enu);
      fact.spread_pixels = static_cast<float>(static_cast<double>(color.depth_back - color.depth_front) / ray.Footprint(depth));
    }
  });
  return facts;
}

TrustPicture PictureOf(const ErrorModel& model, int width, int height, std::span<const render::RayColor> colors, std::span<const PixelFacts> facts,
                       base::ThreadPool& threads) {
  TrustPicture picture{image::ImageF(width, height, 1, std::numeric_limits<float>::quiet_NaN()), image::ImageF(width, height, 1, 0.0F)};
  threads.ParallelFor(height, [&](int64_t row, int /*thread*/) {
    for (size_t i = static_cast<size_t>(row) * static_cast<size_t>(width); i < static_cast<size_t>(row + 1) * static_cast<size_t>(width); ++i) {
      if (!ShowsSurface(colors[i])) continue;
      picture.error.data[i] = model.RmsError(facts[i]);
      picture.photos.data[i] = facts[i].evidence.photos;
    }
  });
  return picture;
}

TrustPicture TrustOf(const Trust& trust, int width, int height, std::span<const render::RayColor> colors, const RowRays& rays,
                     base::ThreadPool& threads) {
  return PictureOf(trust.model, width, height, colors, FactsOf(trust.evidence, width, height, colors, rays, threads), threads);
}

}  // namespace skyquilt::trust
