#include "buildings/shape/joined_wings.h"

#include <algorithm>

namespace skyquilt::buildings {
namespace {

constexpr double kTooHigh_m = 0.3;    // of a wing's ridge, which is noise
constexpr double kLeastRise_m = 0.3;  // of it over the eave of the roof that it meets

bool Meets(const Part& wing, const Part& main) {
  const bool falls_here = main.roof == RoofKind::kHip || (main.roof == RoofKind::kGable && main.along_u != wing.along_u);
  if (!falls_here) return false;
  if (wing.along_u) return (wing.u1 == main.u0 || wing.u0 == main.u1) && wing.v0 >= main.v0 && wing.v1 <= main.v1;
  return (wing.v1 == main.v0 || wing.v0 == main.v1) && wing.u0 >= main.u0 && wing.u1 <= main.u1;
}

}  // namespace

void JoinWings(Shape* shape) {
  for (size_t i = 0; i < shape->parts.size(); ++i) {
    Part& wing = shape->parts[i];
    wing.joins = -1;
    if (wing.roof != RoofKind::kGable) continue;
    for (size_t k = 0; k < shape->parts.size(); ++k) {
      const Part& main = shape->parts[k];
      if (k == i || !Meets(wing, main)) continue;
      if (wing.ridge_z > main.ridge_z + kTooHigh_m || wing.ridge_z < main.eave_z + kLeastRise_m) continue;
      if (wing.joins >= 0 && shape->parts[static_cast<size_t>(wing.joins)].ridge_z >= main.ridge_z) continue;
      wing.joins = static_cast<int>(k);
    }
    if (wing.joins >= 0) wing.ridge_z = std::max(wing.eave_z, std::min(wing.ridge_z, shape->parts[static_cast<size_t>(wing.joins)].ridge_z));
  }
}

}  // namespace skyquilt::buildings
