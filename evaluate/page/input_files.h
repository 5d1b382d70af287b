// What `prepare` took from the photo folder and what it left out, by kind and reason: survey/input.csv for the report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::evaluate::page {

// Files that were taken or left out for one reason.
struct InputGroup {
  bool taken = false;
  std::string kind;                   // as in the table
  std::string reason;                 // of the first of them; may be empty
  bool several = false;               // the others have reasons of their own
  int64_t n = 0;                      // files, and folders of which all files were left out
  std::vector<std::string> examples;  // names of the first few
};

struct InputFiles {
  int64_t n_taken = 0;  // photos
  int64_t n_left_out = 0;
  std::vector<InputGroup> groups;  // of what was left out, and of photos taken in spite of something. Pictures first, then the largest

  // Whether pictures were left out, or photos taken in spite of something.
  bool Remarkable() const;
};

// From the table's text (RFC 4180). Empty for a table without the columns file, taken, kind and reason; lines with another number of fields than the
// heading are passed over.
InputFiles ParseInputFiles(const std::string& csv);
// Empty when there is no such file, as in projects of earlier versions, or it cannot be read.
InputFiles ReadInputFiles(const std::filesystem::path& csv);

}  // namespace skyquilt::evaluate::page
