#include "buildings/shape/joined_wings.h"

#include <cstddef>

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

int MayJoin(const Shape& shape, const Part& wing) {
  int best = -1;
  if (wing.roof != RoofKind::kGable) return best;
  for (size_t i = 0; i < shape.parts.size(); ++i) {
    const Part& main = shape.parts[i];
    if (!Meets(wing, main) || wing.ridge_z > main.ridge_z + kTooHigh_m || wing.ridge_z < main.eave_z + kLeastRise_m) continue;
    if (best < 0 || main.ridge_z > shape.parts[static_cast<size_t>(best)].ridge_z) best = static_cast<int>(i);
  }
  return best;
}

}  // namespace skyquilt::buildings
