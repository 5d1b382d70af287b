// Sharpness of the orthophoto and of photos on the edge targets that a simulated survey has on the ground.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/gis/read_maps.h"
#include "core/survey/survey.h"
#include "evaluate/measured.h"
#include "surface/map_frame.h"

namespace skyquilt::evaluate::ortho {

// A level square, one half black and one white, with the edge through its centre.
struct EdgeTarget {
  Eigen::Vector3d centre_enu = Eigen::Vector3d::Zero();  // in the frame of the survey, moved as the map is (OrthoScores::shift_east_m)
  double side_m = 0.0;
  double yaw_rad = 0.0;  // of the edge, counter-clockwise from east
};

// truth/edge_targets.json. shift_m: of the map. Throws base::InputError when the file, or simulate.json beside its folder, is damaged.
std::vector<EdgeTarget> ReadEdgeTargets(const std::filesystem::path& edge_targets_json, const geo::Geodetic& survey_origin,
                                        const Eigen::Vector2d& shift_m);

struct EdgeSharpness {
  int64_t targets = 0;  // measured in the map
  double map_per_cell = kNotMeasured, map_per_m = kNotMeasured;
  double photo_per_px = kNotMeasured, photo_per_m = kNotMeasured;
};
// MTF50 in cycles, medians over the targets. Photos: for each target the training photo that is most nearly above it, or one of the next three when
// the edge cannot be measured there, or the file is gone. Targets of which a figure cannot be measured do not count for it.
EdgeSharpness MeasureSharpness(const std::vector<EdgeTarget>& targets, const gis::MapReader& map, const survey::Survey& survey,
                               const skyquilt::surface::MapFrame& frame);

}  // namespace skyquilt::evaluate::ortho
