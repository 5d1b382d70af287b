// Which photos are of one shot: exposure brackets, which cameras write as a file for each exposure.
#pragma once

#include <cstddef>
#include <vector>

#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::input {

// Index of the first photo of each photo's shot. Neighbours in the list are of one shot when they are in one folder, of one camera and size, and
// taken at one place (0.5 m, heights included) in one direction (2 degrees) within two seconds after the one before, with exposures that differ by a
// third of a stop or more from those of all the others; without tags of exposure, within one second. At most nine photos within five seconds: a
// receiver that repeats its last position does not make a flight one shot. A photo without place or time is a shot of its own.
std::vector<size_t> FindShots(const std::vector<PhotoFile>& photos);

// Of a result of FindShots.
size_t CountShots(const std::vector<size_t>& shots);

}  // namespace skyquilt::prepare::input
