// Do the gimbal angles agree with the photos themselves? Some makers write pitch with the opposite sign, measure it from straight down, or write
// zeros. Gimbal angles weigh more than all other evidence for gravity, so angles that are wrong in all photos turn the survey over: right GPS tags
// then look mirrored.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "prepare/georeference/camera_up.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

enum class GimbalUse {
  kUsed,     // nothing contradicts them, or there are none
  kDropped,  // they contradict the cameras' axes, and the tagged positions, or what the cameras look at, agree with the axes
  kDoubted,  // they contradict the cameras' axes, and nothing decides
};

struct GimbalVerdict {
  GimbalUse use = GimbalUse::kUsed;
  double angle_deg = 0.0;  // between up by gimbal angles and up by camera axes, when they contradict each other
};

// `points` are sparse points, all in the model's frame; may be empty. `tags_up` is asked for only when angles and axes contradict each other, or the
// cameras all look the same way.
GimbalVerdict JudgeGimbal(const std::vector<input::PreparedPhoto>& photos, const std::vector<Eigen::Vector3d>& points,
                          const UpByTagsFunction& tags_up);

// How angles may be wrong.
enum class GimbalFault { kNone, kOppositePitch, kFromStraightDown, kAllZero, kOther };

// What is wrong with the angles of one photo: `tagged` is the unit vector up in the camera's frame by the angles (UpInCamera), `found` by the poses.
GimbalFault FaultOfAngles(const Eigen::Vector3d& tagged, const Eigen::Vector3d& found);

// Smaller angles are no contradiction: cameras that look about straight down need not look exactly down.
constexpr double kGimbalConflict_deg = 25.0;

}  // namespace skyquilt::prepare::georeference
