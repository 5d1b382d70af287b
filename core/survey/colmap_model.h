// Reads and writes the sparse models of COLMAP 3.8 (cameras, images, points3D), which give the poses of the photos.
// Frame: the model's own, of any scale; cam_from_world, camera looks along +z, y down.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/transform.h"

namespace skyquilt::survey {

struct ColmapImage {
  uint32_t id = 0;
  uint32_t camera_id = 0;
  std::string name;
  geo::Rigid3d cam_from_world;
  // Images of one number were taken at once by the cameras of a rig; negative: alone. Files of models do not hold this.
  int shot = -1;
  geo::Rigid3d cam_from_rig = {};  // in the model's units
};

struct ColmapPoint {
  uint64_t id = 0;
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
  double error_px = 0.0;
  std::vector<uint32_t> image_ids;  // the track: one image id per observation
};

struct ColmapModel {
  std::map<uint32_t, camera::Camera> cameras;
  std::vector<ColmapImage> images;
  std::vector<ColmapPoint> points;
  std::set<uint32_t> exact_cameras;  // those that no adjustment changes, as they are known exactly; files of models do not hold this
};

// Where an image shows a point: what the bundle adjustment fitted.
struct ColmapObservation {
  uint64_t point_id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // core/camera/camera.h
};

// Per image id. Features that belong to no point are left out.
using ColmapObservations = std::map<uint32_t, std::vector<ColmapObservation>>;

// Reads cameras, images and points3D from `folder`, as .bin (preferred) or .txt. 2-D observations are skipped, points with NaN are dropped with a
// warning. Throws base::InputError: missing files, truncation, unsupported camera model, impossible sizes, NaN in a pose (names the image),
// contradictions.
ColmapModel ReadColmapModel(const std::filesystem::path& folder);
// Number of images with a pose in a binary model, without reading the rest. Throws base::InputError: missing files, truncation.
size_t CountColmapImages(const std::filesystem::path& folder);
// Reads the 2-D observations of the same model; an image without any has an empty list. They may name points that ReadColmapModel dropped. Throws
// base::InputError: missing files, truncation, an image twice, a pixel that is not finite.
ColmapObservations ReadColmapObservations(const std::filesystem::path& folder);
// For models without observations: the projections of its points are written as such, as COLMAP's tools need one for each entry of a track. Numbers
// have all their digits. Throws base::InputError when the folder cannot be written; std::logic_error for a track that names an unknown image.
void WriteColmapText(const ColmapModel& model, const std::filesystem::path& folder);
// The same model in the binary format, for millions of observations: besides the model memory holds 4 bytes of each. Shows progress. When cancelled
// (base::Interrupted), earlier files of the folder stay as they are.
void WriteProjectedColmapBinary(const ColmapModel& model, const std::filesystem::path& folder);
// In the binary format with measured observations: every track entry of a point must be among its image's. Throws base::InputError when the folder
// cannot be written; std::logic_error for a track without its observation.
void WriteColmapBinary(const ColmapModel& model, const ColmapObservations& observations, const std::filesystem::path& folder);

}  // namespace skyquilt::survey
