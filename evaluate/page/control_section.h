// Parts of the report's section on control points; HTML. Labels and names of photos are escaped here.
#pragma once

#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "evaluate/control/control_pictures.h"

namespace skyquilt::evaluate::page {

// Points with their errors as arrows and rings, over the tracks of the cameras. Empty when no point has an error.
std::string ControlMap(const survey::Survey& survey);
// Each point's marks: pictures with a cross at the mark and a ring at the projection of the estimated point. Empty without pictures.
std::string MarkPictures(const survey::ControlFit& fit, const std::vector<control::MarkPicture>& pictures);

}  // namespace skyquilt::evaluate::page
