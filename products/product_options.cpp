#include "products/product_options.h"

#include <charconv>

#include "core/base/errors.h"
#include "products/product_kinds.h"

namespace skyquilt::products {
std::vector<config::Field<ProductOptions>> ProductOptions::Fields() {
  using config::Range;
  using O = ProductOptions;
  return {
      {"kinds", &O::kinds, Range(),
       "what is made: auto, all, or some of ortho, dsm, terrain, buildings, video and elevations, separated by commas; auto: where photos look "
       "level, "
       "elevations of walls and a video along the cameras, otherwise all but elevations"},
      {"ortho", &O::ortho, Range(), "make the orthophoto"},
      {"dsm", &O::dsm, Range(), "make the digital surface model"},
      {"preview", &O::preview, Range(),
       "make previews of the orthophoto until it is there: from the sparse points after prepare, and from the context after its training"},
      {"resolution_m", &O::resolution_m, Range{0, 1e5}, "metres per cell of orthophoto and surface model; 0: the ground sampling distance, rounded"},
      {"max_pixels", &O::max_pixels, Range{1, 1e11}, "most cells of the orthophoto; finer requests are refused"},
      {"min_opacity", &O::min_opacity, Range{0.01, 0.99}, "map cells with a lower opacity have no data"},
      {"exposure", &O::exposure, Range(),
       "brightness of images, video and orthophoto: normal, stops above normal (-10..10), or the name of a photo whose brightness to use"},
      {"ortho_source", &O::ortho_source, Range::OneOf({"photos", "field"}),
       "what the orthophoto is painted from: photos: from the photos, at their resolution, where they can be read; field: from the trained scene"},
      {"crop_m", &O::crop_m, Range{0, 10000}, "metres that are cut off the orthophoto all round, from where two photos see the ground; 0: none"},
      {"vertical", &O::vertical, Range::OneOf({"as-tagged", "ellipsoid", "egm96"}),
       "what heights of maps, surface and buildings are above: as-tagged keeps those of the survey, ellipsoid (WGS84) and egm96 convert them; 3D "
       "tiles "
       "are always above the ellipsoid"},
      {"boundary", &O::boundary, Range(),
       "file with polygons (GeoJSON or GeoPackage) that limit orthophoto, surface model, mesh, cloud, tiles and terrain; empty: the whole scene"},
      {"plain_surround", &O::plain_surround, Range(),
       "whether videos, views along a path, tours and the viewer's exact frames fade to a plain ground and sky where fewer than three photos look; "
       "false: what the scene extrapolates there. Maps, photos' views and scores never fade"},
      {"video_path", &O::video_path, Range::OneOf({"orbit", "flyover", "cameras"}),
       "camera path of the video: orbit circles the scene, flyover crosses it, cameras follows the photos"},
      {"video_seconds", &O::video_seconds, Range{0, 3600}, "length of the video in seconds; 0: no video"},
      {"video_fps", &O::video_fps, Range{1, 120}, "frames per second of the video"},
      {"video_width", &O::video_width, Range{16, 16384}.MultipleOf(2), "width of the video in pixels; even, as H.264 requires"},
      {"video_height", &O::video_height, Range{16, 16384}.MultipleOf(2), "height of the video in pixels; even, as H.264 requires"},
  };
}

std::vector<config::FixedOption> ProductOptions::Fixed() {
  return {{"preview_width", kPreviewWidth}};
}

void ProductOptions::Check() const {
  config::CheckRanges("products", *this);
  // A number is one of stops; anything else may be the name of a photo, which only the survey knows.
  ExposureStops(exposure);
  KindsOf(kinds, false);
}

std::optional<double> ExposureStops(const std::string& exposure) {
  const config::Range allowed{-10, 10};
  double stops = 0.0;
  const char* first = exposure.data() + (exposure.starts_with('+') ? 1 : 0);
  const auto parsed = std::from_chars(first, exposure.data() + exposure.size(), stops);
  if (parsed.ec != std::errc() || parsed.ptr != exposure.data() + exposure.size()) return std::nullopt;
  if (!allowed.Contains(stops)) throw base::UsageError("products.exposure = " + exposure + " is not allowed: stops must be " + allowed.Text());
  return stops;
}

}  // namespace skyquilt::products
