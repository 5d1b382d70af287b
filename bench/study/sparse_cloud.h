// The sparse points of a survey in the form in which buildings are sought: what is known of the surface without any training.
#pragma once

#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "surface/maps/find_terrain.h"

namespace skyquilt::bench {

// The sparse points that training sees, with the colours of the model. Normals are those of the plane through a point and its 16 nearest neighbours,
// turned towards the photos that saw the point (up where these are unknown). Throws base::InputError without points.
buildings::PointCloud SparseCloud(const survey::Survey& survey, base::ThreadPool& threads);

// The ground sampling distance with which buildings are sought in the points: outlines are drawn in cells of this size, which must not be smaller
// than half the distance of points, or most cells of a roof are far from any point of its plane. gsd_m: of the photos, the least.
double SparseGsd(const buildings::PointCloud& cloud, double gsd_m);

// Ground below the points: the lowest point of each cell, filtered as the terrain of a surface (surface/maps/find_terrain.h). Cells are as large as
// options.cell_m says, and at least twice as large as the distance of points, so that most of them have one.
buildings::GroundGrid SparseGround(const buildings::PointCloud& cloud, const surface::TerrainOptions& options);

}  // namespace skyquilt::bench
