#include "worker/ray_source.h"

#include <algorithm>

#include "core/image/srgb.h"

namespace skyquilt::worker {
namespace {

// Tiles on each side: a neighbouring photo sees unknown heights shifted by about so much.
constexpr int kBlurTiles = 2;

std::vector<Eigen::Vector3f> MeanOfNeighbours(const std::vector<Eigen::Vector3f>& tiles) {
  std::vector<Eigen::Vector3f> means;
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      float n = 0.0F;
      for (int r = std::max(0, row - kBlurTiles); r <= std::min(kTileRows - 1, row + kBlurTiles); ++r) {
        for (int c = std::max(0, column - kBlurTiles); c <= std::min(kTileColumns - 1, column + kBlurTiles); ++c) {
          sum += tiles[static_cast<size_t>(r * kTileColumns + c)];
          n += 1.0F;
        }
      }
      means.emplace_back(sum / n);
    }
  }
  return means;
}

}  // namespace

RaySource::RaySource(const survey::Survey& survey, const image::PixelCache& pixels, const std::vector<float>& gains)
    : survey_(survey), pixels_(pixels), gains_(gains) {
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    cameras_.push_back(survey.cameras[static_cast<size_t>(photo.camera)].Resized(pixels.Width(i), pixels.Height(i)));
    enu_from_cam_.push_back(photo.cam_from_enu.Inverse());
  }
}

void RaySource::SetTiles(std::vector<Tile> inside, std::vector<Tile> empty, double empty_share) {
  inside_ = std::move(inside);
  empty_ = std::move(empty);
  empty_share_ = empty_.empty() ? 0.0 : empty_share;
}

void RaySource::RayThrough(int photo, const Eigen::Vector2d& pixel, Eigen::Vector3d* origin_enu, Eigen::Vector3d* direction_enu) const {
  const geo::Rigid3d& pose = enu_from_cam_[static_cast<size_t>(photo)];
  *origin_enu = pose.translation;
  *direction_enu = (pose.rotation * cameras_[static_cast<size_t>(photo)].RayFromImg(pixel)).normalized();
}

Eigen::Vector2d RaySource::TileCentre(const Tile& tile) const {
  const auto photo = static_cast<size_t>(tile.photo);
  return {(tile.column + 0.5) * pixels_.Width(photo) / kTileColumns, (tile.row + 0.5) * pixels_.Height(photo) / kTileRows};
}

bool RaySource::Draw(base::Random& random, PixelRay* ray) const {
  for (int attempt = 0; attempt < 8; ++attempt) {
    const bool empty = static_cast<double>(random.Uniform()) < empty_share_;
    const std::vector<Tile>& tiles = empty ? empty_ : inside_;
    const Tile& tile = tiles[random.Below(static_cast<uint32_t>(tiles.size()))];
    const auto photo = static_cast<size_t>(tile.photo);
    const int width = pixels_.Width(photo);
    const int height = pixels_.Height(photo);
    const auto along = [&](int index, int count, int size) {
      const int begin = index * size / count;
      const int end = std::max(begin + 1, (index + 1) * size / count);
      return std::min(size - 1, begin + static_cast<int>(random.Below(static_cast<uint32_t>(end - begin))));
    };
    const int x = along(tile.column, kTileColumns, width);
    const int y = along(tile.row, kTileRows, height);
    const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
    uint8_t rgb[3];
    if (!pixels_.Pixel(photo, pixel, rgb)) continue;
    RayThrough(tile.photo, Eigen::Vector2d(x + 0.5, y + 0.5), &ray->origin_enu, &ray->direction_enu);
    for (size_t c = 0; c < 3; ++c) ray->target_srgb[c] = static_cast<float>(rgb[c]) / 255.0F;
    if (!blurred_.empty() && !blurred_[photo].empty() && blurred_[photo][static_cast<size_t>(tile.row * kTileColumns + tile.column)] != 0) {
      Eigen::Map<Eigen::Vector3f>(ray->target_srgb) = BlurredColor(photo, x + 0.5, y + 0.5);
    }
    ray->gain = gains_[photo];
    ray->empty = empty;
    return true;
  }
  return false;
}

Eigen::Vector3f RaySource::TileMean(const image::PixelCache::Photo& pixels, int width, int height, int row, int column) {
  const auto begin = [](int index, int count, int size) { return index * size / count; };
  const int y0 = begin(row, kTileRows, height), y1 = std::min(height, std::max(y0 + 1, begin(row + 1, kTileRows, height)));
  const int x0 = begin(column, kTileColumns, width), x1 = std::min(width, std::max(x0 + 1, begin(column + 1, kTileColumns, width)));
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float n = 0.0F;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (!pixels.mask.empty() && pixels.mask[pixel] == 0) continue;
      const uint8_t* rgb = pixels.rgb.data() + 3 * pixel;
      sum += Eigen::Vector3f(rgb[0], rgb[1], rgb[2]) / 255.0F;
      n += 1.0F;
    }
  }
  return n > 0.0F ? Eigen::Vector3f(sum / n) : Eigen::Vector3f::Constant(0.5F);
}

void RaySource::BlurTiles(const std::vector<Tile>& tiles) {
  blurred_.assign(cameras_.size(), {});
  tile_means_.assign(cameras_.size(), {});
  for (const Tile& tile : tiles) {
    const auto photo = static_cast<size_t>(tile.photo);
    if (blurred_[photo].empty()) {
      blurred_[photo].assign(static_cast<size_t>(kTileRows) * kTileColumns, 0);
      const image::PixelCache::Photo pixels = pixels_.Copy(photo);
      for (int row = 0; row < kTileRows; ++row) {
        for (int column = 0; column < kTileColumns; ++column) {
          tile_means_[photo].push_back(TileMean(pixels, pixels_.Width(photo), pixels_.Height(photo), row, column));
        }
      }
      tile_means_[photo] = MeanOfNeighbours(tile_means_[photo]);
    }
    blurred_[photo][static_cast<size_t>(tile.row * kTileColumns + tile.column)] = 1;
  }
}

// Between the centres of the four tiles around a pixel position.
Eigen::Vector3f RaySource::BlurredColor(size_t photo, double x, double y) const {
  const auto at = [](double position, int size, int count, int* first) {
    const double t = std::clamp(position * count / size - 0.5, 0.0, static_cast<double>(count - 1));
    *first = std::min(static_cast<int>(t), count - 2);
    return static_cast<float>(t - *first);
  };
  int column = 0, row = 0;
  const float u = at(x, pixels_.Width(photo), kTileColumns, &column);
  const float v = at(y, pixels_.Height(photo), kTileRows, &row);
  const Eigen::Vector3f* mean = tile_means_[photo].data() + row * kTileColumns + column;
  return (1.0F - v) * ((1.0F - u) * mean[0] + u * mean[1]) + v * ((1.0F - u) * mean[kTileColumns] + u * mean[kTileColumns + 1]);
}

std::array<float, 3> RaySource::MeanColor(uint64_t seed) const {
  constexpr int kRays = 20'000;
  base::Random random(seed);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int n = 0;
  PixelRay ray;
  for (int i = 0; i < kRays; ++i) {
    if (!Draw(random, &ray) || ray.empty) continue;
    for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(image::LinearFromSrgb(ray.target_srgb[c]) / ray.gain);
    ++n;
  }
  std::array<float, 3> mean = {0.0F, 0.0F, 0.0F};
  for (int c = 0; c < 3 && n > 0; ++c) mean[static_cast<size_t>(c)] = image::SrgbFromLinear(static_cast<float>(sum[c] / n));
  return mean;
}

std::vector<Tile> TrainingTiles(const survey::Survey& survey, const std::vector<int>& photos) {
  std::vector<Tile> tiles;
  for (const int photo : photos) {
    if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
    for (int row = 0; row < kTileRows; ++row) {
      for (int column = 0; column < kTileColumns; ++column) tiles.push_back({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)});
    }
  }
  return tiles;
}

}  // namespace skyquilt::worker
