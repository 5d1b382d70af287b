// Solids from roof facets and footprints.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "buildings/geometry/rings.h"
#include "buildings/solids/build_solids.h"
#include "buildings/solids/roof_map.h"
#include "buildings/solids/roof_walls.h"
#include "buildings/solids/straight_vertices.h"

namespace skyquilt::buildings {
namespace {

bool IsKnown(const RoofFacet& facet) {
  return facet.slope.allFinite() && std::isfinite(facet.offset);
}

double Rounded(double metres) {
  return std::round(1000.0 * metres) / 1000.0;
}

// Where a courtyard touches another ring in a vertex only, its walls would meet there in one upright edge of four faces: the vertex is drawn back
// into the courtyard by a centimetre.
Polygon WithoutTouchingHoles(const Polygon& polygon) {
  constexpr double kTouch = 0.003, kBack = 0.01;  // metres
  Polygon apart = polygon;
  for (size_t h = 0; h < apart.holes.size(); ++h) {
    const auto touches = [&](const Ring& ring, const Eigen::Vector2d& place) {
      return std::any_of(ring.begin(), ring.end(), [&](const Eigen::Vector2d& p) { return (p - place).norm() <= kTouch; });
    };
    const Ring hole = apart.holes[h];
    for (size_t i = 0; i < hole.size(); ++i) {
      bool alone = !touches(apart.outer, hole[i]);
      for (size_t g = 0; g < apart.holes.size() && alone; ++g) alone = g == h || !touches(apart.holes[g], hole[i]);
      if (alone) continue;
      const Eigen::Vector2d in = hole[i] - hole[(i + hole.size() - 1) % hole.size()], out = hole[(i + 1) % hole.size()] - hole[i];
      const Eigen::Vector2d along = in.normalized() + out.normalized();
      // Holes are clockwise: the courtyard is on the right.
      apart.holes[h][i] += kBack * Eigen::Vector2d(along.y(), -along.x()).normalized();
    }
  }
  return apart;
}

class SolidMaker {
 public:
  SolidMaker(const Shape& shape, const RoofMap& roof) : shape_(shape), roof_(roof) {}

  Solid Make() {
    AddGround();
    for (const Wall& wall : WallsOf(roof_)) AddWall(wall);
    for (const MapRegion& region : roof_.map().Regions(roof_.labels(), -1.0)) AddFace(FaceKind::kRoof, region, region.label, false);
    RemoveStraightVertices(&solid_);
    return std::move(solid_);
  }

 private:
  uint32_t Number(uint32_t v, int level) {
    const auto [found, is_new] = number_.emplace(std::pair(v, level), static_cast<uint32_t>(solid_.vertex.size()));
    if (is_new) {
      const Eigen::Vector2d enu = shape_.EnuFrom(roof_.map().Vertex(v));
      solid_.vertex.emplace_back(Rounded(enu.x()), Rounded(enu.y()), Rounded(roof_.HeightOf(v, level)));
    }
    return found->second;
  }

  // A level face or roof over a region, at the height of a label; from below rings run the other way.
  void AddFace(FaceKind kind, const MapRegion& region, int label, bool from_below) {
    const auto numbered = [&](const std::vector<uint32_t>& ring) {
      std::vector<uint32_t> own;
      for (const uint32_t v : ring) own.push_back(Number(v, roof_.LevelOf(v, label)));
      if (from_below) std::reverse(own.begin(), own.end());
      return own;
    };
    Face face{kind, numbered(region.outer), {}};
    for (const std::vector<uint32_t>& hole : region.holes) face.holes.push_back(numbered(hole));
    solid_.face.push_back(std::move(face));
  }

  void AddGround() {
    std::vector<int> covered;
    for (const int label : roof_.labels()) covered.push_back(label < 0 ? -1 : 0);
    for (const MapRegion& region : roof_.map().Regions(covered, -1.0)) AddFace(FaceKind::kGround, region, -1, true);
  }

  void AddWall(const Wall& wall) {
    Face face;
    for (const WallCorner& corner : wall) face.outer.push_back(Number(corner.vertex, corner.level));
    solid_.face.push_back(std::move(face));
  }

  const Shape& shape_;
  const RoofMap& roof_;
  Solid solid_;
  std::map<std::pair<uint32_t, int>, uint32_t> number_;  // of a level at a vertex of the map
};

}  // namespace

Solid ExtrudeFacets(const Shape& shape, std::span<const RoofFacet> facets) {
  if (!std::isfinite(shape.ground_z) || !std::all_of(facets.begin(), facets.end(), IsKnown)) return {};
  return SolidMaker(shape, RoofMap(facets, shape.ground_z)).Make();
}

Solid ExtrudeBlock(const Polygon& footprint_enu, double ground_z, double top_z) {
  if (footprint_enu.outer.empty()) return {};
  Shape shape;
  shape.origin = footprint_enu.outer.front();
  shape.ground_z = ground_z;
  RoofFacet deck;
  deck.outline = WithoutTouchingHoles(footprint_enu);
  deck.offset = top_z;
  for (Eigen::Vector2d& p : deck.outline.outer) p -= shape.origin;
  for (Ring& hole : deck.outline.holes) {
    for (Eigen::Vector2d& p : hole) p -= shape.origin;
  }
  return ExtrudeFacets(shape, std::span(&deck, 1));
}

}  // namespace skyquilt::buildings
