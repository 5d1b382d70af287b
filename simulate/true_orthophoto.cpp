#include "simulate/true_orthophoto.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "core/gis/map_projection.h"
#include "simulate/ray_shader.h"
#include "simulate/survey_writer.h"
#include "simulate/terrain.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMostCells = 400e6;
constexpr int kBandRows = gis::GeoTiffWriter::kTile;
constexpr int kNodeCells = 64;  // between lines that are computed exactly

// What the photos see of a plane as steep as the place, as far as the place is built.
Eigen::AlignedBox2d SeenGround(const PlaceSpec& place, const std::vector<PhotoPlan>& photos, double takeoff_z_m) {
  const Vector2d surround = Vector2d::Constant(place.surround_m);
  const Eigen::AlignedBox2d built(place.area_min - surround, place.area_max + surround);
  const Vector2d rise = HillsideRise(place.hillside_deg), middle = 0.5 * (place.area_min + place.area_max);
  const Vector3d up(-rise.x(), -rise.y(), 1.0), on_plane(middle.x(), middle.y(), takeoff_z_m);
  Eigen::AlignedBox2d seen;
  for (const PhotoPlan& photo : photos) {
    const Vector3d centre = photo.cam_from_enu.OriginInSource();
    for (const double u : {0.0, 0.5, 1.0}) {
      for (const double v : {0.0, 0.5, 1.0}) {
        const Vector3d ray = photo.cam_from_enu.rotation.conjugate() * place.camera.RayFromImg({u * place.camera.width, v * place.camera.height});
        const double down = -up.dot(ray);
        if (down < 1e-3 * up.norm()) return built;  // up to the horizon
        seen.extend((centre + up.dot(centre - on_plane) / down * ray).head<2>());
      }
    }
  }
  return seen.intersection(built);
}

// Vertical lines of a band of rows: exact at the corners of squares of kNodeCells cells, and interpolated in between, which is correct to a small
// part of a cell.
class BandLines {
 public:
  BandLines(const gis::MapProjection& projection, const gis::MapGrid& grid, int first_row) : columns_(grid.width / kNodeCells + 2) {
    for (int j = 0; j <= kBandRows / kNodeCells; ++j) {
      for (int i = 0; i < columns_; ++i)
        nodes_.push_back(projection.VerticalLineAt(grid.CellCentre(i * kNodeCells - 0.5, first_row + j * kNodeCells - 0.5)));
    }
  }

  // x, y: cells from the band's north-west corner.
  gis::MapProjection::VerticalLine At(double x, double y) const {
    const int i = static_cast<int>(x / kNodeCells), j = std::min(static_cast<int>(y / kNodeCells), kBandRows / kNodeCells - 1);
    const double u = x / kNodeCells - i, v = y / kNodeCells - j;
    const gis::MapProjection::VerticalLine* north = &nodes_[static_cast<size_t>(j) * static_cast<size_t>(columns_) + static_cast<size_t>(i)];
    const gis::MapProjection::VerticalLine* south = north + columns_;
    const auto blend = [&](auto member) -> Vector3d {
      return (1 - v) * ((1 - u) * north[0].*member + u * north[1].*member) + v * ((1 - u) * south[0].*member + u * south[1].*member);
    };
    return {blend(&gis::MapProjection::VerticalLine::start_enu), blend(&gis::MapProjection::VerticalLine::down_enu).normalized()};
  }

 private:
  int columns_;
  std::vector<gis::MapProjection::VerticalLine> nodes_;
};

// Renders the cells of a few rows, one packet of samples high.
class RowRenderer {
 public:
  RowRenderer(const World& world, const gis::MapGrid& grid, int samples_per_cell, bool soft_shadows)
      : shader_(world, soft_shadows), grid_(grid), side_(SamplesPerSide(samples_per_cell)) {
    for (const Eigen::Vector3f& position : world.mesh().position) top_z_m_ = std::max(top_z_m_, static_cast<double>(position.z()) + 1.0);
  }

  int rows() const { return kPacketSide / side_; }

  // The rows that begin `row` rows into the band; rgba: of those rows that the map has.
  void Render(const BandLines& lines, const MovingScene& nothing_moves, int row, std::span<uint8_t> rgba) const {
    const int n_rows = static_cast<int>(rgba.size() / 4) / grid_.width;
    image::ImageF rgb_linear(grid_.width, n_rows, 3);
    image::Image8 hits(grid_.width, n_rows, 1);
    const float weight = 1.0F / static_cast<float>(side_ * side_);
    for (int tile = 0; tile * kPacketSide < grid_.width * side_; ++tile) {
      raytrace::RayPacket rays;
      SetRays(lines, tile, row, n_rows, rays);
      const RayLight light = shader_.Trace(nothing_moves, {static_cast<float>(grid_.resolution_m), 0.0F}, rays);
      for (int lane = 0; lane < static_cast<int>(raytrace::kPacket); ++lane) {
        const auto slot = static_cast<size_t>(lane);
        if (rays.valid[slot] == 0) continue;
        const int x = (tile * kPacketSide + lane % kPacketSide) / side_, y = lane / kPacketSide / side_;
        float* cell = rgb_linear.At(x, y);
        for (Eigen::Index c = 0; c < 3; ++c) cell[c] += weight * light.radiance[slot][c];
        if (rays.triangle[slot] != raytrace::kNoTriangle) ++*hits.At(x, y);
      }
    }
    const image::Image8 rgb = Develop(rgb_linear, {});
    for (size_t cell = 0; cell < hits.data.size(); ++cell) {
      if (hits.data[cell] != side_ * side_) continue;
      std::copy_n(&rgb.data[3 * cell], 3, &rgba[4 * cell]);
      rgba[4 * cell + 3] = 255;
    }
  }

 private:
  void SetRays(const BandLines& lines, int tile, int row, int n_rows, raytrace::RayPacket& rays) const {
    for (int lane = 0; lane < static_cast<int>(raytrace::kPacket); ++lane) {
      const auto slot = static_cast<size_t>(lane);
      const int x = tile * kPacketSide + lane % kPacketSide, y = lane / kPacketSide;
      rays.valid[slot] = 0;
      if (x >= grid_.width * side_ || y >= n_rows * side_) continue;
      const gis::MapProjection::VerticalLine line = lines.At((x + 0.5) / side_, row + (y + 0.5) / side_);
      const Vector3d origin = line.start_enu + (top_z_m_ - line.start_enu.z()) / line.down_enu.z() * line.down_enu;
      rays.Set(slot, origin.cast<float>(), line.down_enu.cast<float>(), 0.0F, kFarthestHit_m);
    }
  }

  RayShader shader_;
  const gis::MapGrid& grid_;
  int side_;               // samples per side of a cell
  double top_z_m_ = -1e6;  // above all that is built
};

}  // namespace

gis::MapGrid PlanTrueOrthophoto(const PlaceSpec& place, const std::vector<PhotoPlan>& photos, double takeoff_z_m, const geo::EnuFrame& frame,
                                double cell_m) {
  const Eigen::AlignedBox2d seen = SeenGround(place, photos, takeoff_z_m);
  SKYQUILT_CHECK(!seen.isEmpty(), "photos that see nothing of the place");
  gis::MapGrid grid;
  grid.georeferenced = true;
  grid.zone = geo::UtmZoneOf(frame.origin());
  const Vector3d low(seen.min().x(), seen.min().y(), takeoff_z_m), high(seen.max().x(), seen.max().y(), takeoff_z_m);
  const gis::MapExtent extent = gis::ProjectedExtent(low, high, gis::MapProjection(frame.origin(), grid));
  const double cells = extent.CellCounts(cell_m).prod();
  if (cells > kMostCells) {
    throw base::UsageError("simulate.ortho_cell_m = " + std::to_string(cell_m) + " is not allowed: the true orthophoto would have " +
                           std::to_string(std::lround(cells / 1e6)) + " million cells, more than " + std::to_string(std::lround(kMostCells / 1e6)) +
                           " million; set it to at least " + std::to_string(1.01 * cell_m * std::sqrt(cells / kMostCells)));
  }
  extent.SetCells(cell_m, &grid);
  return grid;
}

void WriteTrueOrthophoto(const World& world, const gis::MapGrid& grid, const geo::EnuFrame& frame, int samples_per_cell, bool soft_shadows,
                         base::ThreadPool& threads, const std::filesystem::path& file) {
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.bands = 4;
  spec.band_names = {"red", "green", "blue", "alpha"};
  spec.metadata = {
      {"GEOREFERENCE", "exact (simulated)"}, {"TIFFTAG_IMAGEDESCRIPTION", "True orthophoto of a simulated survey"}, {"TIFFTAG_SOFTWARE", "skyquilt"}};
  gis::GeoTiffWriter writer(file, spec);
  const gis::MapProjection projection(frame.origin(), grid);
  const RowRenderer renderer(world, grid, samples_per_cell, soft_shadows);
  const MovingScene nothing_moves{{}, {}, {}, raytrace::TracedScene({}, {})};
  base::Progress progress("true orthophoto", grid.height, "rows");
  std::vector<uint8_t> rgba;
  for (int first_row = 0; first_row < grid.height; first_row += kBandRows) {
    const BandLines lines(projection, grid, first_row);
    const int band_rows = std::min(kBandRows, grid.height - first_row);
    const auto row_bytes = 4 * static_cast<size_t>(grid.width);
    rgba.assign(static_cast<size_t>(band_rows) * row_bytes, 0);
    threads.ParallelFor((band_rows + renderer.rows() - 1) / renderer.rows(), [&](int64_t task, int /*thread*/) {
      base::ThrowIfCancelled();
      const int row = static_cast<int>(task) * renderer.rows();
      const int n_rows = std::min(renderer.rows(), band_rows - row);
      renderer.Render(lines, nothing_moves, row,
                      std::span(rgba).subspan(static_cast<size_t>(row) * row_bytes, static_cast<size_t>(n_rows) * row_bytes));
      progress.Advance(n_rows);
    });
    writer.WriteRows(first_row, band_rows, std::span<const uint8_t>(rgba));
  }
  writer.Close();
  progress.Finish();
}

}  // namespace skyquilt::simulate
