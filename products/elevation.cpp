#include "products/elevation.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/image/draw_text.h"
#include "products/cell_painter.h"
#include "products/map_rays.h"

namespace skyquilt::products {
namespace {

using ElevationJson = nlohmann::ordered_json;

constexpr double kRad = std::numbers::pi / 180.0;
constexpr const char* kWallName = "elevation_";
constexpr const char* kStatedName = "elevation_plane";
// Of the smaller of width and height: 3 m and 1.5 m at a wall 10 m high, as balconies stand out and windows lie back.
constexpr double kFrontShare = 0.3, kBehindShare = 0.15;
constexpr double kBeforeCameras = 0.5;  // of the distance to the nearest photo: what is nearer to it than to the wall is no part of the wall
constexpr int kGsdSteps = 5;            // places on each axis of the rectangle at which photos are asked for their resolution
constexpr int kElevationPng = 6;        // compression
constexpr double kBarShare = 0.25;      // of the preview's width
constexpr int kBarRoom_px = 44, kBarThickness_px = 4, kBarMargin_px = 12;
constexpr double kLetters_px = 12.0;

bool HasScale(const scene::SceneInfo& info) {
  return info.georeferenced || std::isfinite(info.accuracy.scale_percent);
}

std::string UnitOf(const scene::SceneInfo& info) {
  return HasScale(info) ? "m" : "unit of the reconstruction";
}

double AzimuthOf(const Eigen::Vector3d& normal) {
  const double azimuth = std::atan2(normal.x(), normal.y()) / kRad;
  return azimuth < 0.0 ? azimuth + 360.0 : azimuth;
}

Eigen::Vector3d PlaceAt(const ElevationPlane& plane, double right_m, double down_m) {
  return plane.TopLeft() + right_m * plane.Right() - down_m * Eigen::Vector3d::UnitZ();
}

// Metres per pixel of the training photo that sees the place best, as it is trained with; nothing when none sees it from the front.
std::optional<double> GsdAt(const survey::Survey& survey, const Eigen::Vector3d& x, const Eigen::Vector3d& normal, int image_width) {
  double best = std::numeric_limits<double>::infinity();
  for (const survey::Photo& photo : survey.photos) {
    if (photo.is_test || !((photo.cam_from_enu.OriginInSource() - x).dot(normal) > 0.0)) continue;
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    const Eigen::Vector3d x_in_cam = photo.cam_from_enu * x;
    const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(x_in_cam);
    if (!pixel || !(pixel->minCoeff() >= 0.0 && pixel->x() < camera.width && pixel->y() < camera.height)) continue;
    const double reduced = image_width > 0 && image_width < camera.width ? static_cast<double>(image_width) / camera.width : 1.0;
    best = std::min(best, x_in_cam.z() / (reduced * camera.FocalX()));
  }
  return std::isfinite(best) ? std::optional(best) : std::nullopt;
}

// Sets the resolution: as stated, or that of the nearest photos, rounded; coarser when the picture would have too many pixels.
void SetResolution(const scene::SceneInfo& info, const survey::Survey* survey, const ProductOptions& options, int image_width,
                   ElevationPlane* plane) {
  options.Check();
  const bool automatic = options.resolution_m <= 0.0;
  plane->resolution_m = options.resolution_m;
  if (automatic) {
    std::vector<double> found;
    for (int i = 0; survey != nullptr && i < kGsdSteps * kGsdSteps; ++i) {
      const double right = (i % kGsdSteps + 0.5) / kGsdSteps, down = (std::floor(i / kGsdSteps) + 0.5) / kGsdSteps;
      const Eigen::Vector3d x = PlaceAt(*plane, right * plane->width_m, down * plane->height_m);
      if (const std::optional<double> gsd = GsdAt(*survey, x, plane->Normal(), image_width)) found.push_back(*gsd);
    }
    const double otherwise = info.gsd_m > 0.0 ? info.gsd_m : std::max(plane->width_m, plane->height_m) / 1000.0;
    plane->resolution_m = NiceResolution(found.empty() ? otherwise : base::Median(found));
  }
  const auto pixels = [&](double resolution) { return std::ceil(plane->width_m / resolution) * std::ceil(plane->height_m / resolution); };
  const double most = automatic ? options.MostAutomaticCells() : options.max_pixels;
  if (!(pixels(plane->resolution_m) > most)) return;
  double fits = plane->resolution_m;
  while (pixels(fits) > most) fits = NiceResolution(1.6 * fits);
  if (!automatic) {
    throw base::UsageError(
        fmt::format("products.resolution_m = {} gives an elevation of {:.3g} million pixels, more than products.max_pixels; set it "
                    "to at least {}, or raise products.max_pixels",
                    options.resolution_m, pixels(plane->resolution_m) / 1e6, fits));
  }
  base::LogInfo("{}: made with {} per pixel, because {} would give {:.3g} million pixels; set products.resolution_m for finer ones", plane->name,
                fits, plane->resolution_m, pixels(plane->resolution_m) / 1e6);
  plane->resolution_m = fits;
}

// Sets how far in front of the plane and behind it things show.
void SetDepths(const survey::Survey* survey, ElevationPlane* plane) {
  const double size = std::min(plane->width_m, plane->height_m);
  plane->front_m = kFrontShare * size;
  plane->behind_m = kBehindShare * size;
  if (survey == nullptr) return;
  for (const survey::Photo& photo : survey->photos) {
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    const double before = (eye - plane->middle_enu).dot(plane->Normal());
    if (before > 0.0 && (photo.cam_from_enu * plane->middle_enu).z() > 0.0) plane->front_m = std::min(plane->front_m, kBeforeCameras * before);
  }
}

[[noreturn]] void RefusePlane(const std::string& text, const std::string& why) {
  throw base::UsageError("--plane " + text + " is not allowed: " + why +
                         ". Give auto, or x,y,z,azimuth or x,y,z,azimuth,width,height: the middle of the picture in the survey's frame (metres), "
                         "the direction to which the wall looks (degrees clockwise from north), and the picture's size (metres)");
}

std::vector<double> NumbersOf(const std::string& text) {
  std::vector<double> numbers;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    double value = 0.0;
    const auto parsed = std::from_chars(text.data() + begin, text.data() + end, value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + end || !std::isfinite(value)) {
      RefusePlane(text, "\"" + text.substr(begin, end - begin) + "\" is not a number");
    }
    numbers.push_back(value);
    begin = end + 1;
  }
  return numbers;
}

// Moves and sizes the picture so that it covers the scene's box.
void CoverBox(const scene::SceneInfo& info, ElevationPlane* plane) {
  const Eigen::Vector3d right = plane->Right();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector3d x((corner % 2 == 0 ? info.min_enu : info.max_enu).x(), (corner < 2 ? info.min_enu : info.max_enu).y(), 0.0);
    const double at = right.dot(x - plane->middle_enu);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  plane->middle_enu += 0.5 * (low + high) * right;
  plane->middle_enu.z() = 0.5 * (info.min_enu.z() + info.max_enu.z());
  plane->width_m = high - low;
  plane->height_m = info.max_enu.z() - info.min_enu.z();
}

void FillRectangle(image::Image8* image, int left, int top, int width, int height, uint8_t value) {
  for (int y = std::max(0, top); y < std::min(image->height, top + height); ++y) {
    for (int x = std::max(0, left); x < std::min(image->width, left + width); ++x) std::fill_n(image->At(x, y), 3, value);
  }
}

// The picture on white, at most kPreviewWidth wide, above a bar of a round length.
image::Image8 ScaledPreview(const image::Image8& rgba, double resolution_m, const std::string& unit) {
  image::Image8 picture(rgba.width, rgba.height, 3, 255);
  for (size_t i = 0; i < picture.data.size() / 3; ++i) {
    if (rgba.data[4 * i + 3] != 0) std::copy_n(rgba.data.data() + 4 * i, 3, picture.data.data() + 3 * i);
  }
  if (picture.width > kPreviewWidth)
    picture = image::Resize(picture, kPreviewWidth, image::ScaledHeight(picture.width, picture.height, kPreviewWidth));
  const double pixel_m = resolution_m * rgba.width / picture.width;
  const double bar_m = NiceResolution(kBarShare * picture.width * pixel_m);
  const int bar_px = static_cast<int>(std::lround(bar_m / pixel_m));
  image::Image8 preview(picture.width, picture.height + kBarRoom_px, 3, 255);
  std::copy(picture.data.begin(), picture.data.end(), preview.data.begin());
  const int top = picture.height + kBarMargin_px / 2;
  FillRectangle(&preview, kBarMargin_px, top, bar_px, kBarThickness_px, 0);
  for (const int end : {kBarMargin_px, kBarMargin_px + bar_px - 1}) FillRectangle(&preview, end, top, 1, 2 * kBarThickness_px, 0);
  image::DrawText(&preview, fmt::format("{:g} {}", bar_m, unit), kBarMargin_px, picture.height + kBarRoom_px - kBarMargin_px / 2, kLetters_px);
  return preview;
}

ElevationJson Triple(const Eigen::Vector3d& x) {
  return ElevationJson::array({x.x(), x.y(), x.z()});
}

ElevationJson Describe(const ElevationPlane& plane, const Elevation& made, const scene::SceneInfo& info, bool depth) {
  ElevationJson json;
  json["file"] = plane.name + ".png";
  json["preview"] = plane.name + "_preview.png";
  if (depth) json["depth"] = plane.name + "_depth.tiff";
  json["unit"] = UnitOf(info);
  json["resolution"] = plane.resolution_m;
  json["width_px"] = made.width;
  json["height_px"] = made.height;
  json["origin_enu"] = Triple(plane.TopLeft());
  json["right_enu"] = Triple(plane.Right());
  json["down_enu"] = Triple(-Eigen::Vector3d::UnitZ());
  json["azimuth_deg"] = plane.azimuth_deg;
  json["width"] = plane.resolution_m * made.width;
  json["height"] = plane.resolution_m * made.height;
  json["front"] = plane.front_m;
  json["behind"] = plane.behind_m;
  if (plane.points > 0) json["points"] = plane.points;
  json["shown"] = made.shown;
  if (info.georeferenced) {
    json["enu_at"] = {{"latitude", info.origin.latitude_deg}, {"longitude", info.origin.longitude_deg}, {"height", info.origin.height_m}};
  }
  return json;
}

void RemoveElevationsOfWalls(const std::filesystem::path& folder) {
  for (size_t i = 1; i <= kMostWalls; ++i) {
    // The description first, so that none names pictures that are not there.
    for (const char* ending : {".json", ".png", "_preview.png", "_depth.tiff"}) {
      std::error_code error;
      std::filesystem::remove(folder / (kWallName + std::to_string(i) + ending), error);
    }
  }
}

}  // namespace

Eigen::Vector3d ElevationPlane::Normal() const {
  return {std::sin(azimuth_deg * kRad), std::cos(azimuth_deg * kRad), 0.0};
}

Eigen::Vector3d ElevationPlane::Right() const {
  return Eigen::Vector3d::UnitZ().cross(Normal());
}

Eigen::Vector3d ElevationPlane::TopLeft() const {
  return middle_enu - 0.5 * width_m * Right() + 0.5 * height_m * Eigen::Vector3d::UnitZ();
}

std::vector<ElevationPlane> ElevationsOfWalls(const scene::SceneInfo& info, const survey::Survey& survey, const ProductOptions& options,
                                              int image_width) {
  std::vector<ElevationPlane> planes;
  for (const Wall& wall : FindWalls(survey)) {
    ElevationPlane plane;
    plane.name = kWallName + std::to_string(planes.size() + 1);
    plane.middle_enu = wall.middle_enu;
    plane.azimuth_deg = AzimuthOf(wall.normal_enu);
    plane.width_m = wall.width_m;
    plane.height_m = wall.height_m;
    plane.points = wall.points;
    SetDepths(&survey, &plane);
    SetResolution(info, &survey, options, image_width, &plane);
    planes.push_back(plane);
  }
  return planes;
}

ElevationPlane StatedElevation(const std::string& text, const scene::SceneInfo& info, const survey::Survey* survey, const ProductOptions& options,
                               int image_width) {
  const std::vector<double> numbers = NumbersOf(text);
  if (numbers.size() != 4 && numbers.size() != 6) RefusePlane(text, std::to_string(numbers.size()) + " numbers");
  ElevationPlane plane;
  plane.name = kStatedName;
  plane.middle_enu = {numbers[0], numbers[1], numbers[2]};
  plane.azimuth_deg = numbers[3];
  if (numbers.size() == 6) {
    plane.width_m = numbers[4];
    plane.height_m = numbers[5];
    if (!(plane.width_m > 0.0 && plane.height_m > 0.0)) RefusePlane(text, "width and height must be above 0");
  } else {
    CoverBox(info, &plane);
  }
  SetDepths(survey, &plane);
  SetResolution(info, survey, options, image_width, &plane);
  return plane;
}

Elevation WriteElevation(const ElevationPlane& plane, const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options,
                         const std::filesystem::path& folder, bool depth) {
  base::RequireWritableFolder(folder);
  // A wall of 5.0000001 m needs no more pixels than one of 5 m.
  const auto pixels = [&](double metres) { return std::max(1, static_cast<int>(std::ceil(metres / plane.resolution_m - 1e-3))); };
  Elevation made{.picture = folder / (plane.name + ".png"), .width = pixels(plane.width_m), .height = pixels(plane.height_m)};
  const Eigen::Vector3d normal = plane.Normal();
  PaintedCells cells;
  const size_t count = static_cast<size_t>(made.width) * static_cast<size_t>(made.height);
  cells.rgba.assign(4 * count, 0);
  cells.place.assign(count, std::numeric_limits<float>::quiet_NaN());
  CellPainter painter(caster, options.min_opacity);
  base::Progress progress(plane.name, static_cast<double>(count), "pixels");
  render::Ray ray;
  ray.direction_enu = -normal;
  ray.t_far = plane.front_m + plane.behind_m;
  ray.pixel_width = static_cast<float>(plane.resolution_m);
  for (int row = 0; row < made.height; ++row) {
    base::ThrowIfCancelled();
    for (int column = 0; column < made.width; ++column) {
      ray.origin_enu = PlaceAt(plane, plane.resolution_m * (column + 0.5), plane.resolution_m * (row + 0.5)) + plane.front_m * normal;
      const size_t cell = static_cast<size_t>(row) * static_cast<size_t>(made.width) + static_cast<size_t>(column);
      painter.Add(ray, cell, plane.front_m, &cells);
    }
    progress.Update((static_cast<double>(row) + 1.0) * made.width);
  }
  painter.Finish(&cells);
  progress.Finish();
  made.shown = static_cast<double>(painter.painted()) / static_cast<double>(count);

  image::Image8 picture(made.width, made.height, 4);
  picture.data = std::move(cells.rgba);
  base::WriteFileAtomically(made.picture, image::EncodePng(picture, kElevationPng));
  if (depth) {
    image::ImageF places(made.width, made.height, 1);
    places.data = std::move(cells.place);
    image::SaveFloatTiff(places, folder / (plane.name + "_depth.tiff"));
  }
  image::SavePng(ScaledPreview(picture, plane.resolution_m, HasScale(info) ? "m" : "units"), folder / (plane.name + "_preview.png"));
  base::WriteFileAtomically(folder / (plane.name + ".json"), base::JsonText(Describe(plane, made, info, depth), 2) + "\n");
  base::LogInfo("elevation of {:.4g} x {:.4g} {}, {} x {} pixels of {:.3g}, looking to {:.0f} degrees, {:.0f} % shown: {}",
                plane.resolution_m * made.width, plane.resolution_m * made.height, HasScale(info) ? "m" : "units of the reconstruction", made.width,
                made.height, plane.resolution_m, plane.azimuth_deg, 100.0 * made.shown, made.picture.string());
  return made;
}

std::vector<Elevation> WriteElevationsOfWalls(const scene::SceneInfo& info, const survey::Survey& survey, const RayCaster& caster,
                                              const ProductOptions& options, int image_width, const std::filesystem::path& folder, bool depth) {
  const std::vector<ElevationPlane> planes = ElevationsOfWalls(info, survey, options, image_width);
  RemoveElevationsOfWalls(folder);
  std::vector<Elevation> made;
  for (const ElevationPlane& plane : planes) made.push_back(WriteElevation(plane, info, caster, options, folder, depth));
  if (planes.empty()) base::LogInfo("no wall was found in the sparse points, so there is no elevation");
  return made;
}

}  // namespace skyquilt::products
