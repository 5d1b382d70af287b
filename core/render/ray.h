// A ray to be rendered, and its rendered colour, opacity and depth. Frame: survey ENU, metres, double.
#pragma once

#include <Eigen/Core>

namespace skyquilt::render {

// direction_enu has length 1. Only the interval [t_near, t_far] is rendered (by default the whole ray).
struct Ray {
  Eigen::Vector3d origin_enu;
  Eigen::Vector3d direction_enu;
  double t_near = 0.0;
  double t_far = 1e30;
  // What the ray stands for: a cone or a column of this width at distance t. Both 0: a line.
  float pixel_pitch = 0.0F;  // growth of the width per metre of t; of a camera's pixel its angle in radians
  float pixel_width = 0.0F;  // width at t = 0, metres

  // Metres across the ray that belong to its pixel at distance t.
  double Footprint(double t) const { return static_cast<double>(pixel_width) + static_cast<double>(pixel_pitch) * t; }
};

struct RayColor {
  float rgb_srgb[3] = {0, 0, 0};         // display values at reference exposure, premultiplied by opacity (over black)
  float concealed_light[3] = {0, 0, 0};  // concealed rendering (core/brightness/luminance.h): premultiplied linear light; 0 without one
  float opacity = 0.0F;                  // 1 - final transmittance
  float depth = 0.0F;                    // mean of t by compositing weight, metres along the ray; NaN where opacity is 0
  float depth_median = 0.0F;             // t where the transmittance falls below 0.5; NaN if it never does
  float depth_front = 0.0F;              // the same for 0.85: front of the surface
  float depth_back = 0.0F;               // the same for 0.15: back of the surface
  // With EngineOptions::normals: means by compositing weight, ENU, out of the surface, length 1; 0 where there is none. Last, see ray_request.cpp.
  float density_normal[3] = {0, 0, 0};    // of the density's gradient
  float predicted_normal[3] = {0, 0, 0};  // of the fields' heads
};

}  // namespace skyquilt::render
