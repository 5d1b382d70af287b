// Proposes a tour where there is none: an overview, then what is worth a look, on a round that leads back. The same input gives the same tour.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "tour/format/tour.h"
#include "tour/ways/heights.h"

namespace skyquilt::tour {

// A building as `skyquilt buildings` found it.
struct BuildingMark {
  int id = 0;
  std::string roof;                                      // "flat", "gable", "hip", "other"
  Eigen::Vector3d middle_enu;                            // on the ground
  double length_m = 0.0, width_m = 0.0, height_m = 0.0;  // in the scene's lengths
  double scale = 1.0;                                    // measures in metres per length of the scene
  bool metric = true;                                    // false: no text has a measure
  bool accepted = true;                                  // its model fits well
  double seen = 1.0;                                     // share of its walls that several photos saw
};

struct ProposeInput {
  std::string name;                  // of the project; the title, where it can be one
  Eigen::AlignedBox3d box_enu;       // of the scene
  double ground_m = 0.0;             // typical z of the ground
  const Heights* heights = nullptr;  // null: there is no surface model; views are then from above
  std::vector<BuildingMark> buildings;
  bool metric = true;  // the scene's lengths are metres; else only buildings that are metric have measures
  int stops = 3;       // at least 1
};

// At most so many stops: where fewer places are worth a look there are fewer. Things: none.
Tour ProposeTour(const ProposeInput& input);

}  // namespace skyquilt::tour
