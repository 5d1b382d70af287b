// Panoramas of all directions from places of a flight, as 360-degree cameras and drones take them.
#pragma once

#include <filesystem>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/enu_frame.h"
#include "core/image/image.h"
#include "simulate/flight.h"

namespace skyquilt::simulate {

// `n` of the places of the flight's photos, evenly chosen in their order, without those that look obliquely while there are others; all of them when
// there are fewer. The camera is level, its middle looks where the photo's gimbal points in the plane; exposures and tags are the photo's. Names are
// PANO_0001.jpg and so on.
std::vector<PhotoPlan> PlanPanoramas(const std::vector<PhotoPlan>& photos, int n);

// FOLDER/<name> with place, time and exposure like the flight's photos, and GPano tags: heading where the photo has gimbal tags. `camera`: that of
// the photos, of which nothing is written. `frame`: of the plan's ENU metres.
void WritePanorama(const PhotoPlan& plan, const image::Image8& pixels, const camera::Camera& camera, const geo::EnuFrame& frame, int jpeg_quality,
                   const std::filesystem::path& folder);
// CSV: name, and the true pose, cam_from_enu (core/camera/equirectangular.h): rotation_w, _x, _y, _z, translation_x_m, _y_m, _z_m.
void WritePanoramaPoses(const std::vector<PhotoPlan>& plans, const std::filesystem::path& file);

}  // namespace skyquilt::simulate
