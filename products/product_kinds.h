// Which kinds of products are made of a survey (products.kinds). What needs ground that photos look down on makes no sense for a facade, a tower or a
// room.
#pragma once

#include <string>

namespace skyquilt::products {

// The switches of single products, such as products.ortho, hold beside.
struct ProductKinds {
  bool ortho = false;      // orthophoto and its previews
  bool dsm = false;        // surface model
  bool terrain = false;    // terrain and its maps, of the surface
  bool buildings = false;  // measured buildings
  bool video = false;
  bool elevations = false;     // of walls (products/elevation.h)
  bool along_cameras = false;  // the video follows the cameras, whatever products.video_path says
};

// kinds: "auto", "all", or names of kinds (ortho, dsm, terrain, buildings, video, elevations) separated by commas. With auto, photos that look level
// (core/survey/view_kind.h) give elevations of walls and a video along the cameras; other photos give all but elevations. Buildings are measured
// above terrain, which is made for them. Throws base::UsageError.
ProductKinds KindsOf(const std::string& kinds, bool looks_level);
// In words: "orthophoto, surface model, video along the cameras"; "nothing" for none.
std::string NamesOf(const ProductKinds& kinds);

}  // namespace skyquilt::products
