#include "core/gis/boundary.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/gis/polygon_file.h"

namespace skyquilt::gis {
namespace {

constexpr const char* kGiveBoundary = "Give a GeoJSON or GeoPackage file with polygons around the area";
constexpr size_t kMostBands = 1024;

using Ring = std::vector<Eigen::Vector2d>;

void AddRing(const OGRLinearRing& ring, std::vector<Ring>* rings) {
  Ring points;
  for (int i = 0; i < ring.getNumPoints(); ++i) points.emplace_back(ring.getX(i), ring.getY(i));
  while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  if (points.size() >= 3) rings->push_back(std::move(points));
}

std::vector<Ring> RingsOf(const OGRMultiPolygon& polygons) {
  std::vector<Ring> rings;
  for (const OGRPolygon* polygon : polygons) {
    for (const OGRLinearRing* ring : *polygon) AddRing(*ring, &rings);
  }
  return rings;
}

// The polygons as one area: rings of overlapping polygons would otherwise cancel each other where they overlap.
std::vector<Ring> UnionOf(const OGRMultiPolygon& polygons) {
  if (polygons.getNumGeometries() > 1) {
    const std::unique_ptr<OGRGeometry> merged(polygons.UnionCascaded());
    OGRMultiPolygon parts;
    if (merged) internal::AddPolygons(*merged, &parts);
    std::vector<Ring> rings = RingsOf(parts);
    if (!rings.empty()) return rings;
    // Polygons that cross themselves cannot be merged; they are taken ring by ring.
  }
  return RingsOf(polygons);
}

}  // namespace

Boundary::Boundary(std::vector<std::vector<Eigen::Vector2d>> rings) : rings_(std::move(rings)) {
  std::erase_if(rings_, [](const Ring& ring) { return ring.size() < 3; });
  min_.setConstant(std::numeric_limits<double>::infinity());
  max_.setConstant(-std::numeric_limits<double>::infinity());
  for (const Ring& ring : rings_) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d& a = ring[i];
      const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
      SKYQUILT_CHECK(a.allFinite(), "a boundary with a coordinate that is not finite");
      min_ = min_.cwiseMin(a);
      max_ = max_.cwiseMax(a);
      if (a.y() < b.y()) edges_.push_back({a, b});
      if (b.y() < a.y()) edges_.push_back({b, a});
    }
  }
  BuildBands();
}

void Boundary::BuildBands() {
  // Fewer bands where many edges are long, so that the lists stay small.
  for (size_t bands = std::clamp<size_t>(edges_.size(), 1, kMostBands);; bands /= 2) {
    band_begin_.assign(bands + 1, 0);
    for (const Edge& edge : edges_) {
      for (size_t band = BandOf(edge.low.y()); band <= BandOf(edge.high.y()); ++band) ++band_begin_[band + 1];
    }
    for (size_t band = 0; band < bands; ++band) band_begin_[band + 1] += band_begin_[band];
    if (bands == 1 || band_begin_.back() <= 16 * edges_.size()) break;
  }
  band_edges_.resize(band_begin_.back());
  std::vector<size_t> next(band_begin_.begin(), band_begin_.end() - 1);
  for (size_t i = 0; i < edges_.size(); ++i) {
    for (size_t band = BandOf(edges_[i].low.y()); band <= BandOf(edges_[i].high.y()); ++band) band_edges_[next[band]++] = static_cast<uint32_t>(i);
  }
}

// The band of a northing inside the bounding box.
size_t Boundary::BandOf(double y) const {
  const size_t bands = band_begin_.size() - 1;
  const double position = (y - min_.y()) / (max_.y() - min_.y()) * static_cast<double>(bands);
  return std::min(static_cast<size_t>(std::max(0.0, position)), bands - 1);
}

bool Boundary::Contains(const Eigen::Vector2d& position) const {
  const double x = position.x(), y = position.y();
  if (!(x >= min_.x() && x <= max_.x() && y >= min_.y() && y < max_.y())) return false;
  const size_t band = BandOf(y);
  bool inside = false;
  for (size_t i = band_begin_[band]; i < band_begin_[band + 1]; ++i) {
    const Edge& edge = edges_[band_edges_[i]];
    if (y >= edge.low.y() && y < edge.high.y() && x < edge.EastingAt(y)) inside = !inside;
  }
  return inside;
}

std::vector<uint8_t> Boundary::Mask(const MapGrid& grid) const {
  const auto width = static_cast<size_t>(std::max(0, grid.width));
  std::vector<uint8_t> mask(width * static_cast<size_t>(std::max(0, grid.height)), 0);
  std::vector<double> crossings;
  for (int row = 0; row < grid.height; ++row) {
    const double y = grid.CellCentre(0, row).y();
    if (!(y >= min_.y() && y < max_.y())) continue;
    crossings.clear();
    const size_t band = BandOf(y);
    for (size_t i = band_begin_[band]; i < band_begin_[band + 1]; ++i) {
      const Edge& edge = edges_[band_edges_[i]];
      if (y >= edge.low.y() && y < edge.high.y()) crossings.push_back(edge.EastingAt(y));
    }
    std::sort(crossings.begin(), crossings.end());
    uint8_t* cells = mask.data() + static_cast<size_t>(row) * width;
    size_t passed = 0;  // crossings that are not east of the cell
    for (int column = 0; column < grid.width && passed < crossings.size(); ++column) {
      const double x = grid.CellCentre(column, row).x();
      while (passed < crossings.size() && crossings[passed] <= x) ++passed;
      cells[column] = static_cast<uint8_t>((crossings.size() - passed) % 2);
    }
  }
  return mask;
}

Boundary Boundary::Read(const std::filesystem::path& file, bool georeferenced, const geo::UtmZone& zone) {
  const internal::QuietErrors quiet;
  const internal::PolygonFormats formats = {.drivers = {"GeoJSON", "GPKG"}, .names = "GeoJSON or GeoPackage", .fix = kGiveBoundary};
  OGRMultiPolygon all;
  internal::ForEachPolygons(file, formats, georeferenced, zone, [&](const internal::FoundPolygons& found) {
    for (const OGRPolygon* polygon : found.polygons) all.addGeometry(polygon);
  });
  Boundary boundary(UnionOf(all));
  if (boundary.edges_.empty()) throw base::InputError(file, "has no polygon with an area", kGiveBoundary);
  return boundary;
}

}  // namespace skyquilt::gis
