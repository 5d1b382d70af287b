// Camera poses of images and videos to render: those of the survey's photos, those of a file, or a built-in path.
// Angles in degrees: yaw clockwise from north (+y of ENU), pitch 0 level and -90 straight down, roll positive with the right side down.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "products/product_options.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

// Pose of a camera at `eye_enu` (metres) with these angles.
geo::Rigid3d PoseFromAngles(const Eigen::Vector3d& eye_enu, double yaw_deg, double pitch_deg, double roll_deg);
// Pose of a camera at `eye_enu` that looks at `target_enu`, with a level horizon. When it looks straight up or down, north is up in the image.
geo::Rigid3d PoseLookingAt(const Eigen::Vector3d& eye_enu, const Eigen::Vector3d& target_enu);
// Pinhole camera without distortion. fov_deg: field of view across the width, in (0, 180).
camera::Camera PinholeCamera(int width, int height, double fov_deg);
// The field of view across the width of a picture with square pixels that has this field of view across its height.
double FovAcrossWidth(double fovy_deg, int width, int height);

// Views of the named photos (names with or without folder); of all held-out photos when `names` is empty. Distortion and aspect ratio are those of
// the photo; width 0 keeps its size. Throws base::UsageError for an unknown name (suggesting the nearest) or when no photo is held out.
std::vector<View> ViewsOfPhotos(const survey::Survey& survey, const std::vector<std::string>& names, int width);

// Reads views from a JSON file: a list, or {"views": [...], "frames_between": n}. Each entry: "position_enu": [x, y, z] or "longitude", "latitude",
// "height" (ellipsoidal); "yaw", "pitch", "roll" (0 when left out); "fov" (60); "name". With frames_between > 0 the entries are key frames of a
// video: positions follow a Catmull-Rom curve, orientations and fields of view are interpolated between neighbours. Throws base::InputError that
// names the entry and the key.
std::vector<View> LoadCameraPath(const std::filesystem::path& file, const scene::SceneInfo& info, int width, int height);
// The same for the text of such a file; messages name `file`.
std::vector<View> ParseCameraPath(const std::string& text, const std::filesystem::path& file, const scene::SceneInfo& info, int width, int height);

// Point on a uniform Catmull-Rom curve (1974), at b for u = 0 and at c for u = 1.
Eigen::Vector3d CatmullRom(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d, double u);

// Frames of a path along the cameras of the survey's training photos, in the order in which they were taken (by name where times are missing): level
// pictures that look where the photos look. About two photos per second are key frames. There must be a training photo.
std::vector<View> PathAlongCameras(const survey::Survey& survey, const ProductOptions& options);

// Frames of the built-in path options.video_path, other than "cameras": "orbit" circles the scene's centre, looking 50 degrees down; "flyover"
// crosses the scene from south-west to north-east, looking ahead and down. Both stay above the highest box.
std::vector<View> BuiltInPath(const scene::SceneInfo& info, const ProductOptions& options);

}  // namespace skyquilt::products
