// Reads control points and marks from tables.
//   OpenDroneMap  docs.opendronemap.org/gcp: coordinate system in the first line, then x y z pixel_x pixel_y photo [name] [anything], separated by
//                 spaces or tabs (commas and semicolons are taken too); z may be NaN. Points without a name are told apart by their
//                 coordinates. OpenSfM reads the same file; its code (features.normalized_image_coordinates) has (0, 0) in the centre of the first
//                 pixel. "WGS84" is longitude, latitude, height.
//   Pix4D         support.pix4d.com, input files: label,x,y,z [horizontal and vertical accuracy]; marks image,label,x,y from the image's corner
//   Metashape     manual, "Reference": label,x,y,z[,accuracy] below a comment with the names of the columns
//   any other     with a heading, or with `columns`
#pragma once

#include <string>

#include "prepare/control/reading/control_photos.h"
#include "prepare/control/reading/raw_control.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {

// Whether the rows are those of gcp_list.txt: five numbers, then a photo; between commas or semicolons one of `photos`.
bool LooksLikeGcpList(const tables::TextTable& table, const ControlPhotos& photos);

// All throw base::InputError with the line and how to fix it.
// The photos help to read names with spaces.
RawControl ReadGcpList(const tables::TextTable& table, const ControlPhotos& photos);
// `columns`: names, separated by commas, see control_columns.h; empty: those of the heading, else label,x,y,z[,accuracy] or, with 6 fields,
// label,x,y,z,horizontal accuracy,vertical accuracy. Throws base::UsageError for `columns` that are no names of columns.
RawControl ReadPointTable(const tables::TextTable& table, const std::string& columns);
// By its heading, else image,label,x,y.
RawControl ReadMarkTable(const tables::TextTable& table);

}  // namespace skyquilt::prepare::control
