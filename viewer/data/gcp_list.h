// Ground control points in OpenDroneMap's format: the first line is the CRS; then one line per mark, "x y z pixel_x pixel_y photo [name]".
// Source: https://docs.opendronemap.org/gcp/
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace skyquilt::viewer {

// gcp: checked gcp.json. Blanks in names become '_', because fields are separated by blanks. Points without marks are comments: the format has no
// place for them. Without a CRS the first line is "LOCAL", which other programs do not know.
std::string GcpListText(const nlohmann::json& gcp);

// gcp.json of a list that was written elsewhere; "crs" is its first line. Comments (#) and blank lines are skipped; "skipped" counts lines that are
// not understood. Marks with the same name, or without a name at the same place, belong to one point.
nlohmann::json ReadGcpList(std::string_view text);

}  // namespace skyquilt::viewer
