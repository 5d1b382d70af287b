// The files of a simulated survey: photos as a drone leaves them, the COLMAP model of the true poses, and the truth beside them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <vector>

#include "core/geo/enu_frame.h"
#include "core/survey/colmap_model.h"
#include "simulate/building.h"
#include "simulate/flight.h"
#include "simulate/photo_renderer.h"
#include "simulate/place_spec.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

// What happens to linear light between scene and stored pixel.
struct Development {
  std::array<double, 3> gain = {1.0, 1.0, 1.0};               // red, green, blue, relative to normal exposure
  double vignetting = 0.0;                                    // share of light lost in the farthest corner, 0 to below 1
  Eigen::Vector2d principal_point = Eigen::Vector2d::Zero();  // pixels, the centre of the vignetting
};

// Linear light times gain, fading towards the corners as exp(log(1 - vignetting) r^2), r = distance from the principal point over that of the
// farthest corner; clipped, to sRGB.
image::Image8 Develop(const image::ImageF& rgb_linear, const Development& development);
// images/<name> with EXIF and XMP; exposure tags only where the plan has them.
void WritePhoto(const std::filesystem::path& folder, const PhotoPlan& photo, const image::Image8& pixels, const camera::Camera& camera,
                const geo::EnuFrame& frame, int jpeg_quality);
// sparse/0: cameras, images and points3D as text; image ids are index + 1.
void WriteModel(const std::filesystem::path& folder, const camera::Camera& camera, const std::vector<PhotoPlan>& photos,
                std::vector<survey::ColmapPoint> points);
// truth/exposure.json
void WriteExposureTruth(const std::filesystem::path& folder, const std::vector<PhotoPlan>& photos, const PlaceSpec& place);
// truth/buildings.json
void WriteBuildingTruth(const std::filesystem::path& folder, const std::vector<Building>& buildings, const PlaceSpec& place,
                        const geo::EnuFrame& frame);
// simulate.json: what was made and the suggested blocks. Its presence says that the survey is complete.
void WriteSummary(const std::filesystem::path& folder, const PlaceSpec& place, SimulateOptions options, const geo::EnuFrame& frame, size_t n_photos);

}  // namespace skyquilt::simulate
