// Opens a file that was written, to look into it with GDAL.
#pragma once

#include <gdal_priv.h>

#include <filesystem>
#include <memory>

namespace skyquilt::gis {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using OpenedDataset = std::unique_ptr<GDALDataset, CloseDataset>;

// `kind` is GDAL_OF_RASTER or GDAL_OF_VECTOR. Null if the file cannot be read.
inline OpenedDataset OpenDataset(const std::filesystem::path& file, unsigned kind) {
  GDALAllRegister();
  return OpenedDataset(GDALDataset::Open(file.c_str(), kind));
}

}  // namespace skyquilt::gis
