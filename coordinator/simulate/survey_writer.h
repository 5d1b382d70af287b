// The files of a simulated survey: photos as a drone leaves them, the COLMAP model of the true poses, and the truth beside them.
#pragma once

#include <filesystem>
#include <vector>

#include "coordinator/simulate/building.h"
#include "coordinator/simulate/flight.h"
#include "coordinator/simulate/photo_renderer.h"
#include "coordinator/simulate/preset.h"
#include "coordinator/simulate/simulate_options.h"
#include "core/geo/enu_frame.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::simulate {

// Linear light times the photo's gain, clipped, to sRGB.
image::Image8 Develop(const image::ImageF& rgb_linear, double gain);
// images/<name> with EXIF and XMP.
void WritePhoto(const std::filesystem::path& folder, const PhotoPlan& photo, const image::Image8& pixels, const camera::Camera& camera,
                const geo::EnuFrame& frame, int jpeg_quality);
// sparse/0: cameras, images and points3D as text; image ids are index + 1.
void WriteModel(const std::filesystem::path& folder, const camera::Camera& camera, const std::vector<PhotoPlan>& photos,
                std::vector<survey::ColmapPoint> points);
// truth/exposure.json
void WriteExposureTruth(const std::filesystem::path& folder, const std::vector<PhotoPlan>& photos);
// truth/buildings.json
void WriteBuildingTruth(const std::filesystem::path& folder, const std::vector<Building>& buildings, const Preset& preset,
                        const geo::EnuFrame& frame);
// simulate.json: what was made and the suggested blocks. Its presence says that the survey is complete.
void WriteSummary(const std::filesystem::path& folder, const Preset& preset, SimulateOptions options, const geo::EnuFrame& frame, size_t n_photos);

}  // namespace skyquilt::simulate
