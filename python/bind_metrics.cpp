#include <pybind11/stl.h>

#include <optional>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/metrics/flip.h"
#include "core/metrics/psnr.h"
#include "core/metrics/ssim.h"
#include "python/arrays.h"
#include "python/attend.h"
#include "python/bindings.h"

namespace skyquilt::python {
namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Bytes = py::array_t<uint8_t, py::array::c_style | py::array::forcecast>;

template <typename T>
image::BasicImage<T> ImageOf(const py::array_t<T, py::array::c_style | py::array::forcecast>& array) {
  image::BasicImage<T> image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
                             array.ndim() == 2 ? 1 : static_cast<int>(array.shape(2)));
  std::copy_n(array.data(), array.size(), image.data.begin());
  return image;
}

// Two pictures of the same shape and what counts of them; the package has checked the shapes.
struct Pair {
  image::ImageF a, b;
  std::optional<image::Image8> mask;
  const image::Image8* Mask() const { return mask ? &*mask : nullptr; }
};

Pair PairOf(const Floats& a, const Floats& b, const std::optional<Bytes>& mask) {
  return {ImageOf<float>(a), ImageOf<float>(b), mask ? std::optional(ImageOf<uint8_t>(*mask)) : std::nullopt};
}

py::array MapOf(image::ImageF map) {
  return ListArray(std::move(map.data), {map.height, map.width});
}

}  // namespace

void BindMetrics(py::module_& module) {
  module.def(
      "psnr",
      [](const Floats& a, const Floats& b, const std::optional<Bytes>& mask) {
        const Pair pair = PairOf(a, b, mask);
        double score = 0.0;
        Attend([&] { score = metrics::Psnr(pair.a, pair.b, pair.Mask()); });
        return score;
      },
      py::arg("a"), py::arg("b"), py::arg("mask"));
  module.def(
      "ssim",
      [](const Floats& a, const Floats& b, const std::optional<Bytes>& mask) {
        const Pair pair = PairOf(a, b, mask);
        image::ImageF map;
        double score = 0.0;
        Attend([&] { score = metrics::Ssim(pair.a, pair.b, pair.Mask(), &map); });
        return std::make_pair(score, MapOf(std::move(map)));
      },
      py::arg("a"), py::arg("b"), py::arg("mask"));
  module.def(
      "flip",
      [](const Floats& a, const Floats& b, const std::optional<Bytes>& mask, int threads) {
        const Pair pair = PairOf(a, b, mask);
        image::ImageF map;
        double score = 0.0;
        Attend([&] {
          base::ThreadPool pool(threads);
          score = metrics::Flip(pair.a, pair.b, pair.Mask(), pool, &map);
        });
        return std::make_pair(score, MapOf(std::move(map)));
      },
      py::arg("a"), py::arg("b"), py::arg("mask"), py::arg("threads"));
}

}  // namespace skyquilt::python
