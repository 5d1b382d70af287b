#include "evaluate/ortho/moving_cars.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "core/base/cancel.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr float kClearDifference = 20.0F / 255.0F;
constexpr int kMaskBlock = 32;           // pixels whose places on the ground are looked up together
constexpr double kGroundMargin_m = 0.5;  // around them, for the height of what stands there
constexpr int kCompareTile = 128;        // cells

// One bit per cell; may be set by several threads.
class CellSet {
 public:
  explicit CellSet(const gis::MapGrid& grid) : grid_(grid), words_((grid.size() + 63) / 64, 0) {}
  void Add(int column, int row) {
    const size_t i = grid_.Index(column, row);
    std::atomic_ref<uint64_t>(words_[i / 64]).fetch_or(uint64_t{1} << (i % 64), std::memory_order_relaxed);
  }
  bool Has(int column, int row) const {
    const size_t i = grid_.Index(column, row);
    return (words_[i / 64] >> (i % 64) & 1) != 0;
  }
  const gis::MapGrid& grid() const { return grid_; }

 private:
  gis::MapGrid grid_;
  std::vector<uint64_t> words_;
};

// Finds the cells under the zeros of one photo's mask.
class MaskOnGround {
 public:
  MaskOnGround(const survey::Survey& survey, size_t photo, const image::Image8& mask, const HeightMap& heights,
               const skyquilt::surface::MapFrame& frame, CellSet* cells)
      : photo_(survey.photos[photo]),
        camera_(survey.cameras[static_cast<size_t>(photo_.camera)].Resized(mask.width, mask.height)),
        mask_(mask),
        heights_(heights),
        frame_(frame),
        cells_(cells),
        centre_enu_(photo_.cam_from_enu.OriginInSource()),
        centre_map_(frame.MapFromEnu(centre_enu_)) {}

  void AddAll() const {
    for (int y = 0; y < mask_.height; y += kMaskBlock) {
      for (int x = 0; x < mask_.width; x += kMaskBlock) {
        if (HasZero(x, y)) AddBlock(x, y);
      }
    }
  }

 private:
  bool HasZero(int left, int top) const {
    for (int y = top; y < std::min(top + kMaskBlock, mask_.height); ++y) {
      const uint8_t* const row = mask_.At(left, y);
      if (std::find(row, row + std::min(kMaskBlock, mask_.width - left), uint8_t{0}) != row + std::min(kMaskBlock, mask_.width - left)) return true;
    }
    return false;
  }

  // Where a pixel's ray meets the surface, roughly; nothing when it does not go down. Rays are straight in the map's coordinates over such distances.
  std::optional<Eigen::Vector3d> Ground(double x, double y) const {
    constexpr double kStep_m = 100.0;
    const Eigen::Vector3d direction = photo_.cam_from_enu.rotation.conjugate() * camera_.RayFromImg({x, y});
    const Eigen::Vector3d in_map = (frame_.MapFromEnu(centre_enu_ + kStep_m * direction) - centre_map_) / kStep_m;
    if (in_map.z() > -0.1) return std::nullopt;
    double height_m = heights_.median_m();
    Eigen::Vector3d place = centre_map_;
    for (int i = 0; i < 5; ++i) {
      place = centre_map_ + (height_m - centre_map_.z()) / in_map.z() * in_map;
      const double found_m = heights_.At(place.head<2>());
      if (std::isfinite(found_m)) height_m = found_m;
    }
    return place.allFinite() ? std::optional(place) : std::nullopt;
  }

  void AddBlock(int x, int y) const {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e12), high = -low;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int dx : {0, kMaskBlock}) {
      for (const int dy : {0, kMaskBlock}) {
        const std::optional<Eigen::Vector3d> ground = Ground(std::min(x + dx, mask_.width), std::min(y + dy, mask_.height));
        if (!ground) return;
        low = low.cwiseMin(ground->head<2>());
        high = high.cwiseMax(ground->head<2>());
        middle += 0.25 * *ground;
      }
    }
    AddCells(low.array() - kGroundMargin_m, high.array() + kGroundMargin_m, middle, x, y);
  }

  // Cells of the rectangle that are seen in a zero of this block. Within so few metres the survey's frame is linear in the map's coordinates.
  void AddCells(const Eigen::Vector2d& low, const Eigen::Vector2d& high, const Eigen::Vector3d& middle, int block_x, int block_y) const {
    const gis::MapGrid& grid = cells_->grid();
    const Eigen::Vector3d origin = frame_.EnuFromMap(middle);
    Eigen::Matrix3d slope;
    for (Eigen::Index axis = 0; axis < 3; ++axis) slope.col(axis) = frame_.EnuFromMap(middle + Eigen::Vector3d::Unit(axis)) - origin;
    const Eigen::Vector2d first = grid.CellOf({low.x(), high.y()}), last = grid.CellOf({high.x(), low.y()});
    const auto clamped = [](double value, int n) { return static_cast<int>(std::clamp(value, -1.0, static_cast<double>(n))); };
    for (int row = std::max(0, clamped(std::ceil(first.y()), grid.height)); row <= std::min(grid.height - 1, clamped(last.y(), grid.height)); ++row) {
      const int right = std::min(grid.width - 1, clamped(last.x(), grid.width));
      for (int column = std::max(0, clamped(std::ceil(first.x()), grid.width)); column <= right; ++column) {
        const Eigen::Vector2d place = grid.CellCentre(column, row);
        const double height_m = heights_.At(place);
        if (!std::isfinite(height_m)) continue;
        const Eigen::Vector3d x_in_enu = origin + slope * (Eigen::Vector3d(place.x(), place.y(), height_m) - middle);
        const std::optional<Eigen::Vector2d> pixel = camera_.ImgFromCam(photo_.cam_from_enu * x_in_enu);
        if (!pixel || !(pixel->minCoeff() >= 0.0) || pixel->x() >= mask_.width || pixel->y() >= mask_.height) continue;
        const int px = static_cast<int>(pixel->x()), py = static_cast<int>(pixel->y());
        if (px / kMaskBlock == block_x / kMaskBlock && py / kMaskBlock == block_y / kMaskBlock && *mask_.At(px, py) == 0) cells_->Add(column, row);
      }
    }
  }

  const survey::Photo& photo_;
  const camera::Camera camera_;
  const image::Image8& mask_;
  const HeightMap& heights_;
  const skyquilt::surface::MapFrame& frame_;
  CellSet* cells_;
  Eigen::Vector3d centre_enu_, centre_map_;
};

MovingCars CountInTile(const OpenMaps& maps, const CellSet& cells, int left, int top, const Eigen::Vector2d& shift_m) {
  const int width = std::min(kCompareTile, cells.grid().width - left), height = std::min(kCompareTile, cells.grid().height - top);
  MovingCars cars;
  std::optional<MapPart> map, truth;  // read when there is a cell to look at
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!cells.Has(left + x, top + y)) continue;
      if (!map) {
        map = ReadPart(maps.map, left, top, width, height);
        truth = maps.truth.Read(left, top, width, height, shift_m);
      }
      if (*map->known.At(x, y) == 0 || *truth->known.At(x, y) == 0) continue;
      ++cars.cells;
      const float *const a = map->rgb.At(x, y), *const b = truth->rgb.At(x, y);
      const float difference = std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
      if (difference > kClearDifference) ++cars.differing;
    }
  }
  return cars;
}

}  // namespace

MovingCars CountMovingCars(const std::vector<OpenMaps>& maps, const Eigen::Vector2d& shift_m, const std::vector<size_t>& photos,
                           const std::filesystem::path& masks_folder, const survey::Survey& survey, const HeightMap& heights,
                           const skyquilt::surface::MapFrame& frame, base::ThreadPool& threads) {
  CellSet cells(maps.front().map.grid());
  threads.ParallelFor(static_cast<int64_t>(photos.size()), [&](int64_t i, int) {
    base::ThrowIfCancelled();
    const size_t photo = photos[static_cast<size_t>(i)];
    const std::filesystem::path file = masks_folder / (std::filesystem::path(survey.photos[photo].name).filename().string() + ".png");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return;
    MaskOnGround(survey, photo, image::LoadMask(file), heights, frame, &cells).AddAll();
  });
  const int across = (cells.grid().width + kCompareTile - 1) / kCompareTile, down = (cells.grid().height + kCompareTile - 1) / kCompareTile;
  std::vector<MovingCars> each(static_cast<size_t>(across) * static_cast<size_t>(down));
  threads.ParallelFor(static_cast<int64_t>(each.size()), [&](int64_t i, int thread) {
    base::ThrowIfCancelled();
    const int column = static_cast<int>(i % across) * kCompareTile, row = static_cast<int>(i / across) * kCompareTile;
    each[static_cast<size_t>(i)] = CountInTile(maps[static_cast<size_t>(thread)], cells, column, row, shift_m);
  });
  MovingCars cars;
  for (const MovingCars& one : each) {
    cars.cells += one.cells;
    cars.differing += one.differing;
  }
  return cars;
}

}  // namespace skyquilt::evaluate::ortho
