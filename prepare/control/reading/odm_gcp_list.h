// Reads OpenDroneMap's gcp_list.txt (docs.opendronemap.org/gcp): coordinate system in the first line, then x y z pixel_x pixel_y photo [name]
// [anything], separated by spaces or tabs (commas and semicolons are taken too); z may be NaN. Points without a name are told apart by their
// coordinates. OpenSfM reads the same file; its code (features.normalized_image_coordinates) has (0, 0) in the centre of the first pixel. "WGS84" is
// longitude, latitude, height.
#pragma once

#include <vector>

#include "prepare/control/reading/raw_control.h"
#include "prepare/models/photo_names.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {

// Whether the rows are those of gcp_list.txt: five numbers, then a photo; between commas or semicolons one of `photos`.
bool LooksLikeGcpList(const tables::TextTable& table, const models::PhotoNames& photos);

struct GcpList {
  RawControl control;                 // of the lines that can be read
  std::vector<LineProblem> problems;  // the others, in file order
};
// The photos help to read names with spaces.
GcpList ReadGcpList(const tables::TextTable& table, const models::PhotoNames& photos);

}  // namespace skyquilt::prepare::control
