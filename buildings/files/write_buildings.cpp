#include <array>
#include <string>

#include "buildings/files/building_files.h"
#include "buildings/files/file_frame.h"
#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/file.h"
#include "surface/files/file_writer.h"

namespace skyquilt::buildings {
namespace {

struct Format {
  const char* file;
  const char* content;
  const char* format;
  bool BuildingsOptions::*chosen;  // null: always
  void (*write)(const BuildingSet&, const surface::MapFrame&, const std::filesystem::path&);
};

constexpr std::array<Format, 6> kFormats = {{
    {"buildings.json", "buildings with all that is known of them", "JSON", nullptr, &SaveBuildings},
    {"buildings.city.json", "solids of buildings", "CityJSON 2.0", &BuildingsOptions::cityjson, &WriteCityJson},
    {"buildings.gpkg", "footprints and solids of buildings", "GeoPackage", &BuildingsOptions::geopackage, &WriteGeoPackage},
    {"buildings.csv", "table of buildings", "CSV", &BuildingsOptions::csv, &WriteCsv},
    {"buildings.glb", "models of buildings", "GLB", &BuildingsOptions::glb, &WriteGlb},
    {"buildings.dxf", "edges of buildings", "DXF R12", &BuildingsOptions::dxf, &WriteDxf},
}};

void RemoveEarlier(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::remove(file, error);
  if (error) base::ThrowFileError(file, "is of an earlier call and cannot be removed", error.value());
}

}  // namespace

std::vector<surface::WrittenFile> WriteBuildings(const BuildingSet& set, const surface::MapFrame& frame, const BuildingsOptions& options,
                                                 const std::filesystem::path& folder) {
  base::RequireWritableFolder(folder);
  const FileFrame names(set, frame);
  std::vector<surface::WrittenFile> written;
  for (const Format& format : kFormats) {
    base::ThrowIfCancelled();
    const std::filesystem::path file = folder / format.file;
    if (format.chosen != nullptr && !(options.*format.chosen)) {
      RemoveEarlier(file);
      continue;
    }
    format.write(set, frame, file);
    const std::string crs = format.write == &WriteGlb && frame.georeferenced() ? surface::OffsetCrsName(frame) : names.CrsName();
    written.push_back({.file = format.file,
                       .content = format.content,
                       .format = format.format,
                       .crs = crs,
                       .vertical = names.VerticalName(),
                       .bytes = static_cast<int64_t>(std::filesystem::file_size(file)),
                       .detail = base::CountText(static_cast<int64_t>(set.buildings.size()), "building")});
  }
  return written;
}

}  // namespace skyquilt::buildings
