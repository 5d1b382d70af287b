// Tables of positions of photos: OpenDroneMap's geo.txt (docs.opendronemap.org/geo), and what Pix4D, Metashape, ExifTool and people write like it.
//   geo.txt   first line the coordinate system (EPSG:n, a PROJ string or WGS84 UTM 32N), then per photo
//             name x y [z] [omega phi kappa] [horizontal and vertical accuracy, m] [anything]; x is east or longitude. The angles are not used.
//   columns   by a heading in the first row or in a comment above it (see prepare/control/reading/control_columns.h), else as in geo.txt; a row of
//   name, x, y,
//             z and two numbers more has accuracies without angles, as Pix4D writes them. Without a coordinate system, columns that are named
//             longitude and latitude are WGS84.
//   names     may have spaces, quotes, folders of another computer, or lack their extension: see PhotoNames::Find
// The dialects of prepare/tables/text_table.h are understood. NaN or nothing for z is no height; for x or y, or both 0, it is no position, and the
// row counts for nothing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::georeference {

struct GeoRow {
  std::string photo;            // as the file names it
  std::optional<size_t> index;  // into the photos, of the one that it names
  geo::Geodetic position;       // the height is NaN when the row has none
  std::optional<double> horizontal_accuracy_m, vertical_accuracy_m;
  int line = 0;
};

struct GeoTable {
  std::vector<GeoRow> rows;           // in file order, at least one; no two of one photo
  bool exchanged = false;             // x and y were taken the other way round
  std::vector<std::string> warnings;  // lines to be logged, with the file's name
};

// `photos`: for their names, and for the tags' positions. x and y are exchanged, with a warning, when that is proved: most rows are no places as they
// are written but all are the other way round; or, unless a heading names the axes, as written they are far from the photos' own tags (more than a
// kilometre, and ten times as far as the other way round) and the other way round within a kilometre, by the medians. Throws base::InputError with
// the line and how to fix it.
GeoTable ReadGeoTable(const std::filesystem::path& file, const std::vector<input::PhotoFile>& photos);

}  // namespace skyquilt::prepare::georeference
