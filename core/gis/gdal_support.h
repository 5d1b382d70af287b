// What our files that use GDAL share. Includes GDAL's headers, so only the .cpp files of this folder may include it.
#pragma once

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/output_file.h"
#include "core/geo/height_reference.h"
#include "core/geo/utm.h"
#include "core/image/image.h"

namespace skyquilt::gis::internal {

// Keeps GDAL from printing its errors: they are reported as exceptions.
class QuietErrors {
 public:
  QuietErrors() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~QuietErrors() { CPLPopErrorHandler(); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

// Throws base::InputError with GDAL's last message.
[[noreturn]] inline void FailWriting(const std::filesystem::path& file, const std::string& what) {
  const std::string reason = CPLGetLastErrorMsg();
  throw base::InputError(file, what + (reason.empty() ? "" : ": " + reason), "Check the free space and permissions of its folder");
}

// The last data are written only when a file is closed; GDALClose reports failure only through the error state. Throws as FailWriting.
inline void CloseWritten(Dataset* dataset, const std::filesystem::path& file) {
  CPLErrorReset();
  dataset->reset();
  if (CPLGetLastErrorType() >= CE_Failure) FailWriting(file, "cannot be completed");
}

// The bands, and one more for the mask of colours that have one instead of an alpha band.
inline int BandsWithMask(GDALDataset* dataset) {
  const int bands = dataset->GetRasterCount();
  return bands == 3 && dataset->GetRasterBand(1)->GetMaskFlags() == GMF_PER_DATASET ? 4 : bands;
}

struct CellWindow {
  int x = 0, y = 0, columns = 0, rows = 0;
};
struct PixelCount {
  int columns = 0, rows = 0;
};
// Reads `bands` = BandsWithMask of a window into interleaved pixels; stride: pixels from one row of `out` to the next. `extra` may be null. False:
// see CPLGetLastErrorMsg.
inline bool ReadBands(GDALDataset* dataset, const CellWindow& window, float* out, const PixelCount& pixels, int bands, int stride,
                      GDALRasterIOExtraArg* extra) {
  const GSpacing pixel = static_cast<GSpacing>(sizeof(float)) * bands;
  const int stored = std::min(bands, dataset->GetRasterCount());
  if (dataset->RasterIO(GF_Read, window.x, window.y, window.columns, window.rows, out, pixels.columns, pixels.rows, GDT_Float32, stored, nullptr,
                        pixel, pixel * stride, sizeof(float), extra) != CE_None) {
    return false;
  }
  return stored == bands ||
         dataset->GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Read, window.x, window.y, window.columns, window.rows, out + stored, pixels.columns,
                                                            pixels.rows, GDT_Float32, pixel, pixel * stride, extra) == CE_None;
}

// Pixels without a value become NaN.
inline void ForgetNoData(GDALDataset* dataset, image::ImageF* image) {
  int has_nodata = FALSE;
  const double nodata = dataset->GetRasterBand(1)->GetNoDataValue(&has_nodata);
  if (!has_nodata) return;
  for (float& value : image->data) {
    if (value == static_cast<float>(nodata)) value = std::numeric_limits<float>::quiet_NaN();
  }
}

// A progress callback that ends GDAL's work when the program is asked to stop.
inline int ContinueUnlessCancelled(double /*fraction*/, const char* /*message*/, void* /*data*/) {
  return base::CancelRequested() ? FALSE : TRUE;
}

// The CRS of the zone, easting before northing. The file is named in the message when PROJ does not know the CRS.
inline OGRSpatialReference ReferenceOf(const geo::UtmZone& zone, const std::filesystem::path& file) {
  OGRSpatialReference reference;
  if (reference.importFromEPSG(zone.Epsg()) != OGRERR_NONE) {
    throw base::InputError(file, "needs the definition of EPSG:" + std::to_string(zone.Epsg()) + ", which PROJ cannot find",
                           "Install PROJ's data files (proj.db)");
  }
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

// The same with heights: a three-dimensional CRS for those above the ellipsoid, a compound one with EPSG:5773 for those above EGM96, the zone's CRS
// where their reference is unknown.
inline OGRSpatialReference ReferenceOf(const geo::UtmZone& zone, geo::HeightReference heights, const std::filesystem::path& file) {
  OGRSpatialReference reference = ReferenceOf(zone, file);
  if (heights == geo::HeightReference::kUnknown) return reference;
  OGRErr error = OGRERR_NONE;
  if (heights == geo::HeightReference::kEllipsoid) {
    error = reference.PromoteTo3D(nullptr);
  } else {
    OGRSpatialReference egm96;
    error = egm96.importFromEPSG(5773);
    const OGRSpatialReference horizontal(reference);
    const std::string name = std::string(horizontal.GetName()) + " + EGM96 height";
    if (error == OGRERR_NONE) error = reference.SetCompoundCS(name.c_str(), &horizontal, &egm96);
  }
  if (error != OGRERR_NONE) {
    throw base::InputError(file, "needs the definition of " + geo::NameOf(heights) + " heights, which PROJ cannot find",
                           "Install PROJ's data files (proj.db)");
  }
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

// The rest is what our writers of GeoPackages share.

// GeoPackage stores the time of the last change, which would make every file different.
class FixedTimeStamp {
 public:
  FixedTimeStamp() {
    if (const char* before = CPLGetThreadLocalConfigOption(kOption, nullptr)) before_ = before;
    CPLSetThreadLocalConfigOption(kOption, "2000-01-01T00:00:00.000Z");
  }
  ~FixedTimeStamp() { CPLSetThreadLocalConfigOption(kOption, before_ ? before_->c_str() : nullptr); }
  FixedTimeStamp(const FixedTimeStamp&) = delete;
  FixedTimeStamp& operator=(const FixedTimeStamp&) = delete;

 private:
  static constexpr const char* kOption = "OGR_CURRENT_DATE";
  std::optional<std::string> before_;
};

// The file under its temporary name, and what SQLite may leave beside it; removed unless the file was published.
class PartialPackage {
 public:
  explicit PartialPackage(const std::filesystem::path& file) : file_(file, file.parent_path() / (file.stem().string() + ".partial.gpkg")) {
    RemoveOthers();
  }
  ~PartialPackage() { RemoveOthers(); }
  PartialPackage(const PartialPackage&) = delete;
  PartialPackage& operator=(const PartialPackage&) = delete;
  const std::filesystem::path& path() const { return file_.path(); }
  void Publish() { file_.Publish(); }

 private:
  void RemoveOthers() const {
    for (const char* suffix : {"-journal", "-wal", "-shm"}) {
      std::error_code ignored;
      std::filesystem::remove(path().string() + suffix, ignored);
    }
  }
  base::PartialPath file_;
};

// An empty package at `partial`; `file` is named in messages.
inline Dataset CreatePackage(const std::filesystem::path& partial, const std::filesystem::path& file) {
  RegisterOGRGeoPackage();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  SKYQUILT_CHECK(driver != nullptr, "GDAL without GeoPackage");
  Dataset dataset(driver->Create(partial.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!dataset) FailWriting(file, "cannot be created");
  return dataset;
}

// The CRS of a layer. Without a CRS GDAL would write GeoPackage's "undefined geographic" one, whose coordinates are degrees.
inline OGRSpatialReference LayerReference(bool georeferenced, const geo::UtmZone& zone, geo::HeightReference heights,
                                          const std::filesystem::path& file) {
  if (georeferenced) return ReferenceOf(zone, heights, file);
  OGRSpatialReference reference;
  reference.SetLocalCS("Undefined Cartesian SRS");
  reference.SetLinearUnits(SRS_UL_METER, 1.0);
  return reference;
}

}  // namespace skyquilt::gis::internal
