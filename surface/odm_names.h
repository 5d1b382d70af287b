// The products once more under the names and in the folders that OpenDroneMap uses, for programs that expect them.
#pragma once

#include <filesystem>

namespace skyquilt::surface {

// Fills surface_folder/odm with hard links to the files that exist (copies where the file system has no links):
//   odm_orthophoto/odm_orthophoto.tif, odm_dem/dsm.tif, odm_dem/dtm.tif, odm_texturing/odm_textured_model_geo.obj (.mtl, .glb, textures),
//   odm_georeferencing/odm_georeferenced_model.las, odm_georeferencing/coords.txt, 3d_tiles/model/...
// An older odm folder is replaced. maps_folder: of orthophoto.tif and dsm.tif. Throws base::InputError.
void ProvideOdmNames(const std::filesystem::path& surface_folder, const std::filesystem::path& maps_folder);

}  // namespace skyquilt::surface
