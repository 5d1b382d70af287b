#include "simulate/compound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/raytrace/traced_scene.h"
#include "simulate/outline.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

Building Main(RoofKind roof, double length_m, double width_m, double eave_m, double ridge_m) {
  Building main;
  main.roof = roof;
  main.length_m = length_m;
  main.width_m = width_m;
  main.eave_height_m = eave_m;
  main.ridge_height_m = ridge_m;
  main.bare_roof = true;  // nothing on the roofs to be measured
  return main;
}

std::vector<std::vector<Building>> Compounds() {
  const Building gable = Main(RoofKind::kGable, 9.0, 7.0, 3.2, 5.4), high = Main(RoofKind::kGable, 11.0, 8.0, 5.8, 8.9);
  const Building hip = Main(RoofKind::kHip, 10.5, 7.4, 3.0, 5.6), flat = Main(RoofKind::kFlat, 10.0, 8.0, 5.6, 5.6);
  Building slab = Main(RoofKind::kFlat, 32.0, 12.0, 9.6, 9.6);
  slab.parapet_height_m = 0.5;
  return {WithWing(gable, {2.2, 4.6, 5.0, 3.2}, BuildingShape::kL),
          WithWing(gable, {-2.2, 4.6, 5.0, 3.2}, BuildingShape::kL),
          WithWing(high, {3.0, 5.0, 5.4, 2.9}, BuildingShape::kL),
          WithWing(high, {3.0, 5.0, 5.4, 5.2}, BuildingShape::kL),
          WithWing(flat, {-2.5, 5.0, 5.4, 2.9}, BuildingShape::kL),
          WithWing(hip, {0.0, 4.8, 5.0, 3.0}, BuildingShape::kT),
          WithSetback(slab, {25.0, 8.0}, {1.0, 0.0}, 12.9),
          WithSetback(slab, {7.0, 9.0}, {-8.0, 1.0}, 40.0),
          Row({gable, high, gable}),
          Row({high, flat}),
          Courtyard(slab, {38.0, 32.0}, 9.6, {9.6, 9.6, 12.6, 9.6})};
}

// The highest roof at a place, by the sizes alone; NaN within half a metre of an edge, where overhangs, parapets and other roofs may be.
double ExpectedHeight(const std::vector<Building>& parts, const Vector2d& at) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const Building& part : parts) {
    const double distance = part.DistanceTo(at);
    if (std::abs(distance) < 0.5) return std::numeric_limits<double>::quiet_NaN();
    if (distance < 0.0) highest = std::max(highest, RoofHeight(part, at));
    // The triangle of a roof that runs on: behind the end of its walls, up to the ridge of the other.
    const Eigen::Vector3f local = part.Local({static_cast<float>(at.x()), static_cast<float>(at.y()), 0.0F});
    const double behind = -0.5 * part.length_m - static_cast<double>(local.x());
    if (part.onto_rise > 0.0 && behind > 0.0 && part.onto_eave_height_m + part.onto_rise * behind < RoofHeight(part, at) &&
        std::abs(static_cast<double>(local.y())) < 0.5 * part.width_m) {
      highest = std::max(highest, RoofHeight(part, at));
    }
  }
  return highest;
}

TEST(Compound, RoofsAreAsHighAsTheSizesSay) {
  base::Random random(5);
  for (std::vector<Building> parts : Compounds()) {
    const Vector2d to{random.Uniform(-50.0, 50.0), random.Uniform(-50.0, 50.0)};
    MoveParts({Vector2d::Zero(), random.Uniform(0.0, 360.0)}, to, parts);
    Mesh mesh;
    for (size_t i = 0; i < parts.size(); ++i) AddBuilding(parts[i], static_cast<uint32_t>(i), mesh);
    const raytrace::TracedScene scene(mesh.position, mesh.triangle);
    int n_roof = 0, n_run_on = 0;
    for (int k = 0; k < 3000; ++k) {
      const double y = random.Uniform(-26.0, 26.0), x = random.Uniform(-26.0, 26.0);
      const Vector2d at = parts[0].centre + Vector2d(x, y);
      const double expected = ExpectedHeight(parts, at);
      if (std::isnan(expected)) continue;
      raytrace::RayPacket ray{};
      ray.Set(0, {static_cast<float>(at.x()), static_cast<float>(at.y()), 100.0F}, -Eigen::Vector3f::UnitZ(), 0.0F, 1e4F);
      scene.Intersect(ray);
      if (std::isinf(expected)) {
        ASSERT_EQ(ray.triangle[0], raytrace::kNoTriangle) << ShapeName(parts[0].shape) << " sticks out at " << at.transpose();
        continue;
      }
      ++n_roof;
      ASSERT_NE(ray.triangle[0], raytrace::kNoTriangle);
      ASSERT_NEAR(100.0 - static_cast<double>(ray.t_far[0]), expected, 1e-3) << ShapeName(parts[0].shape) << " at " << at.transpose();
      const Tag tag = mesh.tag[ray.triangle[0]];
      ASSERT_TRUE(tag.part == Part::kFlatRoof || tag.part == Part::kPitchedRoof);
      n_run_on += parts[tag.object].DistanceTo(at) > 0.0 ? 1 : 0;
    }
    EXPECT_GT(n_roof, 50);
    // The second wing of all is too low to reach the roof; the others with gables do.
    const Building& last = parts.back();
    const bool runs_on = last.onto_rise > 0.0 && last.ridge_height_m > last.onto_eave_height_m + 0.7;
    EXPECT_EQ(n_run_on > 0, runs_on) << ShapeName(parts[0].shape);
  }
}

TEST(Compound, PartsStandAboutTheOrigin) {
  for (const std::vector<Building>& parts : Compounds()) {
    std::vector<Building> numbered = parts;
    NumberOutlines(numbered);
    const std::vector<Outline> outlines = FindOutlines(numbered);
    ASSERT_EQ(outlines.size(), 1U);
    EXPECT_LT(outlines[0].centre.norm(), 1e-9);
    EXPECT_NEAR(SizeAround(parts).maxCoeff(), outlines[0].length_m, 1e-9);
    EXPECT_NEAR(SizeAround(parts).minCoeff(), outlines[0].width_m, 1e-9);
    for (const Building& part : parts) {
      EXPECT_GE(part.length_m, part.width_m);
      EXPECT_EQ(part.shape, parts[0].shape);
      EXPECT_EQ(part.joined, &part != &parts[0]);
    }
  }
}

TEST(Compound, WingsAreLowerThanTheRoofTheyRunInto) {
  const auto parts = WithWing(Main(RoofKind::kGable, 9.0, 7.0, 3.2, 5.4), {2.2, 4.6, 5.0, 3.2}, BuildingShape::kL);
  EXPECT_NEAR(parts[1].RoofRise(), parts[0].RoofRise(), 1e-12);
  EXPECT_LT(parts[1].ridge_height_m, parts[0].ridge_height_m);
}

TEST(Clearance, IsTheGapBetweenParallelWallsAndNeverTooLarge) {
  Building a = Main(RoofKind::kFlat, 10.0, 6.0, 3.0, 3.0), b = a;
  b.centre = {13.0, 1.0};
  EXPECT_NEAR(Clearance(a, b), 3.0, 1e-12);
  b.centre = {9.0, 1.0};
  EXPECT_NEAR(Clearance(a, b), -1.0, 1e-12);
  base::Random random(6);
  for (int round = 0; round < 200; ++round) {
    b.centre = {random.Uniform(-15.0, 15.0), random.Uniform(-15.0, 15.0)};
    b.yaw_deg = random.Uniform(0.0, 360.0);
    double nearest = std::numeric_limits<double>::infinity();
    const Vector2d u = b.Axis(), v(-u.y(), u.x());
    for (double x = -0.5; x <= 0.5; x += 0.02) {
      for (double y = -0.5; y <= 0.5; y += 0.02) nearest = std::min(nearest, a.DistanceTo(b.centre + x * b.length_m * u + y * b.width_m * v));
    }
    // Points inside both show an overlap.
    EXPECT_LE(Clearance(a, b), nearest + 0.2);
    EXPECT_NEAR(Clearance(a, b), Clearance(b, a), 1e-9);
    if (nearest < 0.0) {
      EXPECT_LT(Clearance(a, b), 0.0);
    }
    if (nearest > 0.3) {
      EXPECT_GT(Clearance(a, b), 0.0);
    }
  }
}

}  // namespace
}  // namespace skyquilt::simulate
