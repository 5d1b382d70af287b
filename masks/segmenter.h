// Finds what is to be ignored in photos with a segmentation network.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/image.h"
#include "core/network/onnx_network.h"
#include "masks/segment_config.h"

namespace skyquilt::masks {

// Not thread-safe; each thread needs its own. Memory: the network and what it computes between input and output, about 4 bytes times input pixels
// times its channels.
class Segmenter {
 public:
  // Loads the network and runs it once. Throws base::InputError: no ONNX network, one that OpenCV cannot run, or that takes or gives other than the
  // configuration says; one input of 1 x 3 x H x W floats, one output of 1 x classes x H' x W' floats (logits or probabilities; the highest counts).
  Segmenter(const std::filesystem::path& network, const std::filesystem::path& config);

  const SegmentConfig& config() const { return config_; }
  // Changes with network, configuration and method; 16 hexadecimal digits.
  const std::string& Key() const { return key_; }
  // The photo is reduced to the configured width first, unless it is narrower. Returns a mask of the reduced photo: 0 = ignored, else 255. Throws
  // base::InputError when the network gives numbers that are not finite.
  image::Image8 Mask(const image::Image8& rgb);

 private:
  struct Tile;
  void RunTile(const image::Image8& rgb, const Tile& tile, image::Image8* mask);

  SegmentConfig config_;
  network::OnnxNetwork net_;
  std::string key_;
};

// Ignored pixels and all within `radius` pixels of one (distance of centres) are ignored. mask: one channel.
image::Image8 GrowIgnored(const image::Image8& mask, int radius);

}  // namespace skyquilt::masks
