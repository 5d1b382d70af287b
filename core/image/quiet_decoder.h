// OpenCV's decoders, without what they print.
#pragma once

namespace skyquilt::image {

// While one exists, std::cerr is silent: OpenCV prints there what it throws (and catches itself), several lines per damaged photo, which the errors
// of our loaders say in one. Any number may exist, in any threads. The program's own log does not go through std::cerr.
class QuietDecoder {
 public:
  QuietDecoder();
  ~QuietDecoder();
  QuietDecoder(const QuietDecoder&) = delete;
  QuietDecoder& operator=(const QuietDecoder&) = delete;
};

}  // namespace skyquilt::image
