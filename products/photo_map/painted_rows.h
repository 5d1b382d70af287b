// Rows of an orthophoto that are painted already, kept in files until the map is complete, so that a run that is killed goes on where it was.
#pragma once

#include <filesystem>
#include <string>

#include "products/photo_map/photo_map.h"

namespace skyquilt::products {

// Says what a painted cell depends on: photos (their files' sizes and times too, not their content), poses, surface and map. 16 hex digits.
std::string PaintKey(const PhotoMapInput& input);

class PaintedRows {
 public:
  // Opens the folder, or makes it; rows that were painted with another key are removed. Throws base::InputError.
  PaintedRows(std::filesystem::path folder, const std::string& key);
  // Whether these rows were painted before: then they are read into `rows`. Damaged files count as not there.
  bool Read(int first_row, size_t cells, PhotoMapRows* rows) const;
  // Throws base::InputError (disk full).
  void Write(int first_row, const PhotoMapRows& rows) const;
  // Whether there is a file of them, damaged or not.
  bool Stands(int first_row) const;
  // How many parts stand.
  int Count() const;
  // Removes the folder.
  void Remove() const;

 private:
  std::filesystem::path FileOf(int first_row) const;

  std::filesystem::path folder_;
};

}  // namespace skyquilt::products
