// The report's geo-reference section and its parts; HTML. Photo names and other texts of the survey are escaped here.
#pragma once

#include <string>

#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

std::string GeoSection(const ReportInput& input);  // how the survey was placed on Earth

// Simulated surveys: nothing had to be fitted.
bool FrameIsExact(const survey::GeoFit& fit);

// The tracks of cameras and tags, and an arrow from each fitted position to its tag as recorded. Empty without tags.
std::string GeoMap(const survey::Survey& survey);
// Residuals and heights over the flight. Empty without tags.
std::string GeoCharts(const survey::Survey& survey);
// What each kind of evidence says about the direction of gravity, as a plot and a table. Empty without evidence.
std::string GravityEvidenceTable(const survey::Survey& survey);
// Directions of buildings and streets, as a plot and a table. Empty when no lines were searched.
std::string DirectionsTable(const survey::Survey& survey);
// Per photo, the largest residual first.
std::string ResidualTable(const survey::Survey& survey);

}  // namespace skyquilt::evaluate::page
