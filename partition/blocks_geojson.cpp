#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"
#include "core/survey/geo_fit.h"
#include "partition/block.h"
#include "partition/lonlat_polygon.h"

namespace skyquilt::partition {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
// Absent in files of older programs.
constexpr const char* kAccuracyKey = "skyquilt:accuracy";
constexpr const char* kHeightReferenceKey = "skyquilt:height_reference";

// JSON has no NaN: null is written instead.
Json Number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json Vector(const Eigen::Vector3d& x) {
  return Json::array({Number(x.x()), Number(x.y()), Number(x.z())});
}

// Straight edges in metres are curves in degrees. Large blocks and blocks near a pole need more points to keep their shape.
int PointsPerEdge(const Block& block, const geo::Geodetic& centre) {
  const double side = (block.max_enu - block.min_enu).head<2>().maxCoeff();
  const double distance_to_pole_m = (90.0 - std::abs(centre.latitude_deg)) * 111e3;
  if (side > 0.02 * distance_to_pole_m) return 32;
  return std::clamp(static_cast<int>(std::ceil(side / 5000.0)), 1, 32);
}

std::vector<Eigen::Vector2d> CornersInEnu(const Block& block) {
  return {{block.min_enu.x(), block.min_enu.y()},
          {block.max_enu.x(), block.min_enu.y()},
          {block.max_enu.x(), block.max_enu.y()},
          {block.min_enu.x(), block.max_enu.y()}};
}

LonLatOutline OutlineOf(const Block& block, const geo::EnuFrame& frame) {
  const std::vector<Eigen::Vector2d> corners = CornersInEnu(block);
  const geo::Geodetic centre =
      frame.GeodeticFromEnu({0.5 * (block.min_enu.x() + block.max_enu.x()), 0.5 * (block.min_enu.y() + block.max_enu.y()), block.min_enu.z()});
  const int n = PointsPerEdge(block, centre);
  std::vector<Eigen::Vector2d> outline;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d edge = corners[(i + 1) % corners.size()] - corners[i];
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d x = corners[i] + edge * k / n;
      const geo::Geodetic place = frame.GeodeticFromEnu({x.x(), x.y(), block.min_enu.z()});
      outline.emplace_back(place.longitude_deg, place.latitude_deg);
    }
  }
  return MakeOutline(outline);
}

LonLatOutline LocalOutline(const Block& block) {
  LonLatOutline outline;
  outline.parts.push_back(CornersInEnu(block));
  outline.parts.front().push_back(outline.parts.front().front());
  outline.west_deg = block.min_enu.x();
  outline.east_deg = block.max_enu.x();
  outline.south_deg = block.min_enu.y();
  outline.north_deg = block.max_enu.y();
  return outline;
}

Json Geometry(const LonLatOutline& outline) {
  Json polygons = Json::array();
  for (const Ring& ring : outline.parts) {
    Json points = Json::array();
    for (const Eigen::Vector2d& x : ring) points.push_back(Json::array({x.x(), x.y()}));
    polygons.push_back(Json::array({points}));
  }
  if (polygons.size() == 1) return {{"type", "Polygon"}, {"coordinates", polygons.front()}};
  return {{"type", "MultiPolygon"}, {"coordinates", polygons}};
}

Json BoundingBox(const LonLatOutline& outline) {
  return Json::array({outline.west_deg, outline.south_deg, outline.east_deg, outline.north_deg});
}

Json Properties(const Block& block) {
  return {{"name", block.name},
          {"min_enu", Vector(block.min_enu)},
          {"max_enu", Vector(block.max_enu)},
          {"margin_m", Number(block.margin_m)},
          {"altitude_agl_m", Number(block.altitude_agl_m)},
          {"flown_agl_m", Number(block.flown_agl_m)},
          {"gsd_m", Number(block.gsd_m)},
          {"finest_voxel_m", Number(block.finest_voxel_m)},
          {"log2_table_size", block.log2_table_size},
          {"expected_pixels", Number(block.expected_pixels)},
          {"cost", Number(block.cost)},
          {"empty", block.empty},
          {"empty_reason", block.empty_reason},
          {"photo_count", block.photos.size()},
          {"photos", block.photos}};
}

// Bounding box of all outlines. Longitudes are unwrapped relative to the first outline, so that it works across the date line.
LonLatOutline Union(const std::vector<LonLatOutline>& outlines) {
  LonLatOutline all = outlines.front();
  double width = 0.0;
  const double reference = all.west_deg;
  double west = 0.0;
  for (const LonLatOutline& one : outlines) {
    double start = one.west_deg - reference;
    start -= 360.0 * std::round(start / 360.0);
    const double span = one.east_deg - one.west_deg + (one.east_deg < one.west_deg ? 360.0 : 0.0);
    west = std::min(west, start);
    width = std::max(width, start + span);
    all.south_deg = std::min(all.south_deg, one.south_deg);
    all.north_deg = std::max(all.north_deg, one.north_deg);
  }
  if (width - west >= 360.0) {
    all.west_deg = -180.0;
    all.east_deg = 180.0;
    return all;
  }
  all.west_deg = geo::WrapLongitudeDeg(reference + west);
  const double east = all.west_deg + (width - west);
  all.east_deg = east > 180.0 ? east - 360.0 : east;
  return all;
}

double ReadNumber(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

Eigen::Vector3d ReadVector(const Json& value) {
  return {ReadNumber(value.at(0)), ReadNumber(value.at(1)), ReadNumber(value.at(2))};
}

Block ReadBlock(const Json& feature) {
  const Json& properties = feature.at("properties");
  Block block;
  block.id = feature.at("id").get<int>();
  block.name = properties.at("name").get<std::string>();
  block.min_enu = ReadVector(properties.at("min_enu"));
  block.max_enu = ReadVector(properties.at("max_enu"));
  block.margin_m = ReadNumber(properties.at("margin_m"));
  block.altitude_agl_m = ReadNumber(properties.at("altitude_agl_m"));
  if (properties.contains("flown_agl_m")) block.flown_agl_m = ReadNumber(properties.at("flown_agl_m"));
  block.gsd_m = ReadNumber(properties.at("gsd_m"));
  block.finest_voxel_m = ReadNumber(properties.at("finest_voxel_m"));
  block.log2_table_size = properties.at("log2_table_size").get<int>();
  block.photos = properties.at("photos").get<std::vector<int>>();
  block.expected_pixels = ReadNumber(properties.at("expected_pixels"));
  block.cost = ReadNumber(properties.at("cost"));
  block.empty = properties.at("empty").get<bool>();
  block.empty_reason = properties.at("empty_reason").get<std::string>();
  return block;
}

const char* const kFix = "Delete it and run `skyquilt partition` again";

void CheckBlock(const Block& block, size_t index, const std::filesystem::path& file) {
  const auto require = [&](bool good, const std::string& found) {
    if (!good) throw base::InputError(file, "block " + std::to_string(index) + " (\"" + block.name + "\") " + found, kFix);
  };
  require(block.id == static_cast<int>(index), "has id " + std::to_string(block.id) + "; ids must be 0, 1, 2, ... in file order");
  require(block.min_enu.allFinite() && block.max_enu.allFinite(), "has a box that is not finite");
  require((block.max_enu.array() > block.min_enu.array()).all(), "has a box without volume");
  require(std::isfinite(block.margin_m) && block.margin_m >= 0.0, "has a margin that is negative or not finite");
  if (block.empty) return;
  require(block.log2_table_size >= 1 && block.log2_table_size <= 24,
          "has log2_table_size " + std::to_string(block.log2_table_size) + "; it must be from 1 to 24");
  require(block.finest_voxel_m > 0.0, "has a finest voxel that is not positive");
  require(std::all_of(block.photos.begin(), block.photos.end(), [](int photo) { return photo >= 0; }), "names a photo with a negative index");
}

geo::HeightReference ReadHeightReference(const Json& name, const std::filesystem::path& file) {
  const auto reference = geo::HeightReferenceNamed(name.get<std::string>());
  if (!reference) throw base::InputError(file, "has heights above " + base::JsonText(name) + ", which is unknown", kFix);
  return *reference;
}

}  // namespace

void SaveBlocks(const BlockSet& blocks, const std::filesystem::path& file) {
  std::vector<LonLatOutline> outlines;
  if (blocks.georeferenced) {
    const geo::EnuFrame frame(blocks.origin);
    for (const Block& block : blocks.blocks) outlines.push_back(OutlineOf(block, frame));
  } else {
    for (const Block& block : blocks.blocks) outlines.push_back(LocalOutline(block));
  }
  Json features = Json::array();
  for (size_t i = 0; i < blocks.blocks.size(); ++i) {
    features.push_back({{"type", "Feature"},
                        {"id", blocks.blocks[i].id},
                        {"bbox", BoundingBox(outlines[i])},
                        {"geometry", Geometry(outlines[i])},
                        {"properties", Properties(blocks.blocks[i])}});
  }
  Json root = {{"type", "FeatureCollection"},
               {"skyquilt:version", kVersion},
               {"skyquilt:georeferenced", blocks.georeferenced},
               {"skyquilt:origin",
                {{"latitude_deg", Number(blocks.origin.latitude_deg)},
                 {"longitude_deg", Number(blocks.origin.longitude_deg)},
                 {"height_m", Number(blocks.origin.height_m)}}},
               {kAccuracyKey, survey::ToJson(blocks.accuracy)},
               {kHeightReferenceKey, geo::NameOf(blocks.height_reference)},
               {"skyquilt:rows", blocks.rows},
               {"skyquilt:columns", blocks.columns},
               {"skyquilt:image_width", blocks.image_width},
               {"skyquilt:config_hash", blocks.config_hash}};
  if (!outlines.empty() && blocks.georeferenced) root["bbox"] = BoundingBox(Union(outlines));
  root["features"] = features;
  base::WriteFileAtomically(file, base::JsonText(root, 1) + "\n");
}

BlockSet LoadBlocks(const std::filesystem::path& file) {
  const std::string text = base::ReadFile(file);
  BlockSet set;
  try {
    const Json root = Json::parse(text);
    if (!root.is_object() || root.value("type", "") != "FeatureCollection" || !root.contains("skyquilt:version")) {
      throw base::InputError(file, "is not a blocks file of Skyquilt", "Give the blocks.geojson that `skyquilt partition` wrote");
    }
    if (root.at("skyquilt:version").get<int>() != kVersion) {
      throw base::InputError(
          file, "has version " + base::JsonText(root.at("skyquilt:version")) + " but this program reads version " + std::to_string(kVersion), kFix);
    }
    const Json& origin = root.at("skyquilt:origin");
    set.origin = {ReadNumber(origin.at("latitude_deg")), ReadNumber(origin.at("longitude_deg")), ReadNumber(origin.at("height_m"))};
    set.georeferenced = root.at("skyquilt:georeferenced").get<bool>();
    if (root.contains(kAccuracyKey)) set.accuracy = survey::PlaceAccuracyFromJson(root.at(kAccuracyKey));
    if (root.contains(kHeightReferenceKey)) set.height_reference = ReadHeightReference(root.at(kHeightReferenceKey), file);
    set.rows = root.at("skyquilt:rows").get<int>();
    set.columns = root.at("skyquilt:columns").get<int>();
    set.image_width = root.at("skyquilt:image_width").get<int>();
    set.config_hash = root.at("skyquilt:config_hash").get<std::string>();
    for (const Json& feature : root.at("features")) set.blocks.push_back(ReadBlock(feature));
  } catch (const Json::exception& error) {
    throw base::InputError(file, std::string("cannot be read as blocks: ") + error.what(), kFix);
  }
  if (set.georeferenced && !geo::IsValid(set.origin)) throw base::InputError(file, "has an origin that is not a place on Earth", kFix);
  for (size_t i = 0; i < set.blocks.size(); ++i) CheckBlock(set.blocks[i], i, file);
  if (static_cast<int64_t>(set.rows) * set.columns != static_cast<int64_t>(set.blocks.size())) {
    throw base::InputError(file,
                           "says " + std::to_string(set.rows) + " rows and " + std::to_string(set.columns) + " columns but has " +
                               std::to_string(set.blocks.size()) + " blocks",
                           kFix);
  }
  return set;
}

}  // namespace skyquilt::partition
