// The report's section on control and check points and its parts; HTML. Labels and names of photos are escaped here.
#pragma once

#include <string>
#include <vector>

#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

std::string ControlSection(const ReportInput& input);  // empty without any

// Points with their errors as arrows and rings, over the tracks of the cameras. Empty when no point has an error.
std::string ControlMap(const survey::Survey& survey);
// Each point's marks: pictures with a cross at the mark and a ring at the projection of the estimated point. Empty without pictures.
std::string MarkPictures(const survey::ControlFit& fit, const std::vector<control::MarkPicture>& pictures);

}  // namespace skyquilt::evaluate::page
