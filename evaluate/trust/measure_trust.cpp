#include "evaluate/trust/measure_trust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/brightness/exposure.h"
#include "core/camera/corner_radius.h"
#include "core/scene/camera_rays.h"

namespace skyquilt::evaluate::trust {
namespace {

using skyquilt::trust::LeftOutTiles;

constexpr int kClosest = 4;          // pixels between those that are compared, along each axis, at least
constexpr size_t kMostTiles = 1500;  // that errors are measured in
constexpr size_t kBatchRays = 1U << 17U;
constexpr int kTilePixels = LeftOutTiles::kSide * LeftOutTiles::kSide;
constexpr const char* kLabel = "trust";

// Pixels of training photos beside the scene's rendering of them.
class PhotoComparison {
 public:
  PhotoComparison(const scene::Scene& scene, const survey::Survey& survey, const image::PixelCache& pixels, base::ThreadPool& threads)
      : scene_(scene), survey_(survey), pixels_(pixels), threads_(threads) {}

  void Add(size_t photo, std::span<const size_t> of_photo) {
    const survey::Photo& taken = survey_.photos[photo];
    const camera::Camera camera = CameraOf(photo);
    const size_t begin = rays_.size();
    rays_.resize(begin + of_photo.size());
    scene::CameraRays(camera, taken.cam_from_enu, scene_.info().scales.Cones()).Make(of_photo, std::span(rays_).subspan(begin));
    const camera::CornerRadius radius(camera);
    const auto width = static_cast<size_t>(camera.width);
    for (const size_t pixel : of_photo) {
      photo_.push_back(photo);
      pixel_.push_back(pixel);
      const Eigen::Vector2d position(static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5);
      radius2_.push_back(radius.Squared(position));
      place_.push_back({static_cast<float>(position.x() / camera.width), static_cast<float>(position.y() / camera.height)});
    }
  }

  size_t size() const { return rays_.size(); }

  // Renders all that was added.
  void Render() {
    colors_.assign(rays_.size(), {});
    scene_.RenderRaysOverBackground(rays_, colors_, {.look = scene::Rendition::kRecorded}, threads_);
  }
  std::span<const render::Ray> rays() const { return rays_; }
  std::span<const render::RayColor> colors() const { return colors_; }
  size_t photo(size_t i) const { return photo_[i]; }

  // As the photo would have recorded the rendering, against what it recorded: mean over the colours.
  float SquaredError(size_t i) const {
    uint8_t recorded[3];
    if (!pixels_.Pixel(photo_[i], pixel_[i], recorded)) return 0.0F;  // not asked for: masked pixels are not added
    float shown[3];
    std::copy_n(colors_[i].rgb_srgb, 3, shown);
    const brightness::Response& response = scene_.info().response;
    if (photo_[i] < response.photos()) brightness::Expose(response.ExposureOf(photo_[i], radius2_[i], place_[i]), shown);
    float sum = 0.0F;
    for (size_t c = 0; c < 3; ++c) {
      const float value = std::isfinite(shown[c]) ? std::clamp(shown[c], 0.0F, 1.0F) : 0.0F;
      const float error = value - static_cast<float>(recorded[c]) / 255.0F;
      sum += error * error / 3.0F;
    }
    return sum;
  }

  void Clear() {
    rays_.clear();
    photo_.clear();
    pixel_.clear();
    radius2_.clear();
    place_.clear();
  }

 private:
  camera::Camera CameraOf(size_t photo) const {
    return survey_.cameras[static_cast<size_t>(survey_.photos[photo].camera)].Resized(pixels_.Width(photo), pixels_.Height(photo));
  }

  const scene::Scene& scene_;
  const survey::Survey& survey_;
  const image::PixelCache& pixels_;
  base::ThreadPool& threads_;
  std::vector<render::Ray> rays_;
  std::vector<render::RayColor> colors_;
  std::vector<size_t> photo_, pixel_;
  std::vector<float> radius2_;
  std::vector<brightness::PicturePlace> place_;
};

std::vector<size_t> TrainingPhotos(const survey::Survey& survey) {
  std::vector<size_t> photos;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (!survey.photos[i].is_test) photos.push_back(i);
  }
  return photos;
}

bool IsUsed(std::span<const uint8_t> mask, size_t pixel) {
  return mask.empty() || mask[pixel] != 0;
}

// One pixel, at a place that looks random, of each square of `step` pixels; neither masked nor left out of training.
std::vector<size_t> LatticePixels(const image::PixelCache& pixels, size_t photo, int step, const LeftOutTiles& left_out) {
  const int width = pixels.Width(photo), height = pixels.Height(photo);
  const std::span<const uint8_t> mask = pixels.Mask(photo);
  std::vector<size_t> chosen;
  for (int row = 0; row * step < height; ++row) {
    for (int column = 0; column * step < width; ++column) {
      const uint64_t hash = base::MixBits(base::MixBits(photo) ^ (static_cast<uint64_t>(row) << 32U) ^ static_cast<uint64_t>(column));
      const int x = column * step + static_cast<int>(hash % static_cast<uint64_t>(step));
      const int y = row * step + static_cast<int>((hash >> 32U) % static_cast<uint64_t>(step));
      if (x >= width || y >= height || left_out.At(photo, x, y)) continue;
      const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (IsUsed(mask, pixel)) chosen.push_back(pixel);
    }
  }
  return chosen;
}

struct TileOfPhoto {
  size_t photo;
  int x, y;  // first pixel
};

// Tiles of training photos that are left out, whole and without masked pixels; a part of them, spread over the photos, where there are many.
std::vector<TileOfPhoto> ChooseTiles(const image::PixelCache& pixels, const std::vector<size_t>& photos, const LeftOutTiles& left_out) {
  std::vector<TileOfPhoto> tiles;
  for (const size_t photo : photos) {
    const std::span<const uint8_t> mask = pixels.Mask(photo);
    for (int y = 0; y + LeftOutTiles::kSide <= pixels.Height(photo); y += LeftOutTiles::kSide) {
      for (int x = 0; x + LeftOutTiles::kSide <= pixels.Width(photo); x += LeftOutTiles::kSide) {
        if (!left_out.At(photo, x, y)) continue;
        bool whole = true;
        for (int i = 0; i < kTilePixels && whole; ++i) {
          const int u = x + i % LeftOutTiles::kSide, v = y + i / LeftOutTiles::kSide;
          whole = IsUsed(mask, static_cast<size_t>(v) * static_cast<size_t>(pixels.Width(photo)) + static_cast<size_t>(u));
        }
        if (whole) tiles.push_back({photo, x, y});
      }
    }
  }
  if (tiles.size() <= kMostTiles) return tiles;
  std::vector<TileOfPhoto> some;
  for (size_t i = 0; i < kMostTiles; ++i) some.push_back(tiles[i * tiles.size() / kMostTiles]);
  return some;
}

class TrustMeter {
 public:
  TrustMeter(const scene::Scene& scene, const survey::Survey& survey, const image::PixelCache& pixels, const skyquilt::trust::TrustOptions& options,
             base::ThreadPool& threads)
      : info_(scene.info()),
        pixels_(pixels),
        left_out_(options.LeftOut(pixels)),
        threads_(threads),
        photos_(TrainingPhotos(survey)),
        compared_(scene, survey, pixels, threads) {
    const double all = std::accumulate(photos_.begin(), photos_.end(), 0.0, [&](double sum, size_t photo) {
      return sum + static_cast<double>(pixels.Width(photo)) * static_cast<double>(pixels.Height(photo));
    });
    step_ = std::max(kClosest, static_cast<int>(std::ceil(std::sqrt(all / options.rays))));
  }

  skyquilt::trust::Trust Measure() {
    std::vector<skyquilt::trust::Sighting> sightings;
    base::Progress progress(kLabel, static_cast<double>(photos_.size()), "photos");
    for (const size_t photo : photos_) {
      base::ThrowIfCancelled();
      compared_.Add(photo, LatticePixels(pixels_, photo, step_, left_out_));
      if (compared_.size() >= kBatchRays) AddSightings(&sightings);
      progress.Advance(1.0);
    }
    AddSightings(&sightings);
    progress.Finish();
    // Each photo has about one pixel in a cell that it shows.
    const double gsd_m = info_.gsd_m > 0.0 ? info_.gsd_m : (info_.max_enu - info_.min_enu).maxCoeff() / 1000.0;
    skyquilt::trust::Trust trust{.evidence = skyquilt::trust::EvidenceCells(std::move(sightings), step_ * gsd_m), .model = {}, .scene = {}};
    trust.model = FitModel(trust.evidence);
    return trust;
  }

 private:
  // In a plan of the scene's blocks: outside, a scene shows what it was not made for.
  bool IsInside(const Eigen::Vector3d& place) const {
    return place.allFinite() && (place.head<2>().array() >= info_.min_enu.head<2>().array()).all() &&
           (place.head<2>().array() <= info_.max_enu.head<2>().array()).all();
  }
  Eigen::Vector3d PlaceOf(size_t i) const {
    return compared_.rays()[i].origin_enu + static_cast<double>(compared_.colors()[i].depth_median) * compared_.rays()[i].direction_enu;
  }

  void AddSightings(std::vector<skyquilt::trust::Sighting>* sightings) {
    compared_.Render();
    for (size_t i = 0; i < compared_.size(); ++i) {
      const Eigen::Vector3d place = PlaceOf(i);
      if (IsInside(place)) sightings->push_back({place, static_cast<int>(compared_.photo(i)), compared_.SquaredError(i)});
    }
    compared_.Clear();
  }

  skyquilt::trust::ErrorModel FitModel(const skyquilt::trust::EvidenceCells& evidence) {
    std::vector<skyquilt::trust::PixelFacts> facts;
    std::vector<float> errors;
    const auto add = [&] {
      compared_.Render();
      for (size_t first = 0; first < compared_.size(); first += kTilePixels) {
        const skyquilt::trust::RowRays rays = [&](int row, std::span<render::Ray> of_row) {
          const auto begin = first + static_cast<size_t>(row) * LeftOutTiles::kSide;
          std::copy_n(compared_.rays().begin() + static_cast<std::ptrdiff_t>(begin), LeftOutTiles::kSide, of_row.begin());
        };
        const std::vector<skyquilt::trust::PixelFacts> of_tile = skyquilt::trust::FactsOf(
            evidence, LeftOutTiles::kSide, LeftOutTiles::kSide, compared_.colors().subspan(first, kTilePixels), rays, threads_);
        for (size_t i = 0; i < kTilePixels; ++i) {
          if (!IsInside(PlaceOf(first + i))) continue;
          facts.push_back(of_tile[i]);
          errors.push_back(compared_.SquaredError(first + i));
        }
      }
      compared_.Clear();
    };
    for (const TileOfPhoto& tile : ChooseTiles(pixels_, photos_, left_out_)) {
      base::ThrowIfCancelled();
      std::array<size_t, kTilePixels> of_tile;
      for (int i = 0; i < kTilePixels; ++i) {
        const int x = tile.x + i % LeftOutTiles::kSide, y = tile.y + i / LeftOutTiles::kSide;
        of_tile[static_cast<size_t>(i)] = static_cast<size_t>(y) * static_cast<size_t>(pixels_.Width(tile.photo)) + static_cast<size_t>(x);
      }
      compared_.Add(tile.photo, of_tile);
      if (compared_.size() >= kBatchRays) add();
    }
    add();
    return {facts, errors};
  }

  const scene::SceneInfo& info_;
  const image::PixelCache& pixels_;
  const LeftOutTiles left_out_;
  base::ThreadPool& threads_;
  const std::vector<size_t> photos_;
  PhotoComparison compared_;
  int step_ = kClosest;
};

}  // namespace

skyquilt::trust::Trust MeasureTrust(const scene::Scene& scene, const survey::Survey& survey, const image::PixelCache& pixels,
                                    const skyquilt::trust::TrustOptions& options, base::ThreadPool& threads) {
  return TrustMeter(scene, survey, pixels, options, threads).Measure();
}

}  // namespace skyquilt::evaluate::trust
