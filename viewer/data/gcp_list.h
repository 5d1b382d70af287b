// Ground control points in OpenDroneMap's format: the first line is the CRS; then one line per mark, "x y z pixel_x pixel_y photo [name]".
// Source: https://docs.opendronemap.org/gcp/
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/geo/utm.h"
#include "viewer/data/gcp_json.h"

namespace skyquilt::viewer {

// gcp: checked gcp.json. Photos are named without their folders, as OpenDroneMap wants them. Fields are separated by blanks: in names of points they
// become '_', marks in photos with blanks in their name become comments, as do points without marks. Without a CRS the first line is "LOCAL", which
// other programs do not know.
std::string GcpListText(const nlohmann::json& gcp, const MarkablePhotos& photos);

// gcp.json of a list that was written elsewhere, read as `prepare` reads it (docs/control_points.md). Coordinates are converted to the project's maps
// (zone; without geo-reference none, and the first line must be LOCAL), heights with them. Points without a name have an empty one. Marks in photos
// that are not in the survey have "unknown": true. Lines that cannot be used are left out: "skipped" is their number, and "remarks" says of the first
// what is wrong with them, and what was assumed; both are missing when there is nothing to say. Throws base::InputError when the list as a whole
// cannot be used.
nlohmann::json ReadGcpList(const std::filesystem::path& file, const std::string& text, const std::optional<geo::UtmZone>& zone,
                           const MarkablePhotos& photos);

}  // namespace skyquilt::viewer
