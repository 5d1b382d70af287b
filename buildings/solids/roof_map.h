// A roof as a planar map with heights: what walls and faces of a solid are made from.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "buildings/geometry/planar_map.h"
#include "buildings/solids/build_solids.h"

namespace skyquilt::buildings {

// At every vertex of the map stands a column of levels: the heights of the roofs around it and, at outer walls, of the ground. Heights that nearly
// agree are one level, so that roofs which meet there share a vertex.
class RoofMap {
 public:
  RoofMap(std::span<const RoofFacet> facets, double ground_z);

  const PlanarMap& map() const { return map_; }
  // One label for facets in one plane; -1 outside.
  std::span<const int> labels() const { return label_; }
  int LabelOf(uint32_t h) const { return map_.LabelOf(h, label_); }
  // Number of the level of a label (-1: ground) at a vertex on its border, from below.
  int LevelOf(uint32_t vertex, int label) const { return column_[vertex].level.at(label); }
  double HeightOf(uint32_t vertex, int level) const { return column_[vertex].height[static_cast<size_t>(level)]; }
  int Levels(uint32_t vertex) const { return static_cast<int>(column_[vertex].height.size()); }

 private:
  struct Column {
    std::map<int, int> level;    // by label
    std::vector<double> height;  // by level, rising
  };

  void FindPlanes(std::span<const RoofFacet> facets);
  void FindLabels(std::span<const RoofFacet> facets);
  std::vector<Segment> Crossings() const;
  void FindColumns();
  double HeightAt(int label, const Eigen::Vector2d& uv) const { return label < 0 ? ground_z_ : plane_[static_cast<size_t>(label)].HeightAt(uv); }

  double ground_z_;
  std::vector<RoofFacet> plane_;  // of each label
  std::vector<int> label_of_facet_;
  PlanarMap map_;
  std::vector<int> label_;  // of each face of the map
  std::vector<Column> column_;
};

}  // namespace skyquilt::buildings
