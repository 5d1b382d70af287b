// Says what a segmentation network takes and gives, and what is ignored. Read from a TOML or JSON file that the user writes, or
// scripts/train_segmenter.py. docs/input.md explains the keys.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::masks {

struct SegmentConfig {
  int input_width = 0;  // pixels of the network's input
  int input_height = 0;
  int photo_width = 0;  // photos are reduced to this width; where they are larger than the input, they are cut into tiles
  int overlap = 0;      // pixels that neighbouring tiles share at least; 0 to half of the input's shorter side
  // A colour value v from 0 to 255 becomes (v * scale - mean) / std. Both in the order of the network's channels.
  double scale = 1.0 / 255.0;
  std::array<double, 3> mean{};
  std::array<double, 3> std{1.0, 1.0, 1.0};
  bool bgr = false;                  // order of the channels: blue, green, red
  std::vector<std::string> classes;  // names by the number of the network's output channel; a single one: its output is that class's probability
  std::vector<char> ignored;         // per class
  double threshold = 0.5;            // with a single class: it is where the output is at least this
  int dilate_px = 0;                 // what is ignored grows by this radius, in pixels of the reduced photo

  // Names of the classes that are ignored.
  std::vector<std::string> IgnoredClasses() const;
};

// Throws base::InputError: the file cannot be read or parsed, a key is missing, unknown or not allowed; the message names it.
SegmentConfig ReadSegmentConfig(const std::filesystem::path& file);

}  // namespace skyquilt::masks
