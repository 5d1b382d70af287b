// Learned perceptual distance (Zhang et al. 2018) by a network that the user brings as an ONNX file; lower is better, 0 for identical images.
// The network: two inputs of 1 x 3 x H x W floats, RGB in [-1,1], display values; one output of one number. H and W free, or fixed to the photos'
// size. For instance the `lpips` Python package's LPIPS(net='alex') exported by torch.onnx.export. Run by OpenCV on the CPU, deterministic.
#pragma once

#include <filesystem>
#include <memory>

#include "core/image/image.h"

namespace skyquilt::metrics {

class Lpips {
 public:
  // Throws base::InputError: missing, not ONNX, not two inputs and one output, or with layers that OpenCV cannot run.
  explicit Lpips(const std::filesystem::path& onnx_file);
  ~Lpips();
  Lpips(Lpips&&) noexcept;

  // a, b: RGB in [0,1], equal sizes. Where the mask (may be null) is 0 both images are made mid-grey, so that only the rest differs.
  // Throws base::InputError if the network does not run at this size or gives more than one number. Not thread-safe.
  double Distance(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::metrics
