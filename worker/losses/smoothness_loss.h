// Neighbouring rays should agree about a number: a loss of a group of rays, summed over its pairs of neighbours.
#pragma once

namespace skyquilt::worker {

// weight * (own - neighbour)^2 of one pair, as seen from one of its rays: adds half of it to *loss, because the neighbour adds the other half, and
// the derivative of the whole by `own` to *gradient.
template <typename T>
void AddSmoothnessLoss(T weight, T own, T neighbour, double* loss, T* gradient) {
  const T step = own - neighbour;
  *gradient += T(2) * weight * step;
  *loss += static_cast<double>(T(0.5) * weight * step * step);
}

}  // namespace skyquilt::worker
