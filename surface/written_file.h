// A line of the table of what was made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace skyquilt::surface {

struct WrittenFile {
  std::filesystem::path file;  // relative to the folder of the surface; of a set of files the one to open
  std::string content;         // "textured mesh", "point cloud", ...
  std::string format;          // "GLB", "LAS 1.4", "3D Tiles 1.1", "GeoTIFF (COG)", ...
  std::string crs;             // "EPSG:32617", "EPSG:32617 minus offset", "EPSG:4978", "local frame, metres"
  std::string vertical;        // what heights are above; empty when there are none
  int64_t bytes = 0;           // of all its files
  std::string detail;          // "335,120 triangles", "12 tiles in 4 levels", "cells of 0.2 m"; may be empty
};

}  // namespace skyquilt::surface
