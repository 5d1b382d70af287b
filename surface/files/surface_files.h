// Writes the mesh and the cloud in the formats of other programs. All files are complete or absent: they are written under another name and renamed
// by Close.
//   mesh.glb               binary glTF 2.0, one material per tile; y up, easting - offset, height - offset, -(northing - offset)
//   mesh.obj, mesh.mtl, mesh_<tile>.jpg    Wavefront OBJ
//   mesh.ply               binary, coordinates minus offset, normals, colour and number of views per vertex
//   cloud.las              LAS 1.4, point format 7, WKT of the CRS, coordinates of the maps; cloud_<n>.las above kLasPoints points each
//   cloud.ply              the same points, minus offset
//   tiles/tileset.json, tiles/<level>_<column>_<row>.glb   3D Tiles 1.1; root transform from ENU to ECEF
//   georeference.json      CRS, offset, vertical datum and how to use them; offset.txt the offset alone, as ODM and CloudCompare take it
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "surface/map_frame.h"
#include "surface/mesh.h"
#include "surface/written_file.h"

namespace skyquilt::surface {

struct FileSelection {
  bool glb = true, obj = true, ply = true, cloud = true, tiles = true;
};

class SurfaceFiles {
 public:
  static constexpr int64_t kLasPoints = 20'000'000;

  // tile_size_m: of level 0. las_points: for tests. Keeps a reference to the frame. Throws base::InputError when the folder cannot be written, as do
  // the other functions.
  SurfaceFiles(const MapFrame& frame, const FileSelection& selection, double tile_size_m, const std::filesystem::path& folder,
               int64_t las_points = kLasPoints);
  SurfaceFiles(MapFrame&&, const FileSelection&, double, const std::filesystem::path&, int64_t = kLasPoints) = delete;  // it keeps a reference
  ~SurfaceFiles();  // without Close: removes what is not complete
  SurfaceFiles(const SurfaceFiles&) = delete;
  SurfaceFiles& operator=(const SurfaceFiles&) = delete;

  // A tile of any level, in any order, each once; tiles of level 0 go into mesh.* too, those of every level into tiles/. Empty tiles are skipped, as
  // are triangles and points that are not finite.
  void Add(const TexturedTile& tile);
  void AddPoints(std::span<const CloudPoint> points);
  // Completes all files and returns the table of them, empty when nothing was added; georeference.json is written even then. Files of earlier calls
  // in the folder are removed, also those of formats that are not selected now: they would be of another surface. Call it once.
  std::vector<WrittenFile> Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::surface
