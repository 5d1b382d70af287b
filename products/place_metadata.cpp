#include "products/place_metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace skyquilt::products {
namespace {

constexpr const char* kLocal = "local frame";
constexpr const char* kExact = "exact (simulated)";
constexpr const char* kUnknown = "of unknown accuracy";
constexpr const char* kFitted = "fitted to GPS tags";

struct Deviation {
  const char* key;
  double value;
  const char* unit;
  const char* of;
};

std::array<Deviation, 5> DeviationsOf(const geo::PlaceAccuracy& accuracy) {
  return {{{"ACCURACY_HORIZONTAL_M", accuracy.horizontal_m, " m", "horizontally"},
           {"ACCURACY_VERTICAL_M", accuracy.vertical_m, " m", "vertically"},
           {"ACCURACY_TILT_DEG", accuracy.tilt_deg, " degrees", "in tilt"},
           {"ACCURACY_YAW_DEG", accuracy.yaw_deg, " degrees", "in yaw"},
           {"ACCURACY_SCALE_PERCENT", accuracy.scale_percent, " %", "in scale"}}};
}

// Three digits: an accuracy is itself only an estimate.
std::string Number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "unknown";
}

std::string Sentence(const scene::SceneInfo& info, const std::string& title) {
  const std::string georeference = NameOfGeoreference(info);
  if (georeference == kLocal) {
    return title + " in a local frame" + (info.accuracy.HasScale() ? " in metres, by scale bars," : " of unknown scale,") +
           " without a place on Earth.";
  }
  if (georeference == kExact) return title + " of a simulated survey whose place on Earth is known exactly.";
  if (georeference == kUnknown) return title + ", placed on Earth with unknown accuracy.";
  const std::array<Deviation, 5> deviations = DeviationsOf(info.accuracy);
  std::array<std::string, 5> parts;
  std::transform(deviations.begin(), deviations.end(), parts.begin(), [](const Deviation& deviation) {
    return fmt::format("{}{} {}", Number(deviation.value), std::isfinite(deviation.value) ? deviation.unit : "", deviation.of);
  });
  return fmt::format("{}, placed on Earth by its GPS tags with a standard deviation of {}.", title, fmt::join(parts, ", "));
}

}  // namespace

std::string NameOfGeoreference(const scene::SceneInfo& info) {
  if (!info.georeferenced) return kLocal;
  const std::array<Deviation, 5> deviations = DeviationsOf(info.accuracy);
  if (std::all_of(deviations.begin(), deviations.end(), [](const Deviation& deviation) { return deviation.value == 0.0; })) return kExact;
  if (std::none_of(deviations.begin(), deviations.end(), [](const Deviation& deviation) { return std::isfinite(deviation.value); })) return kUnknown;
  return kFitted;
}

std::map<std::string, std::string> PlaceMetadata(const scene::SceneInfo& info, const std::string& title) {
  std::map<std::string, std::string> items = {{"GEOREFERENCE", NameOfGeoreference(info)}, {"TIFFTAG_IMAGEDESCRIPTION", Sentence(info, title)}};
  for (const Deviation& deviation : DeviationsOf(info.accuracy)) items[deviation.key] = Number(deviation.value);
  return items;
}

gis::GeoTiffSpec OrthophotoSpec(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::string& title) {
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.bands = 4;
  spec.band_names = {"red", "green", "blue", "alpha"};
  spec.metadata = PlaceMetadata(info, title);
  spec.metadata["TIFFTAG_SOFTWARE"] = "skyquilt";
  return spec;
}

}  // namespace skyquilt::products
