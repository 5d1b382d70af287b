// Photos of a made flight with tags only, and descriptors that tell places apart.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::test {

// A photo at x (east, north; metres) about the origin, looking straight down from 100 m.
inline prepare::input::PhotoFile PhotoAt(size_t number, const Eigen::Vector2d& x, const geo::EnuFrame& frame) {
  prepare::input::PhotoFile photo;
  photo.name = "photo_" + std::to_string(1000 + number) + ".jpg";
  photo.width = 64;
  photo.height = 48;
  photo.tags.gps = frame.GeodeticFromEnu({x.x(), x.y(), 100.0});
  photo.tags.relative_altitude_m = 100.0;
  photo.tags.gimbal_pitch_deg = -90.0;
  photo.tags.gimbal_yaw_deg = 0.0;
  photo.tags.gimbal_roll_deg = 0.0;
  return photo;
}

// Lines to the east, one north of the other.
inline std::vector<prepare::input::PhotoFile> GridPhotos(size_t lines, size_t per_line, double step_m, double between_lines_m,
                                                         const geo::Geodetic& origin) {
  const geo::EnuFrame frame(origin);
  std::vector<prepare::input::PhotoFile> photos;
  for (size_t i = 0; i < lines * per_line; ++i) {
    const auto column = static_cast<double>(i % per_line), row = static_cast<double>(i / per_line);
    photos.push_back(PhotoAt(i, {step_m * column, between_lines_m * row}, frame));
  }
  return photos;
}

// A random descriptor of length 512, sparse as those of photos are.
inline std::array<uint8_t, 128> RandomDescriptor(base::Random& random) {
  std::array<double, 128> values{};
  double length2 = 0.0;
  for (double& value : values) {
    value = std::pow(random.UniformDouble(), 4.0);
    length2 += value * value;
  }
  std::array<uint8_t, 128> row{};
  for (size_t k = 0; k < row.size(); ++k) row[k] = static_cast<uint8_t>(std::min(255.0, std::round(512.0 * values[k] / std::sqrt(length2))));
  return row;
}

// The same feature in another photo: every byte changes by up to `noise`.
inline std::array<uint8_t, 128> SeenAgain(std::array<uint8_t, 128> row, int noise, base::Random& random) {
  for (uint8_t& byte : row) {
    const int change = static_cast<int>(random.Below(static_cast<uint32_t>(2 * noise + 1))) - noise;
    byte = static_cast<uint8_t>(std::clamp(byte + change, 0, 255));
  }
  return row;
}

inline void AddRow(std::vector<uint8_t>& rows, const std::array<uint8_t, 128>& row) {
  rows.insert(rows.end(), row.begin(), row.end());
}

}  // namespace skyquilt::test
