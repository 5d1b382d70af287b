// The directions along which the surface of a tile is projected onto its texture: up, down, and eight horizontal ones that follow the tile's facades.
#pragma once

#include <Eigen/Core>
#include <array>

#include "surface/texture/tile_geometry.h"

namespace skyquilt::surface {

// Seen from outside, u grows to the right and v downwards in the texture. Length 1, at right angles to each other.
struct ChartDirection {
  Eigen::Vector3d out;  // out of the surface
  Eigen::Vector3d u, v;
};

constexpr int kChartDirections = 10;
using ChartDirections = std::array<ChartDirection, kChartDirections>;

// Azimuth of most of the facades, radians from east towards north, in [0, pi / 2) because the sides of a house differ by right angles: the peak of
// the histogram of steep faces by area. 0 without any.
double FacadeAzimuth(const TileGeometry& geometry);

// 0: up, 1: down, then counter-clockwise: the four directions of facades and the four between.
ChartDirections DirectionsOf(const TileGeometry& geometry);

// The direction that fits a normal best. Up is preferred a little, because few large pieces are better than many small ones.
int BestDirection(const ChartDirections& directions, const Eigen::Vector3d& normal);

}  // namespace skyquilt::surface
