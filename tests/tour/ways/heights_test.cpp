#include "tour/ways/heights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

namespace skyquilt::tour {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <typename T>
void AppendTo(std::string* bytes, const T& value) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

// Points of a map whose grid is turned by an angle, counter-clockwise; rows go south.
std::string Terrain(int columns, int rows, double step_m, double turn_rad, const std::function<float(int column, int row)>& z) {
  std::string bytes = "SKYTERR1";
  AppendTo(&bytes, static_cast<uint32_t>(columns));
  AppendTo(&bytes, static_cast<uint32_t>(rows));
  for (const double value : {1000.0, 2000.0, 300.0}) AppendTo(&bytes, value);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double u = step_m * column, v = -step_m * row;
      AppendTo(&bytes, static_cast<float>(u * std::cos(turn_rad) - v * std::sin(turn_rad)));
      AppendTo(&bytes, static_cast<float>(u * std::sin(turn_rad) + v * std::cos(turn_rad)));
      AppendTo(&bytes, z(column, row));
    }
  }
  return bytes;
}

TEST(Heights, AnswerForColumnsAndWhatIsNearThem) {
  const Heights heights({10.0, 20.0}, {2.0, 3.0}, 2, 2, {1.0, 2.0, kNaN, 4.0});
  EXPECT_EQ(heights.At(10.5, 20.5), 1.0);
  EXPECT_EQ(heights.At(13.9, 25.9), 4.0);
  EXPECT_FALSE(heights.At(10.5, 24.0).has_value());
  EXPECT_FALSE(heights.At(14.0, 21.0).has_value());
  EXPECT_FALSE(heights.At(9.9, 21.0).has_value());
  EXPECT_EQ(heights.Highest(11.0, 21.0, 0.5), 1.0);
  EXPECT_EQ(heights.Highest(11.0, 21.0, 1.5), 2.0);
  EXPECT_EQ(heights.Highest(11.0, 21.0, 2.5), 4.0) << "the corner is sqrt(5) away";
  EXPECT_EQ(heights.Highest(0.0, 0.0, 5.0), Heights::kNothing);
  // Straight above a column, and beside one.
  EXPECT_DOUBLE_EQ(heights.Dilated(13.0, 24.5, 1.0), 5.0);
  EXPECT_DOUBLE_EQ(heights.Dilated(14.6, 24.5, 1.0), 4.8);
  EXPECT_EQ(heights.Dilated(15.0, 24.5, 1.0), Heights::kNothing) << "exactly as far as is asked for";
  EXPECT_DOUBLE_EQ(heights.Dilated(15.0, 24.5, 1.0, 0.4), 4.8) << "at most 0.4 m from here";
}

// The surface that is drawn between the points is nowhere above the columns.
TEST(Heights, OfATerrainHoldItsMeshHoweverItIsTurned) {
  for (const double turn : {0.0, 0.03, -0.4, 0.7853}) {
    const auto z = [](int column, int row) { return static_cast<float>((column * 7 + row * 13) % 11); };
    const std::string bytes = Terrain(9, 7, 1.5, turn, z);
    const std::optional<Heights> heights = HeightsFromTerrain(bytes);
    ASSERT_TRUE(heights.has_value());
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 8; ++column) {
        for (const double a : {0.001, 0.5, 0.999}) {
          for (const double b : {0.001, 0.5, 0.999}) {
            const double u = 1.5 * (column + a), v = -1.5 * (row + b);
            const double x = 1000.0 + u * std::cos(turn) - v * std::sin(turn), y = 2000.0 + u * std::sin(turn) + v * std::cos(turn);
            float top = 0.0F;
            for (const int i : {0, 1}) {
              for (const int j : {0, 1}) top = std::max(top, z(column + i, row + j));
            }
            const std::optional<double> at = heights->At(x, y);
            ASSERT_TRUE(at.has_value());
            EXPECT_GE(*at, 300.0 + static_cast<double>(top)) << turn << ": " << column << ", " << row;
          }
        }
      }
    }
  }
}

TEST(Heights, OfATerrainWithoutSurfaceAreNone) {
  EXPECT_FALSE(HeightsFromTerrain(Terrain(3, 3, 1.0, 0.0, [](int, int) { return std::nanf(""); })).has_value());
  // One point: a metre to each side.
  const auto one = HeightsFromTerrain(Terrain(3, 3, 1.0, 0.0, [](int column, int row) { return column == 1 && row == 1 ? 5.0F : std::nanf(""); }));
  ASSERT_TRUE(one.has_value());
  EXPECT_EQ(one->At(1001.5, 1998.5), 305.0);
  EXPECT_FALSE(one->At(1003.0, 1999.0).has_value());
}

TEST(Heights, DamagedTerrainIsRefused) {
  const std::string good = Terrain(3, 4, 1.0, 0.0, [](int, int) { return 1.0F; });
  EXPECT_THROW(HeightsFromTerrain(""), std::runtime_error);
  EXPECT_THROW(HeightsFromTerrain("SKYPNTS1" + good.substr(8)), std::runtime_error);
  EXPECT_THROW(HeightsFromTerrain(good.substr(0, good.size() - 1)), std::runtime_error);
  std::string wide = good;
  wide[10] = '\1';  // 65,539 columns
  EXPECT_THROW(HeightsFromTerrain(wide), std::runtime_error);
  std::string torn = good;
  const float far = 1e9F;
  std::memcpy(torn.data() + 40, &far, sizeof(far));
  EXPECT_THROW(HeightsFromTerrain(torn), std::runtime_error);
  EXPECT_NO_THROW(HeightsFromTerrain(good));
}

}  // namespace
}  // namespace skyquilt::tour
