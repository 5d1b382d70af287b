// A small survey with known poses, written in the formats of other programs by the formulas of their documentation, apart from the readers' own.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"

namespace skyquilt::test {

struct MadePhoto {
  std::string name;
  Eigen::Matrix3d axes;  // columns: the image's right, its down and the direction of view, in the survey's frame
  Eigen::Vector3d centre;
};

// OpenCV's parameters, principal point from the image's corner.
struct MadeLens {
  int width = 640, height = 480;
  double fx = 510.0, fy = 500.0, cx = 322.0, cy = 237.0;
  double k1 = -0.1, k2 = 0.02, k3 = -0.003, p1 = 0.001, p2 = -0.0007;
};

struct MadeModel {
  MadeLens lens;
  std::vector<MadePhoto> photos;
  std::vector<Eigen::Vector3d> points;  // seen by every photo
};

// Three photos that look down obliquely, turned differently; the frame is east, north, up about kModelOrigin.
MadeModel MakeModel();
inline constexpr geo::Geodetic kModelOrigin{47.1, 8.4, 420.0};

// By file name.
using Files = std::map<std::string, std::string>;

Files TransformsFiles(const MadeModel& survey);   // transforms.json, points.ply
Files BlenderFiles(const MadeModel& survey);      // transforms_train.json with all photos but the last, transforms_test.json; no lens errors
Files OpensfmFiles(const MadeModel& survey);      // reconstruction.json, reference_lla.json, tracks.csv
Files MetashapeFiles(const MadeModel& survey);    // cameras.xml: the chunk is turned and 10 times smaller
Files OpfFiles(const MadeModel& survey);          // project.opf and the files it names: the frame is UTM 32N less kOpfShift; fx is left out
Files PosesBoundsFiles(const MadeModel& survey);  // poses_bounds.npy; no lens errors, fx counts for both axes (made_sets.cpp)
inline const Eigen::Vector3d kOpfShift(-450000.0, -5216000.0, -400.0);

void WriteFiles(const Files& files, const std::filesystem::path& folder);

// Pixels of a point by each format's own formula, from the image's corner.
Eigen::Vector2d ProjectTransforms(const MadeLens& lens, const MadePhoto& photo, const Eigen::Vector3d& x);
Eigen::Vector2d ProjectOpensfm(const MadeLens& lens, const MadePhoto& photo, const Eigen::Vector3d& x);
Eigen::Vector2d ProjectMetashape(const MadeLens& lens, const MadePhoto& photo, const Eigen::Vector3d& x);
Eigen::Vector2d ProjectOpf(const MadeLens& lens, const MadePhoto& photo, const Eigen::Vector3d& x);
Eigen::Vector2d ProjectBlender(const MadeLens& lens, const MadePhoto& photo, const Eigen::Vector3d& x);

// The chunk of MetashapeFiles: x_in_survey = 10 turn x_in_chunk.
Eigen::Matrix3d MetashapeTurn();

}  // namespace skyquilt::test
