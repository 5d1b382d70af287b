// Puts the products into OpenDroneMap's folders, under its names.
#pragma once

#include <filesystem>

#include "coordinator/project/project.h"
#include "odm/after_poses.h"
#include "odm/dataset.h"
#include "odm/map_options.h"

namespace skyquilt::odm {

// Gives a file another name: a hard link, or a copy where the file system has none. `to` is replaced; it is never half a file. A file that is not
// there removes `to`. Throws base::InputError.
void ProvideFile(const std::filesystem::path& from, const std::filesystem::path& to);

// The mesh as WebODM wants it: z up, and the offset of its coordinates as the extension CESIUM_RTC; glb is that of surface/files/glb_writer.h. Only
// the description at the file's head is other. Throws base::InputError.
void WriteUprightGlb(const std::filesystem::path& glb, const Eigen::Vector3d& offset, const std::filesystem::path& to);

// Fills the dataset's folder from its project folder with what there is of:
//   odm_orthophoto/odm_orthophoto.tif (.png, .wld), cutline.gpkg      odm_dem/dsm.tif, dtm.tif
//   odm_georeferencing/odm_georeferenced_model.las, coords.txt        odm_texturing/odm_textured_model_geo.obj (.mtl, .glb, textures)
//   3d_tiles/model/tileset.json ...                                   entwine_pointcloud/ept.json ...
// What was not asked for is removed, so that it is not taken for a result of this run. cells: sizes of maps; those that are finer are written again.
// Throws base::InputError, base::Interrupted.
void PlaceProducts(const Dataset& dataset, const coordinator::Project& project, const Wishes& wishes, const MapCells& cells);

// Copies all that NodeODM packs to another folder (--copy-to). Throws base::InputError.
void CopyResults(const std::filesystem::path& dataset, const std::filesystem::path& to);
// Removes all that PlaceProducts and WriteReports wrote (--rerun-all). Throws base::InputError.
void RemoveResultFolders(const std::filesystem::path& dataset);

}  // namespace skyquilt::odm
