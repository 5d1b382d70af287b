// Plain places must stay as they are, bit by bit: benchmarks over time compare photos of them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "simulate/city_layout.h"

namespace skyquilt::simulate {
namespace {

// FNV-1a of numbers rounded to millionths, which another machine's sine does not change.
class LayoutHash {
 public:
  void Add(double value) {
    const auto number = static_cast<uint64_t>(std::llround(value * 1e6));
    for (unsigned byte = 0; byte < 8; ++byte) {
      hash_ ^= number >> (8U * byte) & 255U;
      hash_ *= 1099511628211ULL;
    }
  }
  void Add(std::initializer_list<double> values) {
    for (const double value : values) Add(value);
  }
  uint64_t hash() const { return hash_; }

 private:
  uint64_t hash_ = 14695981039346656037ULL;
};

struct Expected {
  const char* place;
  int seed;
  size_t n_buildings;
  uint64_t hash;
  size_t n_triangles;       // of the buildings
  double sum_of_heights_m;  // of their vertices
};

class PlainLayout : public testing::TestWithParam<Expected> {};

// The numbers were computed before buildings could have other shapes.
TEST_P(PlainLayout, IsWhatItWas) {
  SimulateOptions options;
  options.place = GetParam().place;
  options.seed = GetParam().seed;
  const PlaceSpec place = ResolvePlace(options);
  const Eigen::Vector2d surround = Eigen::Vector2d::Constant(place.surround_m);
  const CityLayout layout(place.city, place.area_min - surround, place.area_max + surround, place.seed);
  const CityContents& contents = layout.contents();
  EXPECT_EQ(contents.buildings.size(), GetParam().n_buildings);
  LayoutHash hash;
  size_t n_triangles = 0;
  double sum_of_heights_m = 0.0;
  for (const Building& b : contents.buildings) {
    hash.Add({static_cast<double>(b.kind), static_cast<double>(b.roof), b.centre.x(), b.centre.y(), b.yaw_deg, b.length_m, b.width_m, b.eave_height_m,
              b.ridge_height_m, b.parapet_height_m, b.foundation_m, static_cast<double>(b.seed)});
    Mesh mesh;
    AddBuilding(b, 0, mesh);
    n_triangles += mesh.triangle.size();
    for (const Eigen::Vector3f& vertex : mesh.position) sum_of_heights_m += static_cast<double>(vertex.z());
  }
  for (const Tree& tree : contents.trees) {
    hash.Add({tree.position.x(), tree.position.y(), tree.height_m, tree.crown_radius_m, tree.conifer ? 1.0 : 0.0, static_cast<double>(tree.seed)});
  }
  for (const Car& car : contents.parked) hash.Add({car.position.x(), car.position.y(), car.yaw_deg, static_cast<double>(car.seed)});
  for (const Pond& pond : contents.ponds) {
    hash.Add({pond.centre.x(), pond.centre.y(), pond.radii.x(), pond.radii.y(), pond.axis.x(), pond.axis.y()});
  }
  for (double x = place.area_min.x() + 0.3; x < place.area_max.x(); x += 7.3) {
    for (double y = place.area_min.y() + 0.2; y < place.area_max.y(); y += 6.7) {
      const GroundSample ground = layout.Sample(static_cast<float>(x), static_cast<float>(y));
      hash.Add({static_cast<double>(ground.kind), ground.pad != nullptr ? static_cast<double>(ground.pad->kind) + 1.0 : 0.0});
    }
  }
  EXPECT_EQ(hash.hash(), GetParam().hash);
  EXPECT_EQ(n_triangles, GetParam().n_triangles);
  EXPECT_NEAR(sum_of_heights_m, GetParam().sum_of_heights_m, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Places, PlainLayout,
                         testing::Values(Expected{"town", 1, 153, 0x8b51b2fa2115c704ULL, 6576, 143689.992603},
                                         Expected{"town", 2, 189, 0xc59095f80343a472ULL, 6216, 95910.354828},
                                         Expected{"town", 3, 134, 0x3de4d9cd6be8f226ULL, 5332, 109858.716059},
                                         Expected{"town", 11, 118, 0x818640dddfc9692eULL, 4306, 75047.009466},
                                         Expected{"hamlet", 5, 12, 0x68b72d59fe4a297fULL, 260, 2407.141323},
                                         Expected{"smallcity", 2, 1674, 0x6676c1b7ded4fc14ULL, 76794, 1607643.250215}),
                         [](const auto& param_info) { return std::string(param_info.param.place) + std::to_string(param_info.param.seed); });

}  // namespace
}  // namespace skyquilt::simulate
