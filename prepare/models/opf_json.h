// Open Photogrammetry Format of Pix4D (PIX4Dmatic, PIX4Dcloud): the project file .opf and the files it names.
// Conventions (pix4d.github.io/opf-spec 1.0; camera models: Pix4D's "How are the Internal and External Camera Parameters defined"):
//   pose     calibrated cameras: position in the processing frame; orientation_deg omega phi kappa, R = Rx(omega) Ry(phi) Rz(kappa) from the image to
//            that frame; image axes right, top, back
//   lens     perspective: focal_length_px, principal_point_px from the image's corner, radial R1 R2 R3 and tangential T1 T2, which are OpenCV's k1 k2
//            k3 p1 p2 in axes right, down, forward. The page on camera models turns the y axis; that the tangential terms belong to y down is taken
//            from Pix4D's own converter to COLMAP. Image sizes are those of the input cameras' sensors.
//            Fisheye and spherical lenses have no counterpart: their polynomial is in 2 theta / pi with even terms.
//   frame    processing frame = (base coordinates x scale, x and y swapped if left-handed) + shift; scene_reference_frame names the base's
//            coordinate system, geoid_height is added to heights
//   points   calibration's glTF: scene of y up, (x, y, z) here is (x, -z, y); OPF_mesh_primitive_matches tells which cameras saw a point
#pragma once

#include <filesystem>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// Throws base::InputError.
InputModel ReadOpf(const std::filesystem::path& project, const ModelPhotos& photos);

}  // namespace skyquilt::prepare::models
