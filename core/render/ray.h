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
  float pixel_radius = 0.0F;  // radius of the pixel's cone at t = 1 m, metres; 0: a line
};

struct RayColor {
  float rgb_srgb[3] = {0, 0, 0};         // display values at reference exposure, premultiplied by opacity (over black)
  float concealed_light[3] = {0, 0, 0};  // concealed rendering (core/brightness/luminance.h): premultiplied linear light; 0 without one
  float opacity = 0.0F;                  // 1 - final transmittance
  float depth = 0.0F;                    // mean of t by compositing weight, metres along the ray; NaN where opacity is 0
  float depth_median = 0.0F;             // t where the transmittance falls below 0.5; NaN if it never does
  float depth_front = 0.0F;              // the same for 0.85: front of the surface
  float depth_back = 0.0F;               // the same for 0.15: back of the surface
};

}  // namespace skyquilt::render
