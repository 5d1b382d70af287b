#include "core/gis/contours.h"

#include <gdal_alg.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/log.h"
#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

constexpr double kMostLevels = 1000.0;
constexpr int64_t kIndexEvery = 5;

internal::Dataset RasterInMemory(const MapGrid& grid, std::span<const float> height_m, const std::filesystem::path& file) {
  GDALRegister_MEM();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("MEM");
  SKYQUILT_CHECK(driver != nullptr, "GDAL without MEM");
  internal::Dataset raster(driver->Create("", grid.width, grid.height, 1, GDT_Float32, nullptr));
  if (!raster) internal::FailWriting(file, "cannot be made, the memory is too small");
  double transform[6] = {grid.left, grid.resolution_m, 0.0, grid.top, 0.0, -grid.resolution_m};
  raster->SetGeoTransform(transform);
  std::vector<float> row(static_cast<size_t>(grid.width));
  for (int y = 0; y < grid.height; ++y) {
    const float* heights = height_m.data() + static_cast<size_t>(y) * row.size();
    std::transform(heights, heights + row.size(), row.begin(),
                   [](float height) { return std::isfinite(height) ? height : std::numeric_limits<float>::quiet_NaN(); });
    if (raster->GetRasterBand(1)->RasterIO(GF_Write, 0, y, grid.width, 1, row.data(), grid.width, 1, GDT_Float32, 0, 0, nullptr) != CE_None) {
      internal::FailWriting(file, "cannot be made");
    }
  }
  return raster;
}

struct Line {
  int64_t level = 0;  // its height in intervals
  std::unique_ptr<OGRGeometry> geometry;
};

std::vector<Line> LinesOf(GDALDataset* raster, double interval_m, const std::filesystem::path& file) {
  RegisterOGRMEM();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("Memory");
  SKYQUILT_CHECK(driver != nullptr, "GDAL without vectors in memory");
  const internal::Dataset vectors(driver->Create("", 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = vectors ? vectors->CreateLayer("lines", nullptr, wkbLineString, nullptr) : nullptr;
  OGRFieldDefn height("height_m", OFTReal);
  if (layer == nullptr || layer->CreateField(&height) != OGRERR_NONE) internal::FailWriting(file, "cannot be made");
  CPLStringList options;
  options.SetNameValue("LEVEL_INTERVAL", CPLSPrintf("%.17g", interval_m));
  options.SetNameValue("ELEV_FIELD", "0");
  if (GDALContourGenerateEx(GDALRasterBand::ToHandle(raster->GetRasterBand(1)), OGRLayer::ToHandle(layer), options.List(),
                            internal::ContinueUnlessCancelled, nullptr) != CE_None) {
    base::ThrowIfCancelled();
    internal::FailWriting(file, "cannot be made");
  }
  std::vector<Line> lines;
  for (const auto& feature : *layer) {
    std::unique_ptr<OGRGeometry> geometry(feature->StealGeometry());
    if (!geometry || geometry->toLineString()->getNumPoints() < 2) continue;
    lines.push_back({std::llround(feature->GetFieldAsDouble(0) / interval_m), std::move(geometry)});
  }
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.level < b.level; });
  return lines;
}

// The height of a level. Intervals like 0.1 m are not exact, so that 3 * 0.1 is not 0.3, but 3 / 10 is.
double HeightOf(int64_t level, double interval_m) {
  const double per_metre = std::round(1.0 / interval_m);
  const bool whole = per_metre >= 1.0 && std::abs(per_metre * interval_m - 1.0) < 1e-12;
  return whole ? static_cast<double>(level) / per_metre : static_cast<double>(level) * interval_m;
}

void WritePackage(const MapGrid& grid, const std::vector<Line>& lines, double interval_m, const std::string& vertical,
                  const std::map<std::string, std::string>& metadata, const std::filesystem::path& partial, const std::filesystem::path& file) {
  internal::Dataset dataset = internal::CreatePackage(partial, file);
  OGRSpatialReference reference = internal::LayerReference(grid.georeferenced, grid.zone, geo::HeightReference::kUnknown, file);
  CPLStringList options;
  options.SetNameValue("DESCRIPTION", ("Contour lines of the ground. Heights in metres above: " + vertical).c_str());
  OGRLayer* layer = dataset->CreateLayer("contours", &reference, wkbLineString, options.List());
  OGRFieldDefn height("height_m", OFTReal);
  OGRFieldDefn index("index", OFTInteger);
  if (layer == nullptr || layer->CreateField(&height) != OGRERR_NONE || layer->CreateField(&index) != OGRERR_NONE ||
      dataset->StartTransaction() != OGRERR_NONE) {
    internal::FailWriting(file, "cannot be written");
  }
  for (const auto& [key, value] : metadata) {
    if (layer->SetMetadataItem(key.c_str(), value.c_str()) != CE_None) internal::FailWriting(file, "cannot be written");
  }
  for (const Line& line : lines) {
    base::ThrowIfCancelled();
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField(0, HeightOf(line.level, interval_m));
    feature.SetField(1, line.level % kIndexEvery == 0 ? 1 : 0);
    if (feature.SetGeometry(line.geometry.get()) != OGRERR_NONE || layer->CreateFeature(&feature) != OGRERR_NONE) {
      internal::FailWriting(file, "cannot be written");
    }
  }
  if (dataset->CommitTransaction() != OGRERR_NONE) internal::FailWriting(file, "cannot be written");
  internal::CloseWritten(&dataset, file);
}

}  // namespace

double AllowedContourInterval(std::span<const float> height_m, double interval_m) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const float height : height_m) {
    if (!std::isfinite(height)) continue;
    lowest = std::min(lowest, static_cast<double>(height));
    highest = std::max(highest, static_cast<double>(height));
  }
  if (!(highest > lowest)) return interval_m;
  double thinned = interval_m;
  for (double decade = 1.0; (highest - lowest) / thinned > kMostLevels; decade *= 10.0) {
    for (const double factor : {2.0, 5.0, 10.0}) {
      thinned = interval_m * decade * factor;
      if ((highest - lowest) / thinned <= kMostLevels) break;
    }
  }
  return thinned;
}

int64_t WriteContours(const MapGrid& grid, std::span<const float> height_m, double interval_m, const std::string& vertical,
                      const std::filesystem::path& gpkg, const std::map<std::string, std::string>& metadata) {
  SKYQUILT_CHECK(std::isfinite(interval_m) && interval_m > 0.0, std::to_string(interval_m));
  SKYQUILT_CHECK(height_m.size() == grid.size(), std::to_string(height_m.size()));
  const internal::QuietErrors quiet;
  const internal::FixedTimeStamp time_stamp;
  std::vector<Line> lines;
  double interval = interval_m;
  if (!height_m.empty()) {
    interval = AllowedContourInterval(height_m, interval_m);
    if (interval > interval_m) {
      base::LogWarning("{}: contours every {} m would be at more than {} heights; they are made every {} m instead", gpkg.string(), interval_m,
                       kMostLevels, interval);
    }
    const internal::Dataset raster = RasterInMemory(grid, height_m, gpkg);
    lines = LinesOf(raster.get(), interval, gpkg);
  }
  internal::PartialPackage partial(gpkg);
  WritePackage(grid, lines, interval, vertical, metadata, partial.path(), gpkg);
  partial.Publish();
  return static_cast<int64_t>(lines.size());
}

}  // namespace skyquilt::gis
