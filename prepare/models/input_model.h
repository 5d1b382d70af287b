// What a camera model from another program holds, in our conventions: pixel corner (0, 0), camera looks along +z with y down, poses cam_from_world.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/survey/colmap_model.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::prepare::models {

enum class ModelFormat { kColmap, kTransforms, kOpensfm, kMetashape, kOpf, kPosesBounds };

// As in "a Metashape cameras.xml".
std::string FormatName(ModelFormat format);

// Where the model's frame is on Earth, if the format says so. How accurate that is, no format says.
struct ModelPlace {
  std::string source;                // the file or element that says it, for messages
  geo::Geodetic origin;              // of an ENU frame; ellipsoidal height
  geo::Similarity3d enu_from_model;  // metres
};

struct InputModel {
  ModelFormat format = ModelFormat::kColmap;
  survey::ColmapModel sfm;  // ids of images and cameras are ours, except for COLMAP; points may have no track (image_ids) or be missing altogether
  std::optional<ModelPlace> place;
  std::set<std::string> test_photos;  // names in sfm.images that the model holds out of training; empty when it says nothing
  std::string set;                    // the published data set whose form it has, for messages; empty: none
  // What the format says of its frame where it does not say its place: the direction of up, and the length of its unit.
  std::optional<Eigen::Vector3d> up;
  std::optional<double> metres_per_unit;
  bool names_all_photos = false;  // pictures that it does not name are none of its photos: depths and normals beside them, other parts of a city
};

// The photos that the user gave: names of a model are matched with them, and their sizes fill in what a model does not say.
class ModelPhotos {
 public:
  // names: relative to root, '/' separated.
  ModelPhotos(std::filesystem::path root, const std::vector<std::string>& names);

  // The name among the photos that a model means by `label`: the same path, or a file below the model's folder. Nothing when there is no such photo.
  std::optional<std::string> FindPath(const std::string& label, const std::filesystem::path& model_folder) const;
  // The same, else PhotoNames::FindFileName. Otherwise the label itself, cleaned: a photo that is not there.
  std::string Resolve(const std::string& label, const std::filesystem::path& model_folder) const;
  // Width and height as stored; nothing when there is no such photo or it cannot be read.
  std::optional<Eigen::Vector2i> SizeOf(const std::string& name) const;
  bool Has(const std::string& name) const { return finder_.FindPath(name).has_value(); }

  const std::filesystem::path& root() const { return root_; }
  const std::vector<std::string>& names() const { return names_; }  // in the order in which they were given

 private:
  std::filesystem::path root_;
  std::vector<std::string> names_;
  PhotoNames finder_;
};

// Collects images and cameras with ids from 1; equal cameras are one.
class SfmBuilder {
 public:
  explicit SfmBuilder(survey::ColmapModel& sfm) : sfm_(&sfm) {}
  uint32_t AddCamera(const camera::Camera& camera);
  uint32_t AddImage(const std::string& name, uint32_t camera_id, const geo::Rigid3d& cam_from_world);
  void AddPoint(const Eigen::Vector3d& x_in_world, const std::array<uint8_t, 3>& rgb, std::vector<uint32_t> image_ids);

 private:
  survey::ColmapModel* sfm_;
};

// The rotation of a matrix that may also scale; nothing when its columns are not orthogonal (1e-3 of their length), of different length or
// left-handed.
std::optional<Eigen::Matrix3d> RotationOf(const Eigen::Matrix3d& matrix);
// Pose from the camera-to-world rotation (our axes) and the camera's centre.
geo::Rigid3d PoseFromCentre(const Eigen::Matrix3d& world_from_cam, const Eigen::Vector3d& centre_in_world);
// The simplest of our models with these parameters, in OpenCV's order and meaning (core/camera/distortion.h).
camera::Camera PerspectiveCamera(int width, int height, const Eigen::Vector2d& focal, const Eigen::Vector2d& centre, double k1, double k2, double k3,
                                 double p1, double p2);
camera::Camera FisheyeCamera(int width, int height, const Eigen::Vector2d& focal, const Eigen::Vector2d& centre, const std::array<double, 4>& k);

}  // namespace skyquilt::prepare::models
