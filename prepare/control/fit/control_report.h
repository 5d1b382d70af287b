// Tables and maps of control and check points for the user to check the geo-reference, and for other programs.
#pragma once

#include <filesystem>

#include "core/survey/survey.h"

namespace skyquilt::prepare::control {

// CSV, one line per point in the order of the file: label, use (control, check, rejected, unseen), given ENU position, error (estimated less given),
// its sigma, error when left out, pixel error, marks used and given, GSD. Metres, pixels. Unknown values are empty. Throws base::InputError when the
// file cannot be written.
void WriteControlTable(const survey::Survey& survey, const std::filesystem::path& file);
// GeoJSON points (RFC 7946) at the given positions, without height where none was given. The survey must be geo-referenced. Throws base::InputError
// when the file cannot be written.
void WriteControlMap(const survey::Survey& survey, const std::filesystem::path& file);
// geo_control.csv and, with a geo-reference, control.geojson in the folder. Removes those of an earlier run that no longer apply.
void WriteControlReport(const survey::Survey& survey, const std::filesystem::path& folder);

}  // namespace skyquilt::prepare::control
