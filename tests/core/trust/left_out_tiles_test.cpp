#include "core/trust/left_out_tiles.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace skyquilt::trust {
namespace {

TEST(LeftOutTiles, AreAboutTheShareThatIsAskedFor) {
  const LeftOutTiles tiles{0.03};
  int left_out = 0, all = 0;
  for (size_t photo = 0; photo < 50; ++photo) {
    for (int y = 0; y < 480; y += LeftOutTiles::kSide) {
      for (int x = 0; x < 640; x += LeftOutTiles::kSide, ++all) left_out += tiles.At(photo, x, y) ? 1 : 0;
    }
  }
  EXPECT_NEAR(left_out, 0.03 * all, 4.0 * std::sqrt(0.03 * all));
}

TEST(LeftOutTiles, OfShareZeroAreNone) {
  for (int x = 0; x < 5000; ++x) {
    ASSERT_FALSE(LeftOutTiles{}.At(3, x, 17));
    ASSERT_FALSE(LeftOutTiles{}.Touch(3, x, 17, 8));
  }
}

RC_GTEST_PROP(LeftOutTiles, TouchIsWhetherAnyPixelOfTheSquareIsLeftOut, ()) {
  const LeftOutTiles tiles{0.2};
  const auto photo = static_cast<size_t>(*rc::gen::inRange(0, 20));
  const int x = *rc::gen::inRange(0, 300), y = *rc::gen::inRange(0, 300), size = *rc::gen::inRange(1, 40);
  bool any = false;
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u) any = any || tiles.At(photo, x + u, y + v);
  }
  RC_ASSERT(tiles.Touch(photo, x, y, size) == any);
}

RC_GTEST_PROP(LeftOutTiles, AreWhole, ()) {
  const LeftOutTiles tiles{0.3};
  const int column = *rc::gen::inRange(0, 100), row = *rc::gen::inRange(0, 100);
  const int side = LeftOutTiles::kSide;
  const int x = column * side + *rc::gen::inRange(0, side), y = row * side + *rc::gen::inRange(0, side);
  RC_ASSERT(tiles.At(5, x, y) == tiles.At(5, column * side, row * side));
}

}  // namespace
}  // namespace skyquilt::trust
