// What prepare tells people: a summary in the log, a table of residuals, a map of the cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "prepare/georeference.h"

namespace skyquilt::prepare {

void LogSummary(const survey::Survey& survey, const Georeference& georeference);
// name, ENU position, fitted and tagged longitude / latitude / height, residual, its upward part, inlier, flight, AGL, RelativeAltitude, test.
// Empty fields where a figure is not known. Throws base::InputError.
void WriteResidualTable(const survey::Survey& survey, const Georeference& georeference, const std::filesystem::path& file);
// RFC 7946 points. The survey must be geo-referenced. Throws base::InputError.
void WriteCameraMap(const survey::Survey& survey, const std::filesystem::path& file);

}  // namespace skyquilt::prepare
