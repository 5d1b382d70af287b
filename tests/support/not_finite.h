// Values that are not finite, for tests of what happens with them.
#pragma once

#include <limits>

namespace skyquilt {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr float kNanFloat = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinityFloat = std::numeric_limits<float>::infinity();

}  // namespace skyquilt
