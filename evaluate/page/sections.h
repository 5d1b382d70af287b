// Parts of the report's page, each a <section> or a piece of one; HTML. The sections on buildings, control points and the geo-reference have headers
// of their own.
#pragma once

#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

std::string SummarySection(const ReportInput& input);  // the key figures of the first screen
std::string WarningsBanner(const metrics::Metrics& metrics);
std::string BlockMapSvg(const ReportInput& input);
std::string BlockTable(const ReportInput& input);
std::string PhotoSection(const ReportInput& input);
std::string SurfaceSection(const ReportInput& input);      // what was made of the scene's surface, and its scores; empty without a surface
std::string InputSection(const ReportInput& input);        // what the photo folder had; empty when nothing in it is remarkable
std::string DetailsSection(const ReportInput& input);      // every figure and its meaning
std::string ClassTable(const metrics::Metrics& metrics);   // empty without true classes
std::string BrightnessSection(const ReportInput& input);   // empty without brightness
std::string TimeSection(const metrics::Metrics& metrics);  // what was planned and what it took; empty without a total time
std::string MethodSection(const ReportInput& input);

}  // namespace skyquilt::evaluate::page
