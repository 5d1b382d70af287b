// The flight of a survey as a video shows it: the drone flies from photo to photo without a stop, turns at the ends of the lines, and films.
#pragma once

#include <filesystem>
#include <vector>

#include "core/geo/enu_frame.h"
#include "simulate/flight.h"
#include "simulate/place_spec.h"

namespace skyquilt::simulate {

// A frame every 1 / fps seconds along the way through the photos, which are in the order of capture: position and gimbal angles change evenly between
// them, in the time that place.speed_mps and a gimbal that turns by 45 degrees per second need. Exposures are those of the nearer photo, also those
// that no tag records. Errors of the positions are those of the photos, and change slowly between them. fps is above 0.
std::vector<PhotoPlan> PlanVideo(const PlaceSpec& place, const std::vector<PhotoPlan>& photos, int fps);

// The subtitles that DJI's drones of 2021 and later write beside a video: a block per frame with place, heights, gimbal and exposure. `frame`: of the
// plan's ENU metres.
void WriteSubtitles(const std::vector<PhotoPlan>& frames, int fps, const camera::Camera& camera, const geo::EnuFrame& frame,
                    const std::filesystem::path& file);
// CSV: frame, time_s, and the true pose, cam_from_enu: rotation_w, _x, _y, _z, translation_x_m, _y_m, _z_m.
void WriteVideoPoses(const std::vector<PhotoPlan>& frames, const std::filesystem::path& file);

}  // namespace skyquilt::simulate
