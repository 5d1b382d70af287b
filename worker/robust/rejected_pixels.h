// Pixels of photos that blocks do not learn from, in square cells. Immutable once filled, so usable by several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::worker {

class RejectedPixels {
 public:
  RejectedPixels() = default;  // of no photos: nothing is rejected
  // cell_px: side of a cell in pixels of the cached photos, at least 1.
  RejectedPixels(size_t photos, int cell_px) : cell_px_(cell_px), photos_(photos) {}

  int cell_px() const { return cell_px_; }
  size_t photos() const { return photos_.size(); }
  // cells: row by row, not 0: rejected; columns * rows of them, the last ones of a row or column may reach out of the photo.
  void Set(size_t photo, int columns, int rows, const std::vector<uint8_t>& cells);
  // Whether the cell of a pixel is rejected. The pixel must be inside the photo.
  bool At(size_t photo, int x, int y) const;
  // Share of a photo's cells, 0 to 1.
  double Share(size_t photo) const;

  // key: of what the pixels were found from. Throws base::InputError when the file cannot be written.
  void Save(const std::string& key, const std::filesystem::path& file) const;
  // Throws base::InputError when the file cannot be read, is damaged, or has another key.
  static RejectedPixels Load(const std::string& key, const std::filesystem::path& file);

 private:
  struct Photo {
    int columns = 0, rows = 0;
    std::vector<uint8_t> bits = {};  // one per cell; empty: none is rejected
  };

  int cell_px_ = 1;
  std::vector<Photo> photos_;
};

}  // namespace skyquilt::worker
