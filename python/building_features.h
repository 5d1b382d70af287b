// The measured buildings of a project as GeoJSON.
#pragma once

#include <string>

#include "coordinator/project/project.h"

namespace skyquilt::python {

// The text of a FeatureCollection: per building the footprint (longitude, latitude; of a local frame x, y) and the columns of buildings.csv, whose
// unknown values are null. Throws base::InputError when the project has no buildings or a file is damaged.
std::string BuildingFeatures(const coordinator::Project& project);

}  // namespace skyquilt::python
