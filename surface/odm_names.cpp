#include "surface/odm_names.h"

#include <string>

#include "core/base/errors.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void FailOdm(const fs::path& file, const std::error_code& error) {
  throw base::InputError(file, "cannot be made: " + error.message(), "Check the free space and permissions of its folder");
}

// The file must be whole at its new name: it was renamed there when it was complete, and nobody writes into it again.
void Provide(const fs::path& from, const fs::path& to) {
  if (!fs::exists(from)) return;
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (error) FailOdm(to.parent_path(), error);
  fs::create_hard_link(from, to, error);
  if (error) {
    error.clear();
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  }
  if (error) FailOdm(to, error);
}

// The OBJ names its material file in its head, so that file is there under both names; textures keep theirs.
void ProvideObj(const fs::path& surface_folder, const fs::path& to) {
  const fs::path obj = surface_folder / "mesh.obj";
  if (!fs::exists(obj)) return;
  Provide(obj, to / "odm_textured_model_geo.obj");
  Provide(surface_folder / "mesh.mtl", to / "mesh.mtl");
  Provide(surface_folder / "mesh.mtl", to / "odm_textured_model_geo.mtl");
  for (const fs::directory_entry& entry : fs::directory_iterator(surface_folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("mesh_") && name.ends_with(".jpg")) Provide(entry.path(), to / name);
  }
}

}  // namespace

void ProvideOdmNames(const fs::path& surface_folder, const fs::path& maps_folder) {
  const fs::path odm = surface_folder / "odm";
  std::error_code error;
  fs::remove_all(odm, error);
  if (error) FailOdm(odm, error);
  Provide(maps_folder / "orthophoto.tif", odm / "odm_orthophoto" / "odm_orthophoto.tif");
  Provide(maps_folder / "dsm.tif", odm / "odm_dem" / "dsm.tif");
  Provide(surface_folder / "dtm.tif", odm / "odm_dem" / "dtm.tif");
  ProvideObj(surface_folder, odm / "odm_texturing");
  Provide(surface_folder / "mesh.glb", odm / "odm_texturing" / "odm_textured_model_geo.glb");
  Provide(surface_folder / "offset.txt", odm / "odm_georeferencing" / "coords.txt");
  for (const fs::directory_entry& entry : fs::directory_iterator(surface_folder)) {
    // A large cloud is cut into cloud_1.las, cloud_2.las ...
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("cloud") || !name.ends_with(".las")) continue;
    Provide(entry.path(), odm / "odm_georeferencing" / ("odm_georeferenced_model" + name.substr(std::string("cloud").size())));
  }
  if (!fs::exists(surface_folder / "tiles")) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(surface_folder / "tiles")) {
    Provide(entry.path(), odm / "3d_tiles" / "model" / entry.path().filename());
  }
}

}  // namespace skyquilt::surface
