// Directions of photos before any adjustment: from the gimbal's angles, or from the matches of cameras that look straight down.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "prepare/poses/seed/ground_check.h"

namespace skyquilt::prepare::poses {

// cam_from_enu by gimbal angles in degrees: yaw clockwise from north, pitch -90 straight down, positive roll lowers the right side.
Eigen::Quaterniond RotationFromAngles(double yaw_deg, double pitch_deg, double roll_deg);

// For photos that look straight down: their turn about the vertical, from matches and positions. A pair's matches give the turn between both photos,
// and the direction in which the picture moves gives the turn against the baseline of the tags; all pairs are averaged together, wrong ones lose
// their weight. Nothing for photos without known position and for those that no pair ties to others. `views` need positions only.
std::vector<std::optional<Eigen::Quaterniond>> RotationsLookingDown(const std::vector<PairRays>& pairs, const std::vector<SeedView>& views);

}  // namespace skyquilt::prepare::poses
