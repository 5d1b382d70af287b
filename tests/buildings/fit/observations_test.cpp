#include "buildings/fit/observations.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/random.h"
#include "tests/buildings/fit/made_surface.h"

namespace skyquilt::buildings {
namespace {

Shape TwoParts() {
  Shape shape;
  shape.yaw_rad = 0.3;
  shape.u = {-6.0, 1.0, 7.0};
  shape.v = {-4.0, 4.5};
  shape.parts = {Part{.u0 = 0, .u1 = 1, .v0 = 0, .v1 = 1, .roof = RoofKind::kFlat, .eave_z = 9.0, .ridge_z = 9.0},
                 Part{.u0 = 1, .u1 = 2, .v0 = 0, .v1 = 1, .roof = RoofKind::kGable, .along_u = true, .eave_z = 5.0, .ridge_z = 8.0}};
  return shape;
}

TEST(Parameters, KeepTheContractsOrder) {
  const Shape shape = TwoParts();
  const Parameters parameters(shape);
  EXPECT_EQ(parameters.shape_size(), 1 + 3 + 2 + 1 + 2);
  EXPECT_EQ(parameters.line(0, 2), 3);
  EXPECT_EQ(parameters.line(1, 0), 4);
  EXPECT_EQ(parameters.eave(0), 6);
  EXPECT_EQ(parameters.ridge(0), 6);
  EXPECT_EQ(parameters.eave(1), 7);
  EXPECT_EQ(parameters.ridge(1), 8);
  Shape back = TwoParts();
  back.yaw_rad = 0.0;
  back.u[1] = 2.0;
  back.parts[0].ridge_z = 0.0;
  parameters.Set(parameters.Of(shape), &back);
  EXPECT_EQ(back.yaw_rad, 0.3);
  EXPECT_EQ(back.u, shape.u);
  EXPECT_EQ(back.parts[0].ridge_z, 9.0);
  EXPECT_EQ(back.parts[1].ridge_z, 8.0);
}

// All kinds and sides against central differences.
TEST(Observations, GradientsAreDifferences) {
  const Shape shape = TwoParts();
  const Parameters parameters(shape);
  Eigen::VectorXd values = parameters.Of(shape);
  values[parameters.overhang(true)] = 0.4;
  base::Random random(3);
  std::vector<Observation> list;
  for (int i = 0; i < 40; ++i) {
    Observation o;
    o.kind = i % 5 == 4 ? ObservationKind::kPrior : i % 2 == 0 ? ObservationKind::kRoof : ObservationKind::kLine;
    o.place = {random.Uniform(-8, 8), random.Uniform(-8, 8)};
    o.height = random.Uniform(4, 10);
    o.tilt = 0.8;
    o.axis = static_cast<int>(random.Below(2));
    o.line = static_cast<int>(random.Below(2));
    o.side = random.Below(2) == 0 ? -1 : 1;
    o.part = i % 3 == 0 ? 0 : 1;
    if (o.part == 1) {
      o.half_axis = static_cast<int>(random.Below(2));
      o.half_low = 0;
      o.half_high = 1;
    }
    o.value = 0.3;
    o.reach = random.UniformDouble();
    o.parameter = parameters.overhang(i % 4 == 0);
    list.push_back(o);
  }
  const double step = 1e-5;
  for (const Observation& o : list) {
    Eigen::VectorXd gradient(parameters.size());
    Residual(o, parameters, values.data(), gradient.data());
    for (int i = 0; i < parameters.size(); ++i) {
      Eigen::VectorXd up = values, down = values;
      up[i] += step;
      down[i] -= step;
      const double difference = (Residual(o, parameters, up.data(), nullptr) - Residual(o, parameters, down.data(), nullptr)) / (2.0 * step);
      EXPECT_NEAR(gradient[i], difference, 1e-6) << "parameter " << i << " kind " << static_cast<int>(o.kind);
    }
  }
}

TEST(Observations, RoofResidualIsTheDistanceFromTheRoof) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 5, 8, 0.7);
  const Parameters parameters(shape);
  const Eigen::VectorXd values = parameters.Of(shape);
  Observation o;
  o.axis = 1;
  o.line = 1;
  o.side = 1;  // the plane that rises from the wall at larger v
  o.half_axis = 1;
  o.half_low = 0;
  o.half_high = 1;
  const Eigen::Vector2d uv(2.0, 1.5);
  o.place = shape.EnuFrom(uv) - shape.origin;
  o.tilt = 0.8;
  o.height = RoofHeight(shape, uv) + 0.25;
  EXPECT_NEAR(Residual(o, parameters, values.data(), nullptr), 0.2, 1e-12);
}

TEST(Group, ThinningKeepsOrderAndEnds) {
  Group group;
  for (int i = 0; i < 100; ++i) {
    Observation o;
    o.height = i;
    group.observations.push_back(o);
    group.at.emplace_back(i, 0);
  }
  group.Thin(30);
  ASSERT_EQ(group.observations.size(), 30U);
  ASSERT_EQ(group.at.size(), 30U);
  for (size_t i = 1; i < 30; ++i) EXPECT_GT(group.observations[i].height, group.observations[i - 1].height);
  EXPECT_EQ(group.observations.front().height, 0.0);
  EXPECT_GT(group.observations.back().height, 94.0);
  group.Thin(50);
  EXPECT_EQ(group.observations.size(), 30U);
}

}  // namespace
}  // namespace skyquilt::buildings
