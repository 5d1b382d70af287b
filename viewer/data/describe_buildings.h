// The part of project.json about buildings: how many there are, and which of their files can be had.
#pragma once

#include <string>

#include "viewer/data/open_project.h"

namespace skyquilt::viewer::opening {

// buildings: null, or count, url and files; the latter two relative to /data/. After DescribeSurface, from which buildings are found.
void DescribeBuildings(OpenedProject* opened);
// Content type of a file that DescribeBuildings has listed.
std::string BuildingFileType(const std::string& name);

}  // namespace skyquilt::viewer::opening
