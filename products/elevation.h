// Elevations: orthographic pictures of a scene straight on vertical planes, such as facades, in a known scale. As an orthophoto, but from the side.
// Frame: survey ENU. Lengths are metres, or units of the reconstruction where the survey has no scale. Files of one, as <name>...:
//   .png          red, green, blue, alpha (display values): as many pixels as the wall needs; alpha 0 where the scene has no surface
//   _depth.tiff   float32, how far the surface stands in front of the plane (behind it: negative); NaN where there is none
//   _preview.png  a small picture on white with a scale bar
//   .json         how pixels lie in space (WriteElevation), and how much was seen; written last
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "products/product_options.h"
#include "products/ray_caster.h"
#include "products/wall_planes.h"

namespace skyquilt::products {

// A rectangle on a vertical plane, seen from its front.
struct ElevationPlane {
  std::string name;  // of its files
  Eigen::Vector3d middle_enu = Eigen::Vector3d::Zero();
  double azimuth_deg = 0.0;  // to where its front looks, clockwise from +y (north)
  double width_m = 0.0, height_m = 0.0;
  // What is farther in front of the plane or behind it does not show.
  double front_m = 0.0, behind_m = 0.0;
  double resolution_m = 0.0;  // per pixel
  size_t points = 0;          // sparse points that it was found by; 0: it was stated

  Eigen::Vector3d Normal() const;  // out of the front
  Eigen::Vector3d Right() const;   // as seen from the front
  Eigen::Vector3d TopLeft() const;
};

// Walls to draw: those found in the survey, elevation_1 being the largest; none when there are no walls. image_width: as RunOptions::image_width.
std::vector<ElevationPlane> ElevationsOfWalls(const scene::SceneInfo& info, const survey::Survey& survey, const ProductOptions& options,
                                              int image_width);
// The plane that a user states: "x,y,z,azimuth" or "x,y,z,azimuth,width,height", (x, y, z) being the middle of the picture. Without width and height
// the picture covers what the scene's box shows on the plane. Named elevation_plane. survey: null when it is not known. Throws base::UsageError.
ElevationPlane StatedElevation(const std::string& text, const scene::SceneInfo& info, const survey::Survey* survey, const ProductOptions& options,
                               int image_width);

struct Elevation {
  std::filesystem::path picture;
  int width = 0, height = 0;  // pixels
  double shown = 0.0;         // share of the pixels that are not transparent, 0..1
};

// Renders and writes it into `folder`, which is created; `depth`: also the TIFF. Its JSON: "unit" ("m", or "unit of the reconstruction"),
// "resolution" of a pixel, "width_px", "height_px", "origin_enu" (the outer corner of the top left pixel), "right_enu" and "down_enu" (length 1):
// the middle of pixel (column, row) is origin + resolution * ((column + 0.5) * right + (row + 0.5) * down). Deterministic. Throws base::InputError
// and base::Interrupted.
Elevation WriteElevation(const ElevationPlane& plane, const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options,
                         const std::filesystem::path& folder, bool depth);
// All of ElevationsOfWalls, in place of those of an earlier run.
std::vector<Elevation> WriteElevationsOfWalls(const scene::SceneInfo& info, const survey::Survey& survey, const RayCaster& caster,
                                              const ProductOptions& options, int image_width, const std::filesystem::path& folder, bool depth);

}  // namespace skyquilt::products
