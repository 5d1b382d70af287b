// What our files that use GDAL share. Includes GDAL's headers, so only the .cpp files of this folder may include it.
#pragma once

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <filesystem>
#include <memory>
#include <string>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/geo/height_reference.h"
#include "core/geo/utm.h"

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

}  // namespace skyquilt::gis::internal
