// Describes the content of any file or folder that skyquilt writes, as JSON for `skyquilt info`.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/checkpoint/archive.h"
#include "core/geo/place_accuracy.h"
#include "core/survey/survey.h"

namespace skyquilt::app {

// Chooses the description by file name and extension. Throws base::InputError when the path does not exist, is damaged or cannot be described.
nlohmann::ordered_json Describe(const std::filesystem::path& path);
// HDF5 checkpoints and scenes: kind, version, attributes, and arrays with type, shape, hash and range.
nlohmann::ordered_json DescribeArchive(const std::filesystem::path& file);

// Which footprints a scene was trained with.
nlohmann::ordered_json DescribeScales(const checkpoint::ArchiveReader& scene);

// A survey folder.
nlohmann::ordered_json DescribeSurvey(const std::filesystem::path& folder);
// How a survey was placed on Earth, how accurately, and its problems.
nlohmann::ordered_json DescribePlace(const survey::Survey& survey);
// To three digits; null where unknown.
nlohmann::ordered_json DescribeAccuracy(const geo::PlaceAccuracy& accuracy);

// GeoTIFFs and float TIFFs: size, bands, ranges.
nlohmann::ordered_json DescribeRaster(const std::filesystem::path& file);
// cameras.geojson, tables (.csv) and configurations (.toml).
nlohmann::ordered_json DescribeCameras(const std::filesystem::path& file);
nlohmann::ordered_json DescribeTable(const std::filesystem::path& file);
nlohmann::ordered_json DescribeConfiguration(const std::filesystem::path& file);

// JSON as text for a terminal: indented "key: value" lines; lists of records become tables.
std::string FormatReadable(const nlohmann::ordered_json& json);

}  // namespace skyquilt::app
