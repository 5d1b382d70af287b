#include "worker/rays/ray_source.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/image/srgb.h"
#include "worker/rays/depth_points.h"
#include "worker/robust/rejected_pixels.h"

namespace skyquilt::worker {
namespace {

// Number of pixels along each axis of a tile from which its mean colour is computed.
constexpr int kColorPixels = 4;
// Largest difference of a channel between a pixel of the sky and the sky beside its tile.
constexpr float kSkyPixelStep = 0.04F;

// The tile, of `count` along an axis of `size` pixels, that a pixel is in.
int TileAt(int pixel, int size, int count) {
  return ((pixel + 1) * count - 1) / size;
}

}  // namespace

RaySource::RaySource(const survey::Survey& survey, const image::PixelCache& pixels, const brightness::Response& response)
    : pixels_(pixels), response_(response) {
  std::map<std::tuple<int, int, int>, size_t> known;  // camera and size
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    cameras_.push_back(survey.cameras[static_cast<size_t>(photo.camera)].Resized(pixels.Width(i), pixels.Height(i)));
    const auto [entry, is_new] = known.try_emplace({photo.camera, pixels.Width(i), pixels.Height(i)}, pitches_.size());
    if (is_new) {
      pitches_.emplace_back(cameras_.back());
      lenses_.emplace_back(cameras_.back());
    }
    pitch_of_.push_back(entry->second);
    enu_from_cam_.push_back(photo.cam_from_enu.Inverse());
    corner_radii_.emplace_back(cameras_.back());
  }
  sky_pixels_.resize(cameras_.size());
  UpdateExposures();
}

void RaySource::UpdateExposures() {
  exposures_.clear();
  for (size_t i = 0; i < response_.photos(); ++i) exposures_.push_back(response_.ExposureOf(i));
}

void RaySource::SetTiles(std::vector<Tile> inside, std::vector<Tile> empty, double empty_share) {
  inside_ = std::move(inside);
  empty_ = std::move(empty);
  empty_share_ = empty_.empty() ? 0.0 : empty_share;
}

void RaySource::FindSkyPixels(int photo, const std::vector<Eigen::Vector3f>& srgb, const std::vector<char>& open) {
  const auto index = static_cast<size_t>(photo);
  const int width = pixels_.Width(index), height = pixels_.Height(index);
  const image::PixelCache::Photo pixels = pixels_.Copy(index);
  std::vector<Eigen::Vector3f> recorded = srgb;
  for (size_t i = 0; i < recorded.size(); ++i) {
    const Tile tile{photo, static_cast<int16_t>(i % kTileColumns), static_cast<int16_t>(i / kTileColumns)};
    const std::array<brightness::Exposure, 3> exposure = ExposureAt(photo, TileCentre(tile));
    for (size_t c = 0; c < 3; ++c) {
      float& value = recorded[i][static_cast<Eigen::Index>(c)];
      value = image::SrgbFromLinear(image::LinearFromSrgb(value) * exposure[c].gain);
    }
  }
  const auto tile_of = [&](int x, int y) {
    return static_cast<size_t>(TileAt(y, height, kTileRows)) * kTileColumns + static_cast<size_t>(TileAt(x, width, kTileColumns));
  };
  // From the open sky's pixels on, neighbour by neighbour.
  std::vector<bool> sky(static_cast<size_t>(width) * static_cast<size_t>(height), false);
  const auto at = [&](int x, int y) { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); };
  std::vector<std::array<int, 2>> reached;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (open[tile_of(x, y)] == 0) continue;
      sky[at(x, y)] = true;
      reached.push_back({x, y});
    }
  }
  while (!reached.empty()) {
    const auto [from_x, from_y] = reached.back();
    reached.pop_back();
    for (const auto& [right, down] : {std::array<int, 2>{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int x = from_x + right, y = from_y + down;
      if (x < 0 || y < 0 || x >= width || y >= height || sky[at(x, y)]) continue;
      const uint8_t* rgb = pixels.rgb.data() + 3 * at(x, y);
      const Eigen::Vector3f value = Eigen::Vector3f(rgb[0], rgb[1], rgb[2]) / 255.0F;
      if (!((value - recorded[tile_of(x, y)]).cwiseAbs().maxCoeff() <= kSkyPixelStep)) continue;  // nor where there is no colour
      sky[at(x, y)] = true;
      reached.push_back({x, y});
    }
  }
  SkyPixels found{std::vector<int32_t>(recorded.size(), -1), {}};
  for (size_t i = 0; i < recorded.size(); ++i) {
    if (!recorded[i].allFinite()) continue;
    found.first[i] = static_cast<int32_t>(found.sky.size());
    const int row = static_cast<int>(i) / kTileColumns, column = static_cast<int>(i) % kTileColumns;
    for (int y = row * height / kTileRows; y < (row + 1) * height / kTileRows; ++y) {
      for (int x = column * width / kTileColumns; x < (column + 1) * width / kTileColumns; ++x) found.sky.push_back(sky[at(x, y)]);
    }
  }
  sky_pixels_[index] = std::move(found);
}

bool RaySource::ShowsSky(int photo, int x, int y) const {
  const auto index = static_cast<size_t>(photo);
  const SkyPixels& pixels = sky_pixels_[index];
  if (pixels.first.empty()) return false;
  const int width = pixels_.Width(index), height = pixels_.Height(index);
  const int row = TileAt(y, height, kTileRows), column = TileAt(x, width, kTileColumns);
  const int32_t first = pixels.first[static_cast<size_t>(row) * kTileColumns + static_cast<size_t>(column)];
  if (first < 0) return false;
  const int begin_x = column * width / kTileColumns, end_x = (column + 1) * width / kTileColumns;
  const int place = (y - row * height / kTileRows) * (end_x - begin_x) + x - begin_x;
  return pixels.sky[static_cast<size_t>(first) + static_cast<size_t>(place)];
}

void RaySource::RayThrough(int photo, const Eigen::Vector2d& pixel, Eigen::Vector3d* origin_enu, Eigen::Vector3d* direction_enu) const {
  const auto i = static_cast<size_t>(photo);
  const geo::Rigid3d& pose = enu_from_cam_[i];
  *origin_enu = pose.translation;
  *direction_enu = (pose.rotation * lenses_[pitch_of_[i]].RayFromImg(pixel)).normalized();
}

brightness::PicturePlace RaySource::PlaceOf(int photo, const Eigen::Vector2d& pixel) const {
  const auto i = static_cast<size_t>(photo);
  return {static_cast<float>(pixel.x() / pixels_.Width(i)), static_cast<float>(pixel.y() / pixels_.Height(i))};
}

std::array<brightness::Exposure, 3> RaySource::ExposureAt(int photo, const Eigen::Vector2d& pixel) const {
  return response_.ExposureOf(static_cast<size_t>(photo), Radius2(photo, pixel), PlaceOf(photo, pixel));
}

Eigen::Vector2d RaySource::TileCentre(const Tile& tile) const {
  const auto photo = static_cast<size_t>(tile.photo);
  return {(tile.column + 0.5) * pixels_.Width(photo) / kTileColumns, (tile.row + 0.5) * pixels_.Height(photo) / kTileRows};
}

bool RaySource::Draw(base::Random& random, const PhotoPyramid& pyramid, PixelRay* ray) const {
  for (int attempt = 0; attempt < 8; ++attempt) {
    if (DrawPatch(random, pyramid, 1, ray) == 1) return true;
  }
  return false;
}

int RaySource::DrawPatch(base::Random& random, const PhotoPyramid& pyramid, int n, PixelRay* rays) const {
  const int level = pyramid.Draw(random);
  const bool empty = static_cast<double>(random.Uniform()) < empty_share_;
  const std::vector<Tile>& tiles = empty ? empty_ : inside_;
  const Tile& tile = tiles[random.Below(static_cast<uint32_t>(tiles.size()))];
  const auto photo = static_cast<size_t>(tile.photo);
  // First of `run` neighbouring pixels inside the tile, along one axis; `run` is shortened to the size of the tile.
  const auto along = [&](int index, int count, int size, int* run) {
    const int begin = index * size / count;
    const int end = std::max(begin + 1, (index + 1) * size / count);
    *run = std::min(*run, end - begin);
    return std::min(size - 1, begin + static_cast<int>(random.Below(static_cast<uint32_t>(end - begin - *run + 1))));
  };
  const int size = 1 << level, width = pixels_.Width(photo), height = pixels_.Height(photo);
  int columns = level == 0 ? n : 1, rows = 1;
  const int x = along(tile.column, kTileColumns, pixels_.Width(photo), &columns);
  const int y = along(tile.row, kTileRows, pixels_.Height(photo), &rows);
  int drawn = 0;
  if (level > 0) {
    // Squares around the drawn pixel, moved into the photo; those of a patch may leave its tile.
    if (size > width || size > height) return 0;
    const int first_x = std::clamp(x - size / 2, 0, width - size), first_y = std::clamp(y - size / 2, 0, height - size);
    for (int i = 0; i < n && first_x + (i + 1) * size <= width; ++i) {
      if (RayOf(tile.photo, first_x + i * size, first_y, level, empty, rays + drawn)) ++drawn;
    }
    return drawn;
  }
  for (int i = 0; i < columns && x + i < width; ++i) {
    if (RayOf(tile.photo, x + i, y, 0, empty, rays + drawn)) ++drawn;
  }
  return drawn;
}

bool RaySource::DrawSegment(base::Random& random, const PhotoSegments& segments, PixelRay* rays, int* drawn) const {
  *drawn = 0;
  const Tile& tile = inside_[random.Below(static_cast<uint32_t>(inside_.size()))];
  const auto photo = static_cast<size_t>(tile.photo);
  const int width = pixels_.Width(photo), height = pixels_.Height(photo);
  const auto within = [&random](int begin, int end) {
    return begin + static_cast<int>(random.Below(static_cast<uint32_t>(std::max(1, end - begin))));
  };
  const int first_x = within(tile.column * width / kTileColumns, (tile.column + 1) * width / kTileColumns);
  const int first_y = within(tile.row * height / kTileRows, (tile.row + 1) * height / kTileRows);
  const uint16_t segment = segments.At(tile.photo, first_x, first_y);
  bool together = segment != 0;
  if (RayOf(tile.photo, first_x, first_y, 0, false, rays)) ++*drawn;
  constexpr int kAttempts = 8;
  while (*drawn < kSegmentRays) {
    int x = first_x, y = first_y, attempt = 0;
    for (; together && attempt < kAttempts; ++attempt) {
      x = within(std::max(0, first_x - kSegmentReach), std::min(width, first_x + kSegmentReach + 1));
      y = within(std::max(0, first_y - kSegmentReach), std::min(height, first_y + kSegmentReach + 1));
      if (segments.At(tile.photo, x, y) == segment && RayOf(tile.photo, x, y, 0, false, rays + *drawn)) break;
    }
    if (!together || attempt == kAttempts) {
      together = false;
      if (!Draw(random, PhotoPyramid(), rays + *drawn)) break;
    }
    ++*drawn;
  }
  return together;
}

bool RaySource::PointRay(const DepthPoint& point, PixelRay* ray) const {
  const auto photo = static_cast<size_t>(point.photo);
  const int x = std::clamp(static_cast<int>(point.pixel_x), 0, pixels_.Width(photo) - 1);
  const int y = std::clamp(static_cast<int>(point.pixel_y), 0, pixels_.Height(photo) - 1);
  if (!RayOf(point.photo, x, y, 0, false, ray)) return false;
  ray->point_distance_m = point.distance_m;
  ray->point_sigma_m = point.sigma_m;
  return true;
}

bool RaySource::RayOf(int photo, int x, int y, int level, bool empty, PixelRay* ray) const {
  const auto index = static_cast<size_t>(photo);
  const int size = 1 << level;
  if (rejected_ != nullptr && ShowsRejected(photo, x, y, size)) return false;
  if (left_out_.Touch(index, x, y, size)) return false;
  if (level == 0) {
    const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(pixels_.Width(index)) + static_cast<size_t>(x);
    uint8_t rgb[3];
    if (!pixels_.Pixel(index, pixel, rgb)) return false;
    for (size_t c = 0; c < 3; ++c) ray->target_srgb[c] = static_cast<float>(rgb[c]) / 255.0F;
  } else {
    float light[3];
    if (!pixels_.MeanLight(index, x, y, size, light)) return false;
    for (size_t c = 0; c < 3; ++c) ray->target_srgb[c] = image::SrgbFromLinear(light[c]);
  }
  const Eigen::Vector2d position(x + 0.5 * size, y + 0.5 * size);
  RayThrough(photo, position, &ray->origin_enu, &ray->direction_enu);
  ray->pixel_pitch = static_cast<float>(size * pitches_[pitch_of_[index]].At(position));
  ray->level = level;
  ray->photo = photo;
  ray->place = PlaceOf(photo, position);
  ray->exposure = brightness::Response::WithFactor(
      exposures_[index], response_.LogVignetting(index, Radius2(photo, position)) + response_.LogShading(index, ray->place));
  // A square of pixels by its corners.
  ray->empty =
      empty || (ShowsSky(photo, x, y) &&
                (size == 1 || (ShowsSky(photo, x + size - 1, y) && ShowsSky(photo, x, y + size - 1) && ShowsSky(photo, x + size - 1, y + size - 1))));
  return true;
}

bool RaySource::ShowsRejected(int photo, int x, int y, int size) const {
  const auto index = static_cast<size_t>(photo);
  if (size == 1) return rejected_->At(index, x, y);
  const int step = std::min(size, rejected_->cell_px());
  for (int v = 0; v < size + step; v += step) {
    for (int u = 0; u < size + step; u += step) {
      if (rejected_->At(index, x + std::min(u, size - 1), y + std::min(v, size - 1))) return true;
    }
  }
  return false;
}

std::vector<Eigen::Vector3f> RaySource::TileColors(int photo) const {
  const auto index = static_cast<size_t>(photo);
  const int width = pixels_.Width(index), height = pixels_.Height(index);
  const image::PixelCache::Photo pixels = pixels_.Copy(index);
  const auto along = [](int tile, int count, int step, int size) {
    return static_cast<size_t>(std::min(size - 1, (tile * kColorPixels + step) * size / (count * kColorPixels)));
  };
  static const std::array<float, 256> linear = [] {
    std::array<float, 256> values{};
    for (size_t i = 0; i < values.size(); ++i) values[i] = image::LinearFromSrgb(static_cast<float>(i) / 255.0F);
    return values;
  }();
  // Where there is neither vignetting nor shading, a photo has 256 values for each colour.
  const float* vignetting = response_.vignetting.data() + 3 * static_cast<size_t>(response_.camera[index]);
  const bool is_even = response_.shading.empty() && std::all_of(vignetting, vignetting + 3, [](float term) { return term == 0.0F; });
  std::array<std::array<float, 256>, 3> of_value;
  const std::array<brightness::Exposure, 3> on_axis = response_.ExposureOf(index);
  for (size_t c = 0; is_even && c < 3; ++c) {
    for (size_t i = 0; i < 256; ++i) of_value[c][i] = image::SrgbFromLinear(linear[i] / on_axis[c].gain);
  }
  std::vector<Eigen::Vector3f> colors;
  colors.reserve(static_cast<size_t>(kTileRows) * kTileColumns);
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      const Tile tile{photo, static_cast<int16_t>(column), static_cast<int16_t>(row)};
      const std::array<brightness::Exposure, 3> exposure = ExposureAt(photo, TileCentre(tile));
      const float gain[3] = {exposure[0].gain, exposure[1].gain, exposure[2].gain};
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      float n = 0.0F;
      for (int v = 0; v < kColorPixels; ++v) {
        for (int u = 0; u < kColorPixels; ++u) {
          const size_t pixel = along(row, kTileRows, v, height) * static_cast<size_t>(width) + along(column, kTileColumns, u, width);
          if (!pixels.mask.empty() && pixels.mask[pixel] == 0) continue;
          for (size_t c = 0; c < 3; ++c) {
            const uint8_t value = pixels.rgb[3 * pixel + c];
            sum[static_cast<Eigen::Index>(c)] += is_even ? of_value[c][value] : image::SrgbFromLinear(linear[value] / gain[c]);
          }
          n += 1.0F;
        }
      }
      colors.emplace_back(sum / n);
    }
  }
  return colors;
}

std::array<float, 3> RaySource::MeanColor(uint64_t seed) const {
  constexpr int kRays = 20'000;
  base::Random random(seed);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int n = 0;
  PixelRay ray;
  for (int i = 0; i < kRays; ++i) {
    if (!Draw(random, PhotoPyramid(), &ray) || ray.empty) continue;
    for (size_t c = 0; c < 3; ++c) {
      sum[static_cast<Eigen::Index>(c)] += static_cast<double>(image::LinearFromSrgb(ray.target_srgb[c]) / ray.exposure[c].gain);
    }
    ++n;
  }
  std::array<float, 3> mean = {0.0F, 0.0F, 0.0F};
  for (int c = 0; c < 3 && n > 0; ++c) mean[static_cast<size_t>(c)] = image::SrgbFromLinear(static_cast<float>(sum[c] / n));
  return mean;
}

std::vector<Tile> TrainingTiles(const survey::Survey& survey, const std::vector<int>& photos) {
  std::vector<Tile> tiles;
  tiles.reserve(photos.size() * kTileRows * kTileColumns);
  for (const int photo : photos) {
    if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
    for (int row = 0; row < kTileRows; ++row) {
      for (int column = 0; column < kTileColumns; ++column) tiles.push_back({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)});
    }
  }
  return tiles;
}

}  // namespace skyquilt::worker
