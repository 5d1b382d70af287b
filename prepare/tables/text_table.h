// The tables in which programs and people exchange control points, marks and positions of photos: a row per line, fields separated by commas,
// semicolons, tabs or spaces. A byte order mark, CRLF, empty lines, quotes around fields and lines that begin with '#' are allowed. What such a table
// is about is decided elsewhere.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare::tables {

struct TableRow {
  int line = 0;  // in the file, from 1
  std::vector<std::string> fields;
};

struct TextTable {
  std::filesystem::path file;
  std::string crs;  // a first line, or a comment "CoordinateSystem: ...", that is a coordinate system; else empty
  int crs_line = 0;
  char separator = ',';              // '\t': tabs alone, so that fields may be empty or have spaces; ' ': spaces and tabs, as many as there are
  bool decimal_comma = false;        // numbers may have one
  std::vector<std::string> heading;  // fields of the comment right before the first row; empty: there is none
  std::vector<TableRow> rows;
  std::string first_row = {};  // as it is written
};

// Commas separate, unless the first row has a semicolon, all rows have tabs, or commas stand only inside of numbers between spaces or tabs. Throws
// base::InputError when the text has a line that no table has (longer than 64 KiB, or with control characters).
TextTable ParseTextTable(const std::filesystem::path& file, const std::string& text);

// A number of a file: '.' or, with `decimal_comma`, one ',' before its decimals. Nothing when it is no number or larger than 1e9.
std::optional<double> ParseTableNumber(const std::string& text, bool decimal_comma);
// What programs write where they have no number: nothing, "NaN", "None", "null", "n/a", in any case.
bool IsNoValue(const std::string& text);

// Throws base::InputError that names the line; 0: none.
[[noreturn]] void FailTableLine(const std::filesystem::path& file, int line, const std::string& found, const std::string& fix);

}  // namespace skyquilt::prepare::tables
