// Writes the files of a simulated survey: photos like those of a drone, the COLMAP model of the true poses, and the truth (see simulate.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/geo/enu_frame.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"
#include "simulate/flight.h"
#include "simulate/photo_renderer.h"
#include "simulate/place_spec.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

// Stored pixels at normal exposure are linear light times this: grass in the sun gets a medium brightness.
inline constexpr float kNormalExposure = 1.35F;

// How a camera turns linear light into stored pixels.
struct Development {
  std::array<double, 3> gain = {1.0, 1.0, 1.0};               // red, green, blue, relative to normal exposure
  double vignetting = 0.0;                                    // fraction of light lost in the farthest corner, 0 to below 1
  Eigen::Vector2d principal_point = Eigen::Vector2d::Zero();  // pixels, the centre of the vignetting
};

// Linear light times gain times vignetting, clipped to [0, 1] and converted to sRGB. Vignetting is exp(log(1 - vignetting) r^2), where r is the
// distance from the principal point, 1 at the farthest corner.
image::Image8 Develop(const image::ImageF& rgb_linear, const Development& development);
// What the photo's EXIF and XMP tags say. `frame`: of the plan's ENU metres.
survey::PhotoTags MakeTags(const PhotoPlan& photo, const camera::Camera& camera, const geo::EnuFrame& frame);
// images/<name> with these tags.
void WritePhoto(const std::filesystem::path& folder, const PhotoPlan& photo, const image::Image8& pixels, const camera::Camera& camera,
                const geo::EnuFrame& frame, int jpeg_quality);
// The true poses in ENU metres; image ids are index + 1.
survey::ColmapModel MakeModel(const camera::Camera& camera, const std::vector<PhotoPlan>& photos, std::vector<survey::ColmapPoint> points);
// sparse/0: cameras, images and points3D in COLMAP's binary format, with the projections of the points as observations.
void WriteModel(const std::filesystem::path& folder, const survey::ColmapModel& model);
// truth/depth/<stem>.tiff, truth/normals/<stem>.png and truth/classes/<stem>.png of a photo.
void WriteSurfaceTruth(const std::filesystem::path& folder, const PhotoPlan& photo, const SurfaceImages& surfaces);
// truth/classes/<stem>.png alone.
void WriteClasses(const std::filesystem::path& folder, const PhotoPlan& photo, const SurfaceImages& surfaces);
// truth/exposure.json
void WriteExposureTruth(const std::filesystem::path& folder, const std::vector<PhotoPlan>& photos, const PlaceSpec& place);
// simulate.json: options, origin and suggested blocks. Written last, so it exists only when the survey is complete. model_from_enu: nothing if the
// model is in the exact frame.
void WriteSummary(const std::filesystem::path& folder, const PlaceSpec& place, const SimulateOptions& options, const geo::EnuFrame& frame,
                  size_t n_photos, const std::optional<geo::Similarity3d>& model_from_enu);

}  // namespace skyquilt::simulate
