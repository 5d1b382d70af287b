// What any file or folder of this program holds, as JSON for `skyquilt info`.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace skyquilt::app {

// Throws base::InputError when the path does not exist or is nothing that skyquilt writes or reads.
nlohmann::ordered_json Describe(const std::filesystem::path& path);
// HDF5 checkpoints and scenes: kind, version, attributes, arrays with shape, type, range.
nlohmann::ordered_json DescribeArchive(const std::filesystem::path& file);

// GeoTIFFs and float TIFFs: size, bands, ranges.
nlohmann::ordered_json DescribeRaster(const std::filesystem::path& file);
// cameras.geojson, tables (.csv) and configurations (.toml).
nlohmann::ordered_json DescribeCameras(const std::filesystem::path& file);
nlohmann::ordered_json DescribeTable(const std::filesystem::path& file);
nlohmann::ordered_json DescribeConfiguration(const std::filesystem::path& file);

// Indented "key: value" lines; lists of records become tables.
std::string Readable(const nlohmann::ordered_json& json);

}  // namespace skyquilt::app
