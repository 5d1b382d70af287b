#include "core/base/random.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

namespace skyquilt::base {

double Random::Normal() {
  // 1 - u is in (0, 1], so the logarithm is finite.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - UniformDouble()));
  return radius * std::cos(2.0 * std::numbers::pi * UniformDouble());
}

std::string RandomToken() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
}

}  // namespace skyquilt::base
