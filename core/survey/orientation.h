// EXIF Orientation: how a viewer turns a stored photo to show it upright. Photos are used as they are stored; this converts what was measured in the
// upright picture. Pixels are counted from the upper left corner of either picture, x right and y down; the centre of the first pixel is (0.5, 0.5).
//   1 as stored        2 mirrored sideways    3 turned by 180 degrees    4 mirrored upside down
//   5 transposed       6 turned clockwise     7 transposed, then 180     8 turned counter-clockwise (by 90 degrees)
// Source: EXIF 2.3 (CIPA DC-008), tag 274: where the first row and the first column of the stored picture are to be seen.
#pragma once

#include <Eigen/Core>

namespace skyquilt::survey {

inline bool IsOrientation(double value) {
  return value == 1.0 || value == 2.0 || value == 3.0 || value == 4.0 || value == 5.0 || value == 6.0 || value == 7.0 || value == 8.0;
}

// Whether width and height are exchanged.
inline bool ExchangesSides(int orientation) {
  return orientation >= 5 && orientation <= 8;
}

// Of the upright picture, of that of the stored one; and the reverse.
inline Eigen::Vector2i UprightSize(const Eigen::Vector2i& stored, int orientation) {
  return ExchangesSides(orientation) ? Eigen::Vector2i(stored.y(), stored.x()) : stored;
}

// `stored_size`: width and height of the stored picture. Numbers outside of 1 to 8 are as 1.
inline Eigen::Vector2d UprightFromStored(const Eigen::Vector2d& pixel, const Eigen::Vector2i& stored_size, int orientation) {
  const double x = pixel.x(), y = pixel.y(), from_right = stored_size.x() - x, from_bottom = stored_size.y() - y;
  switch (orientation) {
    case 2:
      return {from_right, y};
    case 3:
      return {from_right, from_bottom};
    case 4:
      return {x, from_bottom};
    case 5:
      return {y, x};
    case 6:
      return {from_bottom, x};
    case 7:
      return {from_bottom, from_right};
    case 8:
      return {y, from_right};
    default:
      return pixel;
  }
}

inline Eigen::Vector2d StoredFromUpright(const Eigen::Vector2d& pixel, const Eigen::Vector2i& stored_size, int orientation) {
  // All but the turns by 90 degrees are their own inverse.
  const Eigen::Vector2i upright_size = UprightSize(stored_size, orientation);
  const int inverse = orientation == 6 ? 8 : orientation == 8 ? 6 : orientation;
  return UprightFromStored(pixel, upright_size, inverse);
}

}  // namespace skyquilt::survey
