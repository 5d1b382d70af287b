#include "masks/mask_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::masks {
namespace {

constexpr double kTint = 0.6;  // share of the tint's colour

int64_t CountIgnored(const image::Image8& mask) {
  return std::count(mask.data.begin(), mask.data.end(), uint8_t{0});
}

void LayOver(const image::Image8& part, image::Image8* mask) {
  if (part.Empty()) return;
  SKYQUILT_CHECK(part.width == mask->width && part.height == mask->height && part.channels == 1, "a mask of another size than its photo");
  for (size_t i = 0; i < part.data.size(); ++i) {
    if (part.data[i] == 0) mask->data[i] = 0;
  }
}

}  // namespace

JoinedMask Join(const MaskParts& parts, int width, int height) {
  JoinedMask joined;
  joined.mask = image::Image8(width, height, 1, 255);
  LayOver(parts.given, &joined.mask);
  joined.given = CountIgnored(parts.given);
  LayOver(parts.network, &joined.mask);
  LayOver(parts.ground, &joined.mask);
  joined.network = CountIgnored(parts.network);
  joined.ground = CountIgnored(parts.ground);
  joined.ignored = CountIgnored(joined.mask);
  joined.differs = joined.ignored != joined.given;
  return joined;
}

image::Image8 LookPicture(const image::Image8& rgb, const MaskParts& parts, int width) {
  image::Image8 picture = rgb.width > width ? image::Resize(rgb, width, image::ScaledHeight(rgb.width, rgb.height, width)) : rgb;
  const auto tint = [&picture](const image::Image8& part, const std::array<uint8_t, 3>& color, image::Image8* done) {
    if (part.Empty()) return;
    const image::Image8 mask = image::ResizeMask(part, picture.width, picture.height);
    for (size_t i = 0; i < mask.data.size(); ++i) {
      if (mask.data[i] != 0 || done->data[i] != 0) continue;
      done->data[i] = 1;
      for (size_t c = 0; c < 3; ++c) {
        uint8_t& value = picture.data[3 * i + c];
        value = static_cast<uint8_t>(std::lround(value * (1.0 - kTint) + color[c] * kTint));
      }
    }
  };
  image::Image8 done(picture.width, picture.height, 1, 0);
  tint(parts.network, {230, 30, 30}, &done);
  tint(parts.ground, {40, 90, 230}, &done);
  tint(parts.given, {128, 128, 128}, &done);
  return picture;
}

}  // namespace skyquilt::masks
