#include "core/field/density_activation.h"

#include <cmath>
#include <stdexcept>

namespace skyquilt::field {
namespace {

constexpr DensityActivation kActivations[] = {DensityActivation::kExp, DensityActivation::kSoftplus, DensityActivation::kRelu};

}  // namespace

std::string Name(DensityActivation activation) {
  switch (activation) {
    case DensityActivation::kSoftplus:
      return "softplus";
    case DensityActivation::kRelu:
      return "relu";
    default:
      return "exp";
  }
}

DensityActivation DensityActivationNamed(const std::string& name) {
  std::string choices;
  for (const DensityActivation activation : kActivations) {
    if (Name(activation) == name) return activation;
    choices += (choices.empty() ? "\"" : ", \"") + Name(activation) + "\"";
  }
  throw std::invalid_argument("density_activation must be one of " + choices + ", got \"" + name + "\"");
}

double RawShift(DensityActivation activation, double density_bias) {
  const double start = std::exp(density_bias);
  switch (activation) {
    case DensityActivation::kSoftplus:
      return start + std::log(-std::expm1(-start));  // log(exp(start) - 1) without overflow
    case DensityActivation::kRelu:
      return start;
    default:
      return density_bias;
  }
}

float TauSlope(DensityActivation activation, float tau) {
  switch (activation) {
    case DensityActivation::kSoftplus:
      return -std::expm1(-tau);
    case DensityActivation::kRelu:
      return tau > 0.0F ? 1.0F : 0.0F;
    default:
      return tau;
  }
}

}  // namespace skyquilt::field
