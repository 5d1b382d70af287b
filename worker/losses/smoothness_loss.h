// Keeps a number similar between neighbouring rays: a loss of a group of rays, summed over pairs of neighbours.
#pragma once

namespace skyquilt::worker {

// The loss weight * (own - neighbour)^2 of a pair, called once for each of its two rays: adds half of the loss to *loss, because the call for the
// other ray adds the other half, and the derivative of the whole loss by `own` to *gradient.
template <typename T>
void AddSmoothnessLoss(T weight, T own, T neighbour, double* loss, T* gradient) {
  const T step = own - neighbour;
  *gradient += T(2) * weight * step;
  *loss += static_cast<double>(T(0.5) * weight * step * step);
}

}  // namespace skyquilt::worker
