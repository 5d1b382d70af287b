// What our writers of GeoPackages share. Includes GDAL's headers, so only the .cpp files of this folder may include it.
#pragma once

#include <ogrsf_frmts.h>

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/partial_path.h"
#include "core/gis/gdal_support.h"

namespace skyquilt::gis::internal {

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
