// Do positions and directions of the photos agree with their matches? Over roughly level ground, two photos see a matched point at the same place:
// for rays scaled to descend by 1, the horizontal difference of the two is that of the camera centres over the height above ground. Gives that
// height, a turn of all directions about the vertical (declination, a camera mounted across), and the share of pairs that agree.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace skyquilt::prepare::poses {

// Some matches of two photos as unit directions in the camera frames.
struct PairRays {
  uint32_t a = 0, b = 0;
  std::vector<Eigen::Vector3d> ray_a, ray_b;
  size_t n_matches = 0;  // all that there are
};

struct SeedView {
  bool known = false;
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // ENU metres
};

struct GroundCheck {
  size_t n_pairs = 0;           // that could be compared: both photos known and looking at the ground, not by chance
  double share_agreeing = 0.0;  // of them
  double height_m = 0.0;        // of the cameras above the ground; 0 when unknown
  double turn_rad = 0.0;        // to be added to all directions, counter-clockwise seen from above
};

// Pairs that may be by chance (FindChancePairs) say nothing.
GroundCheck CheckGround(const std::vector<PairRays>& pairs, const std::vector<SeedView>& views);

// Per pair: whether it has so few matches as photos of different places have by chance, while both photos have others with far more.
std::vector<char> FindChancePairs(const std::vector<PairRays>& pairs, size_t n_views);

// For the pair: which matches, given as directions, move from photo to photo like most others do. Wrong matches rarely do; points on tall buildings
// still may.
std::vector<char> MovesLikeOthers(const PairRays& pair, const std::vector<SeedView>& views);

// Direction turned about the vertical by `turn_rad`, see GroundCheck.
Eigen::Quaterniond Turned(const Eigen::Quaterniond& cam_from_enu, double turn_rad);

}  // namespace skyquilt::prepare::poses
