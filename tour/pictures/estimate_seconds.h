// How long pictures will take.
#pragma once

#include <span>

#include "tour/pictures/picture_request.h"
#include "tour/pictures/render_picture.h"

namespace skyquilt::tour {

// Renders about 32 thousand of the pictures' rays and takes the rest to be like them; 0 without pictures. Too long when not all fields fit in memory,
// because the rays are taken from everywhere. Throws as MakePictures.
double EstimateSeconds(std::span<const PictureRequest> requests, const PictureField& field);

}  // namespace skyquilt::tour
