// Colours of photos at places of the survey, and in another light.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "core/survey/photo_pictures.h"

namespace skyquilt::survey {

// Display values of 0..1 and linear light of 0..4 (more is cut) from tables, to about 1e-4.
float QuickLight(float display);
float QuickDisplay(float light);

// The pixel of a photo that shows a place, in a picture of `width` x `height` pixels whose camera this is. Nothing outside.
std::optional<Eigen::Vector2d> PixelIn(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& place_enu);
bool IsMasked(const PhotoPicture& picture, const Eigen::Vector2d& pixel);
// Distance from the principal point over the farthest corner's, squared.
float Radius2(const camera::Camera& camera, const Eigen::Vector2d& pixel);

// Display values between the pixels: linear between the nearest four, or from the nearest 6 x 6 (Lanczos-3, to 1/512 of a pixel), cut
// to 0..1.
std::array<float, 3> LinearAt(const PhotoPicture& picture, const Eigen::Vector2d& pixel);
std::array<float, 3> LanczosAt(const PhotoPicture& picture, const Eigen::Vector2d& pixel);
// The same in another light: factors on linear light.
std::array<float, 3> InLight(const std::array<float, 3>& display, const std::array<float, 3>& factors);

}  // namespace skyquilt::survey
