// The area that a person wants: polygons read from a GeoJSON or GeoPackage file, in the coordinates of the maps.
// Immutable, so usable by several threads.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/gis/map_grid.h"

namespace skyquilt::gis {

class Boundary {
 public:
  // Each ring a closed polygon without its last point repeated; a place is inside when it is inside an odd number of rings, so holes are rings too.
  // Coordinates must be finite. Rings of fewer than three points are left out; without any ring nothing is inside.
  explicit Boundary(std::vector<std::vector<Eigen::Vector2d>> rings);
  // Reads all polygons of all layers, transformed from the file's CRS (longitude and latitude for GeoJSON without one) to the zone of the survey;
  // corners are transformed, edges stay straight. Where polygons overlap, the place is inside. Without geo-reference the coordinates must be local
  // metres and are taken as they are. Throws base::InputError: unreadable, no polygon, no CRS, or a place that cannot be transformed.
  static Boundary Read(const std::filesystem::path& file, bool georeferenced, const geo::UtmZone& zone);

  // Position in map coordinates (easting, northing).
  bool Contains(const Eigen::Vector2d& position) const;
  // Contains for the centres of all cells, row by row: 1 inside, 0 outside. Much faster than asking for each.
  std::vector<uint8_t> Mask(const MapGrid& grid) const;
  const Eigen::Vector2d& min() const { return min_; }  // corners of the bounding box; infinite without rings
  const Eigen::Vector2d& max() const { return max_; }
  const std::vector<std::vector<Eigen::Vector2d>>& rings() const { return rings_; }

 private:
  struct Edge {
    Eigen::Vector2d low, high;  // low.y() < high.y()
    // Where the edge has this northing.
    double EastingAt(double y) const { return low.x() + (y - low.y()) / (high.y() - low.y()) * (high.x() - low.x()); }
  };
  void BuildBands();
  size_t BandOf(double y) const;

  std::vector<std::vector<Eigen::Vector2d>> rings_;
  Eigen::Vector2d min_, max_;
  // All edges but level ones, and for each of the equally high bands of the bounding box the edges that reach into it:
  // band_edges_[band_begin_[b]] to band_edges_[band_begin_[b + 1]].
  std::vector<Edge> edges_;
  std::vector<size_t> band_begin_;
  std::vector<uint32_t> band_edges_;
};

}  // namespace skyquilt::gis
