// Polygons in the plane: areas, tests, unions and differences. Metres; east and north, or the axes of a building.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace skyquilt::buildings {

// Simple: edges do not cross. The first point is not repeated at the end.
struct Polygon {
  std::vector<Eigen::Vector2d> outer;               // counter-clockwise
  std::vector<std::vector<Eigen::Vector2d>> holes;  // clockwise
};

// An oriented rectangle: centre, unit vector of the length axis, half sizes along it and across, across counter-clockwise from it.
struct Rectangle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();
  Eigen::Vector2d half = Eigen::Vector2d::Zero();

  Polygon Outline() const;
};

// Square metres, holes subtracted.
double Area(const Polygon& polygon);
double Perimeter(const Polygon& polygon);
Eigen::Vector2d Centroid(const Polygon& polygon);
// Border points may count either way.
bool Contains(const Polygon& polygon, const Eigen::Vector2d& point);
// Distance to the nearest edge, holes included; not negative.
double DistanceToBorder(const Polygon& polygon, const Eigen::Vector2d& point);

// Disjoint polygons, exact to a micrometre; slivers below 1e-6 m2 are left out. Empty input gives empty output. For up to some thousand edges.
std::vector<Polygon> Union(std::span<const Polygon> polygons);
std::vector<Polygon> Intersection(const Polygon& a, const Polygon& b);
std::vector<Polygon> Difference(const Polygon& a, std::span<const Polygon> taken);
// Area of the intersection over area of the union of two sets of polygons; 0 when both are empty.
double IntersectionOverUnion(std::span<const Polygon> a, std::span<const Polygon> b);

// The least-area rectangle around the points (rotating calipers), its longer side along `axis`. At least one point.
Rectangle LeastAreaRectangle(std::span<const Eigen::Vector2d> points);
// The least rectangle with sides along this direction, which becomes its axis whether longer or not.
Rectangle RectangleAlong(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& axis);
// Fewer points, none farther than tolerance_m from the old outline (Douglas-Peucker); stays simple.
Polygon Simplified(const Polygon& polygon, double tolerance_m);

// Outlines of the connected parts (by edges) of a mask, along cell borders, with holes. mask: [row][column], non-zero inside; corner of cell
// (column, row) at origin + cell_m * (column, row): rows go north. Sorted by falling area.
std::vector<Polygon> OutlinesOf(std::span<const uint8_t> mask, int columns, int rows, const Eigen::Vector2d& origin, double cell_m);

}  // namespace skyquilt::buildings
