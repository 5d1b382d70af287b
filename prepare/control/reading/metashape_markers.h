// Reads the markers that Metashape exports as XML (File > Export > Export Markers): labels and, if given, coordinates and accuracies under <markers>;
// their pixels under <frames>, from the image's corner (the manual has the centre of the first pixel at (0.5, 0.5)); names of the photos under
// <cameras>, their sizes under <sensors>. Positions that Metashape only projected (pinned="false") are no marks. A marker whose coordinates are
// disabled is a check point, as there.
#pragma once

#include <filesystem>
#include <string>

#include "prepare/control/reading/raw_control.h"

namespace skyquilt::prepare::control {

// `text`: the content of the file. Points without coordinates in the file are left out, their marks are not. Throws base::InputError with the line
// and how to fix it.
RawControl ReadMetashapeMarkers(const std::filesystem::path& file, const std::string& text);

}  // namespace skyquilt::prepare::control
