// cameras.xml of Agisoft Metashape Professional (File > Export > Export Cameras, Agisoft XML).
// Conventions (Metashape Professional manual, appendix "Camera models"; Python reference, Camera.transform and Chunk.transform):
//   pose     camera/transform, 16 numbers by rows, chunk_from_cam; camera x right, y down, looks along +z. Cameras without one are not aligned.
//   lens     calibration: f cx cy b1 b2 in pixels, k1..k4 p1 p2; the adjusted one counts, else the first. Principal point: w/2 + cx, h/2 + cy;
//            fx = f + b1, fy = f. Pixels: the middle of the first is (0.5, 0.5), as ours.
//            x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8) + p1 (r^2 + 2 x^2) + 2 p2 x y: p1 and p2 are OpenCV's p2 and p1.
//            Fisheye: x, y are divided by r and multiplied by the angle from the axis first.
//            b2 (skew), k4 of a frame camera, p3, p4, and p1, p2 of a fisheye have no counterpart in our models.
//   frame    chunk; the component's (or the chunk's) transform leads to Earth-centred coordinates when the chunk's reference is geographic or
//            projected. The manual does not say of which datum; they are taken as WGS84, which matters for datums other than that.
//   points   are not in the file
#pragma once

#include <filesystem>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// Reads the first chunk with aligned cameras, of it the component with most; a warning names what is left out. Throws base::InputError.
InputModel ReadMetashape(const std::filesystem::path& file, const ModelPhotos& photos);
// True when the file is XML whose root is Metashape's <document>.
bool LooksLikeMetashape(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::models
