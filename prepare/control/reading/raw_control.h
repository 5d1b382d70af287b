// What the readers of control point files give: points and marks as they are written, before photos are looked up and coordinates converted.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare::control {

struct RawPoint {
  std::string label;
  bool named = true;                                           // false: the file has no label, this one was made for messages
  Eigen::Vector3d given = Eigen::Vector3d::Zero();             // x east or longitude, y north or latitude, z, in the file's units; z NaN: no height
  std::optional<double> horizontal_sigma_m, vertical_sigma_m;  // as stated
  bool check = false;                                          // the file says so
  int line = 0;
};

// How a mark counts its pixels. All have x right and y down.
enum class PixelOrigin {
  kCorner,      // the image's upper left corner is (0, 0), the centre of its first pixel (0.5, 0.5)
  kFirstPixel,  // the centre of the first pixel is (0, 0)
  kMiddle       // the image's middle is (0, 0); the unit is its larger side
};

struct RawMark {
  std::string label;
  std::string photo;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  PixelOrigin origin = PixelOrigin::kCorner;
  Eigen::Vector2i photo_size = Eigen::Vector2i::Zero();  // of the photo that was marked, as the file states it; 0: it does not
  int line = 0;
};

struct RawControl {
  std::filesystem::path file;
  std::string format;  // for messages: "OpenDroneMap's gcp_list.txt"
  std::string crs;     // as the file states it; empty: it does not
  int crs_line = 0;
  bool order_known = true;  // false: nothing says which of x and y comes first
  std::vector<RawPoint> points;
  std::vector<RawMark> marks;
};

// A line of a file that cannot be used: what was found there, and how to fix it.
struct LineProblem {
  int line = 0;
  std::string found, fix;
};

}  // namespace skyquilt::prepare::control
