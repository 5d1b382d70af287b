// Where the camera stands for pictures and videos: at the survey's photos, along a file, or on a built-in path.
// Angles in degrees: yaw clockwise from north (+y of ENU), pitch 0 level and -90 straight down, roll positive with the right side down.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "products/product_options.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

// A pose from angles about ENU axes.
geo::Rigid3d PoseFromAngles(const Eigen::Vector3d& eye_enu, double yaw_deg, double pitch_deg, double roll_deg);
// Level horizon, looking at `target`; straight up or down looks with north up.
geo::Rigid3d PoseLookingAt(const Eigen::Vector3d& eye_enu, const Eigen::Vector3d& target_enu);
// Pinhole without distortion. fov_deg across the width, (0, 180).
camera::Camera PinholeCamera(int width, int height, double fov_deg);

// The poses of photos by name (or by their file name alone), all held-out ones when `names` is empty. Lens and aspect ratio are the photo's
// own; width 0 keeps its size. Throws base::UsageError for an unknown name (with the nearest) or when nothing is held out.
std::vector<View> ViewsOfPhotos(const survey::Survey& survey, const std::vector<std::string>& names, int width);

// A JSON list, or {"views": [...], "frames_between": n}. Each entry: "position_enu": [x, y, z] or "longitude", "latitude", "height"
// (ellipsoidal); "yaw", "pitch", "roll" (0 when left out); "fov" (60); "name". With frames_between > 0 the entries are key frames of a video:
// positions follow a Catmull-Rom curve, orientations and fields of view are interpolated between neighbours.
// Throws base::InputError naming the entry and key.
std::vector<View> LoadCameraPath(const std::filesystem::path& file, const scene::SceneInfo& info, int width, int height);

// The built-in path options.video_path: "orbit" circles the scene's centre looking 50 degrees down; "flyover" crosses it from south-west to
// north-east looking ahead and down. Both stay above the tallest box.
std::vector<View> BuiltInPath(const scene::SceneInfo& info, const ProductOptions& options);

}  // namespace skyquilt::products
