// Pictures of a building: its model drawn over a photo, and its facades as orthophotos.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "buildings/building.h"
#include "buildings/files/file_frame.h"
#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/image/image.h"
#include "core/survey/survey.h"
#include "surface/surface_input.h"

namespace skyquilt::buildings {

// The photo (index into survey.photos) that shows the building best: whole in the image, near its middle, large, preferably oblique; nothing when no
// photo shows at least half of it. Other buildings in between are not considered.
std::optional<int> BestPhoto(const Building& building, const survey::Survey& survey);
// A rectangle of a photo around the building with a margin: pixels of an image of this width.
struct PhotoPart {
  int left = 0, top = 0, width = 0, height = 0;
};
PhotoPart PartAround(const Building& building, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu);
// Draws the edges of the lod22 solid into a copy of `part` of the picture (RGB): hidden edges thin, roof edges bright, distortion of the lens
// respected. camera: of the size of the picture.
image::Image8 DrawModel(const Building& building, const image::Image8& picture, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu,
                        const PhotoPart& part);

// One picture per outer wall face of the lod22 solid at least 1 m wide, seen straight on: facade_<id>_<n>.png, with facade_<id>.json: for each its
// size of a pixel, the corner points of the picture in the coordinates of buildings.csv, the azimuth of its normal and the wall's width and height;
// names of lengths end with _m when the scale is known. pixel_m: in the survey's frame.
// caster: renders the scene. Rays begin up to 3 m in front of the wall (less where another wall of the building is nearer) and are shown where the
// field is opaque within 1.5 m behind it; transparent elsewhere. Returns the files. Throws base::InputError, base::Interrupted.
std::vector<std::filesystem::path> WriteFacades(const Building& building, const surface::RayCaster& caster, const FileFrame& frame, double pixel_m,
                                                const std::filesystem::path& folder, base::ThreadPool& threads);

}  // namespace skyquilt::buildings
