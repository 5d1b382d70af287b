// Outward normals of a density: of a plane, and their derivatives.
#include "core/render/density_normal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/render/trained_field.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::render {
namespace {

using Eigen::Vector3d;

// A field whose log density grows evenly below the plane inward . x = 0 in the unit frame: one level, whose entries are the depth below a plane.
TrainedField Plane(const encoding::SpaceMap& map, const Vector3d& inward_unit) {
  TrainedField f;
  f.map = map;
  f.config.grid.levels = 2;
  f.config.grid.features = 2;
  f.config.grid.log2_table_size = 12;
  f.config.grid.base_resolution = f.config.grid.finest_resolution = 8;
  for (int axis = 0; axis < 3; ++axis) f.config.grid.extent[axis] = map.extent()[axis];
  f.config.hidden = 4;
  const field::HashField shape(f.config);
  f.parameters.Allocate(shape);
  const kernel::GridLevel& lattice = *shape.encoding().InterpolatesIn(0);
  EXPECT_TRUE(lattice.dense);
  for (int z = 0; z < lattice.size[2]; ++z) {
    for (int y = 0; y < lattice.size[1]; ++y) {
      for (int x = 0; x < lattice.size[0]; ++x) {
        const uint32_t entry = kernel::HashIndex(lattice, static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(z));
        // The ReLU lets positive features pass.
        f.parameters.grid[size_t{2} * entry] =
            static_cast<float>(10.0 + inward_unit.dot(Vector3d(x, y, z)) / static_cast<double>(lattice.cells_per_unit));
      }
    }
  }
  f.parameters.networks[0] = 1.0F;                                             // first hidden unit: first feature
  f.parameters.networks[static_cast<size_t>(4 * shape.FeatureRows())] = 3.0F;  // log density: 3 times that
  f.BuildNetworks();
  return f;
}

Vector3d NormalAt(const TrainedField& f, const Vector3d& x_in_enu) {
  const Eigen::Vector3f p = f.map.UnitFromEnu(x_in_enu);
  field::DensitySlope slope;
  f.field->DensityGradient(f.weights, f.parameters.grid, {&p[0], &p[1], &p[2]}, 1, slope);
  const Vector3d in_unit(static_cast<double>(slope.gradient[0]), static_cast<double>(slope.gradient[slope.stride]),
                         static_cast<double>(slope.gradient[2 * slope.stride]));
  return OutwardNormal<double>(f.map.UnitPerEnu(x_in_enu).transpose() * in_unit);
}

TEST(DensityNormal, OfAPlanePointsOutOfIt) {
  const encoding::SpaceMap map = encoding::SpaceMap::Box({-20, -30, 0}, {40, 30, 25});
  for (const Vector3d& outward : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0.6, 0, 0.8), Vector3d(-0.48, 0.6, 0.64)}) {
    const TrainedField f = Plane(map, -outward);
    EXPECT_LT((NormalAt(f, {3.0, -7.0, 11.0}) - outward).norm(), 1e-4) << outward.transpose();
  }
}

// Outside the square, the plane x + y = const of the contracted frame is turned in ENU; beyond the east face distances along x shrink faster.
TEST(DensityNormal, IsTurnedBackOutOfAContractedFrame) {
  const Vector3d low(-50, -50, 0), high(50, 50, 25);
  const encoding::SpaceMap map = encoding::SpaceMap::Contracted(low, high);
  const TrainedField f = Plane(map, Vector3d(-0.6, -0.8, 0.0));
  EXPECT_LT((NormalAt(f, {10.0, 20.0, 11.0}) - Vector3d(0.6, 0.8, 0.0)).norm(), 1e-4) << "inside";
  // At u = (2, 0): d unit / d ENU is (1/4) / m along x and (3/4) / m along y, times 0.25 / 50 m.
  EXPECT_LT((NormalAt(f, {100.0, 0.0, 11.0}) - Vector3d(0.6 * 0.25, 0.8 * 0.75, 0.0).normalized()).norm(), 1e-4) << "outside";
}

TEST(DensityNormal, GradientMatchesDifferences) {
  const Vector3d normal_gradient(0.3, -1.2, 0.7);
  for (const double size : {1e-2, 1.0, 30.0}) {
    const Vector3d g = size * Vector3d(0.5, -0.2, 1.1);
    const Vector3d analytic = OutwardNormalBackward<double>(g, normal_gradient);
    testing::ExpectGradient([&](const std::vector<double>& x) { return normal_gradient.dot(OutwardNormal<double>(Vector3d(x[0], x[1], x[2]))); },
                            {g[0], g[1], g[2]}, {analytic[0], analytic[1], analytic[2]}, 1e-7);
  }
}

TEST(DensityNormal, IsZeroWhereThereIsNone) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& g :
       {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1e-30F, 0, 0), Eigen::Vector3f(infinity, 0, 0), Eigen::Vector3f(std::nanf(""), 0, 0)}) {
    EXPECT_EQ(OutwardNormal<float>(g), Eigen::Vector3f(0, 0, 0));
    EXPECT_EQ(OutwardNormalBackward<float>(g, {1, 1, 1}), Eigen::Vector3f(0, 0, 0));
  }
}

}  // namespace
}  // namespace skyquilt::render
