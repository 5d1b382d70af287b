// Ground control points in OpenDroneMap's format: the first line is the CRS; then one line per mark, "x y z pixel_x pixel_y photo [name]".
// Source: https://docs.opendronemap.org/gcp/
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/geo/utm.h"
#include "viewer/data/gcp_json.h"

namespace skyquilt::viewer {

// gcp: checked gcp.json. Photos are named without their folders, as OpenDroneMap wants them. Fields are separated by blanks: in names of points they
// become '_', marks in photos with blanks in their name become comments, as do points without marks. Without a CRS the first line is "LOCAL", which
// other programs do not know.
std::string GcpListText(const nlohmann::json& gcp, const MarkablePhotos& photos);

struct GcpList {
  nlohmann::json gcp;  // gcp.json, with "skipped", the number of lines that were left out, if there are any; null: see problem
  std::string problem;
};
// A list that was written elsewhere. Coordinates in other UTM zones, or in longitude and latitude, are converted (zone: of the project; none without
// geo-reference); heights are taken as they are, ETRS89 as WGS84, which differ by less than a metre. Lines with the same name, or without a name at
// the same place, belong to one point. Marks in photos that are not in the survey have "unknown": true.
GcpList ReadGcpList(std::string_view text, const std::optional<geo::UtmZone>& zone, const MarkablePhotos& photos);

}  // namespace skyquilt::viewer
