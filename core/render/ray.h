// A ray and what it shows. Frame: survey ENU, metres, double.
#pragma once

#include <Eigen/Core>

namespace skyquilt::render {

// One ray. Direction of length 1. The interval outside [t_near, t_far] is not evaluated (0 and infinity for all).
struct Ray {
  Eigen::Vector3d origin_enu;
  Eigen::Vector3d direction_enu;
  double t_near = 0.0;
  double t_far = 1e30;
  float pixel_radius = 0.0F;  // cone radius per metre of t
};

struct RayColor {
  float rgb_srgb[3] = {0, 0, 0};         // premultiplied by opacity over black, at reference exposure times gain, display values
  float concealed_light[3] = {0, 0, 0};  // with held-back light (core/brightness/luminance.h): premultiplied linear light; 0 without luminance
  float opacity = 0.0F;                  // 1 - final transmittance
  float depth = 0.0F;                    // metres along the ray, mean weighted; NaN where opacity is 0
  float depth_median = 0.0F;             // metres along the ray where transmittance passes 0.5; NaN if it never does
  float depth_front = 0.0F;              // the same for 0.85, the first sign of a surface,
  float depth_back = 0.0F;               // and for 0.15, where nearly all light has ended
};

}  // namespace skyquilt::render
