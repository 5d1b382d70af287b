// Positions of photos from files beside them, which are better than the photos' own tags: OpenDroneMap's geo.txt and tables like it (see
// prepare/georeference/tags/geo_table.h), and DJI's image logs (.MRK).
//   .MRK     user manuals of Zenmuse P1, Mavic 3M, Matrice 4: number of the photo in its folder, time, antenna offsets, then with the offset
//            applied latitude, longitude, ellipsoidal height, standard deviations north, east, up in metres, and the status (50: RTK fixed). The
//            manuals name longitude before latitude; the labels in the files (Lat, Lon, Ellh, Q) decide.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::georeference {

struct MrkRow {
  int number = 0;  // of the photo in its folder: DJI_0012.JPG, DJI_20230101120000_0012_V.JPG
  geo::Geodetic position;
  double horizontal_accuracy_m = 0.0, vertical_accuracy_m = 0.0;  // the larger of north and east; 0: not stated
  int status = 0;                                                 // 0 no position, 16 single, 32..49 float, 50 RTK fixed
};

// Throws base::InputError with the line and how to fix it.
std::vector<MrkRow> ReadMrkFile(const std::filesystem::path& file);

// The files that UsePositionFiles reads positions from: the table, or else the .MRK files below the photo folder in name order.
std::vector<std::filesystem::path> PositionFiles(const std::filesystem::path& photo_root, const std::string& geo_file);

// Replaces position and accuracy in the tags of the photos that the files name, and logs it. `geo_file`: given by the user; empty: geo.txt in the
// photo folder, or beside it when that is called images; else those of the folders in it, for the photos there. Without any, every .MRK serves the
// photos of its folder, unless it contradicts their tags or other .MRK files there number the same photos. Throws base::InputError for a file that
// the user gave or called geo.txt; a bad .MRK is left out with a warning.
void UsePositionFiles(const std::filesystem::path& photo_root, const std::string& geo_file, std::vector<input::PhotoFile>& photos);

}  // namespace skyquilt::prepare::georeference
