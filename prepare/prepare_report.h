// Results of `prepare` for the user to check the geo-reference: a summary in the log, a table of residuals, a map of the cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "prepare/georeference/georeference.h"

namespace skyquilt::prepare {

void LogSummary(const survey::Survey& survey);
// CSV, one line per photo: name, ENU position, fitted and tagged latitude / longitude / height, what the fit adds to the tag, residual, inlier,
// flight, height above ground, RelativeAltitude, test. Unknown values are empty. Throws base::InputError when the file cannot be written.
void WriteResidualTable(const survey::Survey& survey, const georeference::Georeference& georeference, const std::filesystem::path& file);
// GeoJSON points (RFC 7946). The survey must be geo-referenced. Throws base::InputError when the file cannot be written.
void WriteCameraMap(const survey::Survey& survey, const std::filesystem::path& file);

}  // namespace skyquilt::prepare
