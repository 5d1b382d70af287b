// From the density network's first output to density. `raw` is row 0 of the geometry, tau the optical depth of one marching step, and t0 =
// exp(FieldConfig::density_bias) its start: with each activation a raw output of 0, which is what an untrained field gives, stands for t0.
//   exp:       tau = exp(raw + log t0). The default; Mueller et al. 2022, section 5.4. raw is the log density, up to a constant.
//
//   softplus:  tau = log(1 + exp(raw + b)), b = log(exp(t0) - 1). Barron et al. 2021, mip-NeRF.
//
//   relu:      tau = max(0, raw + t0). Mildenhall et al. 2020, NeRF, appendix A.
//
// The papers apply softplus and relu to density per unit length; here they give the optical depth of a step, so that all three are comparable.
// Without the shift t0 half of an untrained field would be where relu has no gradient, and the rest without density. Where relu gives 0 a sample has
// no gradient by density; only neighbours that share its table entries or networks can bring it back.
#pragma once

#include <string>

namespace skyquilt::field {

enum class DensityActivation { kExp, kSoftplus, kRelu };

// "exp", "softplus" or "relu".
std::string Name(DensityActivation activation);
// The reverse. Throws std::invalid_argument that lists the choices.
DensityActivation DensityActivationNamed(const std::string& name);

// What is added to raw, from density_bias = log t0: log t0, b or t0 in the formulas above.
double RawShift(DensityActivation activation, double density_bias);

// d tau / d raw from tau of one marching step: tau, 1 - exp(-tau), or 1 where tau > 0 and else 0. Does not know of an upper limit of tau.
float TauSlope(DensityActivation activation, float tau);

}  // namespace skyquilt::field
