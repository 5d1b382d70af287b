#include "prepare/input/other_projects.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSkyquilt = "a Skyquilt project";
constexpr const char* kOdm = "an OpenDroneMap project";
constexpr const char* kOpensfm = "an OpenSfM data set";
constexpr const char* kColmap = "a COLMAP project";
constexpr const char* kNerfstudio = "a nerfstudio data set";
constexpr const char* kPix4d = "a Pix4D project";

bool Has(const fs::path& folder, const char* name) {
  std::error_code ignored;
  return fs::exists(folder / name, ignored);
}

// These names nobody gives to photos.
bool IsOdmResult(const std::string& name) {
  static const std::set<std::string> names = {"odm_orthophoto", "odm_texturing",    "odm_texturing_25d",  "odm_dem", "odm_report", "odm_meshing",
                                              "odm_23dmesh",    "odm_filterpoints", "odm_georeferencing", "opensfm"};
  return names.contains(name);
}

bool IsPix4dResult(const std::string& name) {
  return name == "1_initial" || name == "2_densification" || name == "3_dsm_ortho" || name == "4_index";
}

bool IsSkyquiltResult(const std::string& name) {
  static const std::set<std::string> names = {"simulated", "survey", "checkpoints", "cache",  "renders", "products",
                                              "surface",   "tour",   "buildings",   "report", ".state"};
  return names.contains(name);
}

// Copies of images/ at half, a quarter, ... of its size.
bool IsReduced(const std::string& name) {
  static const std::set<std::string> sizes = {"2", "4", "8", "16"};
  const size_t line = name.rfind('_');
  return line != std::string::npos && sizes.contains(name.substr(line + 1)) && (name.starts_with("images_") || name.starts_with("masks_"));
}

}  // namespace

std::string ProjectKind(const fs::path& folder) {
  if (Has(folder, "survey/survey.json") || Has(folder, ".state/prepare.json") || Has(folder, "blocks.geojson") || Has(folder, "scene.h5")) {
    return kSkyquilt;
  }
  for (const char* name : {"odm_orthophoto", "odm_texturing", "odm_texturing_25d", "odm_dem", "odm_report", "odm_meshing", "odm_filterpoints",
                           "odm_georeferencing", "opensfm"}) {
    if (Has(folder, name)) return kOdm;
  }
  if (Has(folder, "3_dsm_ortho") || (Has(folder, "1_initial") && Has(folder, "2_densification"))) return kPix4d;
  if (Has(folder, "reconstruction.json") && (Has(folder, "exif") || Has(folder, "undistorted"))) return kOpensfm;
  if (Has(folder, "nerfstudio_models")) return kNerfstudio;
  if ((Has(folder, "transforms.json") || Has(folder, "transforms_train.json")) && Has(folder, "images")) return kNerfstudio;
  // A simulated survey has a sparse model too, and photos of its own.
  if (Has(folder, "simulate.json")) return "";
  if (Has(folder, "database.db") || Has(folder, "stereo") || Has(folder, "sparse/0") || Has(folder, "sparse/cameras.bin") ||
      Has(folder, "sparse/cameras.txt")) {
    return kColmap;
  }
  return "";
}

std::string ResultFolder(const std::string& name, const std::set<std::string>& siblings, const std::string& parent_kind) {
  if (IsOdmResult(name)) return std::string("results of ") + kOdm;
  if (IsPix4dResult(name)) return std::string("results of ") + kPix4d;
  if (name == "truth" && siblings.contains("simulate.json")) return "true surface of a simulated survey";
  if (IsReduced(name) && siblings.contains(name.substr(0, name.rfind('_')))) return "smaller copies of " + name.substr(0, name.rfind('_')) + "/";
  if (parent_kind == kSkyquilt && IsSkyquiltResult(name)) return std::string("results of ") + kSkyquilt;
  if (parent_kind == kOdm && (name.starts_with("odm_") || name == "mve" || name == "smvs" || name == "entwine_pointcloud" || name == "3d_tiles")) {
    return std::string("results of ") + kOdm;
  }
  if (parent_kind == kOpensfm && (name == "undistorted" || name == "exif" || name == "features" || name == "matches")) {
    return std::string("results of ") + kOpensfm;
  }
  if (parent_kind == kColmap && (name == "dense" || name == "stereo" || name == "sparse" || name == "undistorted")) {
    return std::string("results of ") + kColmap;
  }
  if (parent_kind == kNerfstudio && (name == "depth" || name == "depths" || name == "normals" || name == "nerfstudio_models")) {
    return std::string("results of ") + kNerfstudio;
  }
  return "";
}

}  // namespace skyquilt::prepare::input
