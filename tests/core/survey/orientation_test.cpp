#include "core/survey/orientation.h"

#include <gtest/gtest.h>

namespace skyquilt::survey {
namespace {

// As EXIF defines it: the sides of the upright picture at which the first row and the first column of the stored one are.
struct Sides {
  char row, column;
};
constexpr Sides kSides[] = {{'t', 'l'}, {'t', 'r'}, {'b', 'r'}, {'b', 'l'}, {'l', 't'}, {'r', 't'}, {'r', 'b'}, {'l', 'b'}};

Eigen::Vector2d ByDefinition(const Eigen::Vector2d& stored, const Eigen::Vector2i& size, int orientation) {
  const Sides sides = kSides[orientation - 1];
  Eigen::Vector2d shown;
  const auto place = [&](char side, double from_side, double length) {
    if (side == 't' || side == 'b') shown.y() = side == 't' ? from_side : length - from_side;
    if (side == 'l' || side == 'r') shown.x() = side == 'l' ? from_side : length - from_side;
  };
  place(sides.row, stored.y(), size.y());
  place(sides.column, stored.x(), size.x());
  return shown;
}

TEST(Orientation, AllEightAreAsExifDefinesThemAndComeBack) {
  const Eigen::Vector2i size(4000, 3000);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    for (const Eigen::Vector2d& stored : {Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(3999.5, 0.5), Eigen::Vector2d(123.456789, 2777.125)}) {
      const Eigen::Vector2d shown = UprightFromStored(stored, size, orientation);
      EXPECT_LT((shown - ByDefinition(stored, size, orientation)).norm(), 1e-9) << orientation;
      EXPECT_LT((StoredFromUpright(shown, size, orientation) - stored).norm(), 1e-9) << orientation;
      const Eigen::Vector2i shown_size = UprightSize(size, orientation);
      EXPECT_TRUE(shown.x() >= 0.0 && shown.y() >= 0.0 && shown.x() <= shown_size.x() && shown.y() <= shown_size.y()) << orientation;
    }
  }
}

TEST(Orientation, CentresOfPixelsStayCentres) {
  // The upper left pixel of a photo that is turned clockwise is shown in the upper right corner.
  EXPECT_EQ(UprightFromStored({0.5, 0.5}, {4000, 3000}, 6), Eigen::Vector2d(2999.5, 0.5));
  EXPECT_EQ(UprightFromStored({0.5, 0.5}, {4000, 3000}, 8), Eigen::Vector2d(0.5, 3999.5));
  EXPECT_EQ(UprightFromStored({0.5, 0.5}, {4000, 3000}, 3), Eigen::Vector2d(3999.5, 2999.5));
}

TEST(Orientation, UnknownNumbersChangeNothing) {
  EXPECT_FALSE(IsOrientation(0.0) || IsOrientation(9.0) || IsOrientation(1.5));
  EXPECT_EQ(UprightFromStored({3.0, 4.0}, {40, 30}, 0), Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(UprightSize({40, 30}, 9), Eigen::Vector2i(40, 30));
}

}  // namespace
}  // namespace skyquilt::survey
