// The tables in which control points and marks are exchanged: a row per line, fields separated by commas, semicolons, tabs or spaces. A byte order
// mark, CRLF, empty lines, quotes around fields and lines that begin with '#' are allowed. What such a table is about is decided elsewhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::prepare {

struct TableRow {
  int line = 0;  // in the file, from 1
  std::vector<std::string> fields;
};

struct ControlTable {
  std::filesystem::path file;
  std::string crs;  // a first line, or a comment "CoordinateSystem: ...", that is a coordinate system; else empty
  int crs_line = 0;
  char separator = ',';              // ' ': spaces and tabs
  std::vector<std::string> heading;  // fields of the comment right before the first row; empty: there is none
  std::vector<TableRow> rows;

  // In tables with ';' numbers may have a decimal comma.
  bool DecimalComma() const { return separator == ';'; }
};

// Throws base::InputError when the text has a line that no table has (longer than 64 KiB, or with control characters).
ControlTable ParseControlTable(const std::filesystem::path& file, const std::string& text);

}  // namespace skyquilt::prepare
