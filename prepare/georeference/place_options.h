// How a model is placed on Earth by its tags: the part of prepare's options that the geo-reference needs.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace skyquilt::prepare::georeference {

struct PlaceOptions {
  double ransac_threshold_m = 10.0;        // tags farther off do not agree
  double flight_gap_s = 900.0;             // a longer pause between photos starts a new flight
  std::string flight_offsets = "auto";     // "auto": heights of flights get offset and drift where they need it; "off"
  std::string tag_lag = "auto";            // "auto": the lag of the tags is estimated; "off": none
  std::optional<Eigen::Vector3d> up = {};  // by the user (stated_up.h), a unit vector in the model's frame
  int seed = 1;
};

}  // namespace skyquilt::prepare::georeference
