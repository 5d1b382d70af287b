// reconstruction.json of OpenSfM and OpenDroneMap (ODM: opensfm/reconstruction.json).
// Conventions (opensfm.org/docs/geometry.html, dataset.html):
//   pose     shots[].rotation (angle-axis, radians) and translation, cam_from_world; camera x right, y down, looks along +z
//   lens     normalized coordinates: origin in the middle of the image, the larger side is 1. Pixels there count from the middle of the first pixel:
//            u = max(w, h) x + (w - 1) / 2; here from its corner, so the principal point is max(w, h) c + w / 2.
//            perspective focal k1 k2 | simple_radial, radial focal_x focal_y c_x c_y k1 k2 | brown the same with p1 p2 k3 (OpenCV's order; the page
//            writes r^2 + 2x for what must be r^2 + 2x^2) | fisheye focal k1 k2 | fisheye_opencv focal_x focal_y c_x c_y k1..k4
//   frame    topocentric (east, north, up, metres) about reference_lla of the file or of reference_lla.json beside it: latitude, longitude, altitude.
//            That the altitude is ellipsoidal is not written anywhere; it is what the photos' GPS tags said.
//   points   points{}.coordinates and color; which photos saw them is in tracks.csv beside the file, if it is there
// Only a photo's proportions matter in normalized coordinates: a camera gets the size of its photos where they have the same proportions.
#pragma once

#include <filesystem>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// Reads the reconstruction with most photos; others are named in a warning. Throws base::InputError.
InputModel ReadOpensfm(const std::filesystem::path& file, const ModelPhotos& photos);

}  // namespace skyquilt::prepare::models
