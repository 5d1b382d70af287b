// Reads single bands of a photo of any number of bands and any type of numbers (TIFF of all kinds, PNG), as stored.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::gis {

// For one thread at a time.
class PhotoBands {
 public:
  // Throws base::InputError for a file that is not such a photo, or has more than 2^30 pixels.
  explicit PhotoBands(const std::filesystem::path& file);
  ~PhotoBands();
  PhotoBands(const PhotoBands&) = delete;
  PhotoBands& operator=(const PhotoBands&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  int bands() const { return bands_; }
  // Whether the first bands are red, green and blue; GDAL makes these of some other colours (8-bit CMYK) while reading.
  bool IsRgb() const;
  // Per band, as the file describes it; empty where it does not.
  std::vector<std::string> Names() const;
  // Values of whole rows, row by row, band after band in each pixel; `bands` count from 1. What the file marks as no data, and NaN, is 0.
  // values.size() = n_rows * width * bands.size(). Throws base::InputError when the file ends early or is damaged there.
  void ReadRows(int first_row, int n_rows, std::span<const int> bands, std::span<float> values) const;

 private:
  struct Impl;
  std::filesystem::path file_;
  std::unique_ptr<Impl> impl_;
  int width_ = 0, height_ = 0, bands_ = 0;
};

}  // namespace skyquilt::gis
