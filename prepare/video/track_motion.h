// How far the picture moves between moments of a flight, by the drone's position, height and gimbal: for choosing frames without looking at them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "prepare/video/frame_motion.h"
#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

// The shift from the first state's picture to each state's, over level ground at the height of take-off. A focal length that is not tagged counts as
// 24 mm (film of 35 mm), that of most drones. Nothing when a state lacks position, a height of at least 5 m, or the direction of a camera that looks
// down at 45 degrees or steeper: then the height says little of how far away the ground is.
std::optional<std::vector<FrameShift>> ShiftsByTrack(std::span<const TrackPoint> states);

}  // namespace skyquilt::prepare::video
