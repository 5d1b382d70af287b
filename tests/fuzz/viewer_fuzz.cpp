// The viewer's messages from browsers, and its frames as another client decodes them.
#include <stdexcept>

#include "tests/fuzz/fuzz_target.h"
#include "tests/viewer/protocol/sample_messages.h"
#include "viewer/protocol/frame.h"
#include "viewer/protocol/messages.h"

namespace skyquilt::fuzz {
namespace {

std::string Frame(viewer::ColorFormat format, bool orthographic) {
  viewer::FrameHeader header;
  header.passes = 1;
  header.format = format;
  header.orthographic = orthographic;
  header.width = header.w = 20;
  header.height = header.h = 17;
  header.fovy_deg_or_height_m = 50.0;
  std::vector<uint8_t> rgb(3 * 20 * 17);
  std::vector<float> z(20 * 17);
  for (size_t i = 0; i < z.size(); ++i) z[i] = i % 7 == 0 ? -1.0F : 30.0F + static_cast<float>(i % 31);
  return EncodeFrame(header, rgb, z);
}

}  // namespace

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds = viewer::SampleMessages();
  for (const bool orthographic : {false, true}) {
    for (const viewer::ColorFormat format : {viewer::ColorFormat::kJpeg, viewer::ColorFormat::kPng}) seeds.push_back(Frame(format, orthographic));
  }
  return seeds;
}

void Feed(const std::string& bytes) {
  try {
    viewer::ParseClientMessage(bytes);
  } catch (const viewer::BadMessage&) {
  }
  try {
    viewer::DecodeFrame(bytes);
  } catch (const std::runtime_error&) {
  }
}

}  // namespace skyquilt::fuzz
