// The true surface of a simulated survey, as a mesh with a class per triangle.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"

namespace skyquilt::evaluate::surface {

struct TrueSurface {
  // The simulator's frame and the survey's are both ENU about their origins. The survey's may be off by the error of its geo-reference, which is
  // not corrected here: figures include it.
  geo::Rigid3d survey_from_truth;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // survey ENU, metres; positions are relative to it
  std::vector<Eigen::Vector3f> position;
  std::vector<std::array<uint32_t, 3>> triangle;  // counter-clockwise seen from outside
  std::vector<uint8_t> class_id;                  // survey::SurfaceClass, one per triangle

  Eigen::Vector3d Corner(uint32_t triangle_index, size_t corner) const { return middle + position[triangle[triangle_index][corner]].cast<double>(); }
  Eigen::Vector3d Normal(uint32_t triangle_index) const;  // length 1, outwards; zero for a triangle without area
};

// The simulator's frame is about the origin in simulate.json; without that file, or without valid origins, both frames are the same. Throws
// base::InputError for a damaged file.
geo::Rigid3d SurveyFromTruth(const std::filesystem::path& simulate_json, const geo::Geodetic& survey_origin);

// Reads a mesh as simulate/surface_mesh.h writes it. survey_origin: of the survey's frame. The origin of the simulator's frame is read from
// simulate.json in the folder above; without that file both frames are the same. Throws base::InputError.
TrueSurface ReadTrueSurface(const std::filesystem::path& surface_ply, const geo::Geodetic& survey_origin);

}  // namespace skyquilt::evaluate::surface
