// The upper envelope of the parts' roofs as a planar map.
#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "buildings/geometry/planar_map.h"
#include "buildings/solids/build_solids.h"
#include "buildings/solids/slopes.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSame = 1e-5;           // metres: places nearer are one vertex
constexpr double kTie = 1e-6;            // metres: of two roofs that differ by less the part named first counts
constexpr double kSmallestFacet = 0.01;  // square metres

// One slope of one part and where it is the part's roof.
struct SlopePiece {
  int part = 0;
  Slope slope;
  Ring region;  // convex
};

struct UvBox {
  Eigen::Vector2d least, most;

  bool Holds(const Eigen::Vector2d& p) const { return (p.array() >= least.array()).all() && (p.array() <= most.array()).all(); }
  Ring Corners() const { return {least, {most.x(), least.y()}, most, {least.x(), most.y()}}; }
};

void AddBorder(const Ring& ring, std::vector<Segment>* segments) {
  for (size_t i = 0; i < ring.size(); ++i) segments->push_back({ring[i], ring[(i + 1) % ring.size()]});
}

class Envelope {
 public:
  explicit Envelope(const Shape& shape) {
    for (size_t p = 0; p < shape.parts.size(); ++p) {
      const Part& part = shape.parts[p];
      walls_.push_back({shape.MinOf(part, false), shape.MaxOf(part, false)});
      roofs_.push_back({shape.MinOf(part, true), shape.MaxOf(part, true)});
      const std::vector<Slope> slopes = SlopesOf(shape, part);
      for (const Slope& slope : slopes) {
        SlopePiece piece{static_cast<int>(p), slope, roofs_.back().Corners()};
        // Where it is the lowest slope of its part.
        for (const Slope& other : slopes) piece.region = Clipped(piece.region, slope.slope - other.slope, other.offset - slope.offset);
        pieces_.push_back(std::move(piece));
      }
    }
  }

  std::vector<RoofFacet> Facets() const {
    const PlanarMap map(Segments(), kSame);
    std::vector<int> label;
    for (const Eigen::Vector2d& place : map.PointsInFaces()) label.push_back(HighestAt(place));
    GiveAwaySlivers(map, &label);
    std::vector<RoofFacet> facets;
    for (const MapRegion& region : map.Regions(label, 2.0 * kSame)) {
      const SlopePiece& piece = pieces_[static_cast<size_t>(region.label)];
      facets.push_back({map.OutlineOf(region), piece.slope.slope, piece.slope.offset, piece.part});
    }
    return facets;
  }

 private:
  // All lines along which the highest slope can change.
  std::vector<Segment> Segments() const {
    std::vector<Segment> segments;
    for (const UvBox& box : walls_) AddBorder(box.Corners(), &segments);
    for (const SlopePiece& piece : pieces_) AddBorder(piece.region, &segments);
    for (size_t i = 0; i < pieces_.size(); ++i) {
      for (size_t j = i + 1; j < pieces_.size(); ++j) {
        if (pieces_[i].part != pieces_[j].part) AddMeeting(pieces_[i], pieces_[j], &segments);
      }
    }
    return segments;
  }

  static void AddMeeting(const SlopePiece& a, const SlopePiece& b, std::vector<Segment>* segments) {
    Ring common = a.region;
    for (size_t i = 0; i < b.region.size(); ++i) {
      const Eigen::Vector2d from = b.region[i], along = b.region[(i + 1) % b.region.size()] - from, out(along.y(), -along.x());
      common = Clipped(common, out, out.dot(from));
    }
    double lowest = 0.0, highest = 0.0;
    for (const Eigen::Vector2d& p : common) {
      lowest = std::min(lowest, a.slope.HeightAt(p) - b.slope.HeightAt(p));
      highest = std::max(highest, a.slope.HeightAt(p) - b.slope.HeightAt(p));
    }
    if (highest < kTie || lowest > -kTie) return;
    AddBorder(Clipped(common, a.slope.slope - b.slope.slope, b.slope.offset - a.slope.offset), segments);
  }

  // Index of the piece; -1 outside all walls.
  int HighestAt(const Eigen::Vector2d& place) const {
    if (std::none_of(walls_.begin(), walls_.end(), [&](const UvBox& box) { return box.Holds(place); })) return -1;
    double highest = -std::numeric_limits<double>::infinity();
    int best = -1;
    for (size_t begin = 0, end = 0; begin < pieces_.size(); begin = end) {
      size_t lowest = begin;
      for (end = begin; end < pieces_.size() && pieces_[end].part == pieces_[begin].part; ++end) {
        if (pieces_[end].slope.HeightAt(place) < pieces_[lowest].slope.HeightAt(place)) lowest = end;
      }
      if (!roofs_[static_cast<size_t>(pieces_[begin].part)].Holds(place)) continue;
      const double height = pieces_[lowest].slope.HeightAt(place);
      if (height <= highest + kTie) continue;
      highest = height;
      best = static_cast<int>(lowest);
    }
    return best;
  }

  // Regions that are too small take the label of the neighbour with the longest common border.
  static void GiveAwaySlivers(const PlanarMap& map, std::vector<int>* label) {
    const std::vector<double> face_area = map.FaceAreas();
    for (size_t round = 0; round < label->size(); ++round) {
      const std::vector<int> component = map.Components(*label);
      std::map<int, double> area;
      for (size_t f = 0; f < component.size(); ++f) {
        if ((*label)[f] >= 0) area[component[f]] += face_area[f];
      }
      std::map<int, std::map<int, double>> shared;  // metres of border with other labels
      for (uint32_t h = 0; h < map.HalfEdges(); ++h) {
        const int left = map.LabelOf(h, *label), right = map.LabelOf(PlanarMap::Twin(h), *label);
        if (left < 0 || right < 0 || left == right) continue;
        shared[component[static_cast<size_t>(map.FaceOf(h))]][right] += (map.Vertex(map.To(h)) - map.Vertex(map.From(h))).norm();
      }
      int least = -1;
      for (const auto& [c, size] : area) {
        if (size < kSmallestFacet && shared.contains(c) && (least < 0 || size < area[least])) least = c;
      }
      if (least < 0) return;
      const auto longest =
          std::max_element(shared[least].begin(), shared[least].end(), [](const auto& a, const auto& b) { return a.second < b.second; });
      for (size_t f = 0; f < component.size(); ++f) {
        if (component[f] == least) (*label)[f] = longest->first;
      }
    }
  }

  std::vector<UvBox> walls_, roofs_;  // of each part; roofs go on under Part::joins
  std::vector<SlopePiece> pieces_;    // in the order of the parts
};

}  // namespace

std::vector<RoofFacet> RoofFacets(const Shape& shape) {
  return Envelope(shape).Facets();
}

std::vector<Polygon> Footprints(const Shape& shape) {
  std::vector<Segment> segments;
  std::vector<UvBox> walls;
  for (const Part& part : shape.parts) {
    walls.push_back({shape.MinOf(part, false), shape.MaxOf(part, false)});
    AddBorder(walls.back().Corners(), &segments);
  }
  const PlanarMap map(segments, kSame);
  std::vector<int> label;
  for (const Eigen::Vector2d& place : map.PointsInFaces())
    label.push_back(std::any_of(walls.begin(), walls.end(), [&](const UvBox& box) { return box.Holds(place); }) ? 0 : -1);
  std::vector<Polygon> footprints;
  for (const MapRegion& region : map.Regions(label, 2.0 * kSame)) {
    footprints.push_back(map.OutlineOf(region));
    for (Eigen::Vector2d& p : footprints.back().outer) p = shape.EnuFrom(p);
    for (Ring& hole : footprints.back().holes) {
      for (Eigen::Vector2d& p : hole) p = shape.EnuFrom(p);
    }
  }
  std::stable_sort(footprints.begin(), footprints.end(), [](const Polygon& a, const Polygon& b) { return Area(a) > Area(b); });
  return footprints;
}

}  // namespace skyquilt::buildings
