// Rigs of cameras that take photos at once, in the form of COLMAP's rig_config.json (COLMAP 3.12 and later, "Rig Support" in its documentation): a
// list of rigs, each with "cameras": a list of
//   image_prefix               photos of this camera: their names begin so; what follows is the same for all photos of one shot
//   ref_sensor                 true for the one whose frame is the rig's
//   cam_from_rig_rotation      w, x, y, z; cam_from_rig_translation: metres. Of the others
//   camera_model_name, camera_params   its lens. Pictures without distortion (PINHOLE, SIMPLE_PINHOLE) with the principal point in their middle keep
//                              it; other lenses are found from the photos
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/transform.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::rigs {

struct RigCamera {
  std::string prefix;
  geo::Rigid3d cam_from_rig;
  std::string model = {};  // COLMAP's name; empty: not known
  std::vector<double> params = {};
};

struct Rig {
  std::vector<RigCamera> cameras;  // the first one is the reference: its cam_from_rig is the identity
};

// Throws base::InputError that names the file, the line and what is wrong: no such file or not this form, not exactly one reference in a rig, a
// camera without its place, a rotation that is none, a prefix twice, a lens without distortion whose
// parameters are not those of its model.
std::vector<Rig> ReadRigConfig(const std::filesystem::path& file);
std::string RigConfigText(const std::vector<Rig>& rigs);

// The file that prepare.rig names; with an empty option rig_config.json in the photo folder, or beside it when that is called images, if it is there.
// Empty: none, as with "none". Throws base::InputError when there is no such file.
std::filesystem::path FindRigConfig(const std::filesystem::path& photo_root, const std::string& option);

// Fills `rig` of the photos whose names have the prefix of a camera (the longest that fits) and logs their numbers. Throws base::InputError when no
// shot has two photos: then the prefixes fit no names, or names differ behind them.
void UseRigs(const std::vector<Rig>& rigs, const std::filesystem::path& file, std::vector<input::PhotoFile>& photos);

}  // namespace skyquilt::prepare::rigs
