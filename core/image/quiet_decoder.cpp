#include "core/image/quiet_decoder.h"

#include <iostream>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <streambuf>

namespace skyquilt::image {
namespace {

// Takes everything, so that the stream never fails: its state is shared by threads.
class Nowhere : public std::streambuf {
 protected:
  int overflow(int c) override { return c == traits_type::eof() ? 0 : c; }
  std::streamsize xsputn(const char* /*text*/, std::streamsize n) override { return n; }
};

struct Silence {
  std::mutex mutex;
  int users = 0;
  Nowhere nowhere;
  std::streambuf* kept = nullptr;
};

Silence& TheSilence() {
  static Silence silence;
  return silence;
}

}  // namespace

QuietDecoder::QuietDecoder() {
  Silence& silence = TheSilence();
  const std::lock_guard lock(silence.mutex);
  if (silence.users++ > 0) return;
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  silence.kept = std::cerr.rdbuf(&silence.nowhere);
}

QuietDecoder::~QuietDecoder() {
  Silence& silence = TheSilence();
  const std::lock_guard lock(silence.mutex);
  if (--silence.users == 0) std::cerr.rdbuf(silence.kept);
}

}  // namespace skyquilt::image
