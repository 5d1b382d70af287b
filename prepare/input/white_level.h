// Which value is white in photos of more than 8 bits: one for all photos of a survey, or their relative brightness would be lost.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace skyquilt::prepare::input {

struct PhotoRange {
  double largest = 0.0;         // value that next to none of the photo's exceeds
  bool floating = false;        // numbers are not whole
  int bits = 16;                // of whole numbers, by the file's type
  std::optional<double> white;  // by its tags
};

struct WhiteLevel {
  double value = 0.0;
  std::string reason;  // for the log, as in "12 bits, by the largest value in 28 photos (4071)"
};

// By the tags where all photos have one that their values respect, else by the largest value of all: the smallest of 8, 10, 12, 14, 16 and more bits
// that holds it; for floating point 1 where nothing is above 1.5, else the same. A type of 9 to 15 bits is as good as a tag. `photos` must not be
// empty.
WhiteLevel FindWhite(std::span<const PhotoRange> photos);

}  // namespace skyquilt::prepare::input
