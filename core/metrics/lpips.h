// LPIPS, the perceptual distance of Zhang et al. 2018: closer to what people see than PSNR. Lower is better, 0 for identical images. The user
// provides the network as an ONNX file, for instance from scripts/export_lpips.py, which exports the networks of the Python package `lpips`. It has
// two inputs of 1 x 3 x H x W floats, RGB display values scaled to [-1,1], and one output of one number. H and W are free, or fixed to the size of
// the photos. Run by OpenCV on the CPU; deterministic.
#pragma once

#include <filesystem>
#include <memory>

#include "core/image/image.h"

namespace skyquilt::metrics {

class Lpips {
 public:
  // Throws base::InputError when the file is missing, is not ONNX, does not have two inputs and one output, or has layers that OpenCV cannot run.
  explicit Lpips(const std::filesystem::path& onnx_file);
  ~Lpips();
  Lpips(Lpips&&) noexcept;

  // a, b: RGB display values in [0,1], equal sizes. Where the mask (may be null) is 0, both images are set to mid-grey, so that these pixels do not
  // differ. Throws base::InputError when the network does not run at this size or gives more than one number. Not thread-safe.
  double Distance(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::metrics
