// Reads control points and marks from tables.
//   Pix4D      support.pix4d.com, input files: label,x,y,z [horizontal and vertical accuracy]; marks image,label,x,y from the image's corner
//   Metashape  manual, "Reference": label,x,y,z[,accuracy] below a comment with the names of the columns
//   any other  with a heading, or with `columns`
#pragma once

#include <string>

#include "prepare/control/reading/raw_control.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {

// Both throw base::InputError with the line and how to fix it.
// `columns`: names, separated by commas, see control_columns.h; empty: those of the heading, else label,x,y,z[,accuracy] or, with 6 fields,
// label,x,y,z,horizontal accuracy,vertical accuracy. Throws base::UsageError for `columns` that are no names of columns.
RawControl ReadPointTable(const tables::TextTable& table, const std::string& columns);
// By its heading, else image,label,x,y.
RawControl ReadMarkTable(const tables::TextTable& table);

}  // namespace skyquilt::prepare::control
