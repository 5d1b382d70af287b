#include "surface/files/georeference_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"

namespace skyquilt::surface {
namespace {

using Json = nlohmann::ordered_json;

std::string Whole(double value) {
  return std::to_string(std::llround(value));
}

}  // namespace

std::vector<std::string> DescribePlace(const MapFrame& frame) {
  const Eigen::Vector3d& offset = frame.offset();
  return {"Skyquilt surface, metres", "CRS: " + frame.CrsName(),
          "offset: " + Whole(offset.x()) + " " + Whole(offset.y()) + " " + Whole(offset.z()) + " (add it to x y z)",
          "heights above: " + frame.VerticalName()};
}

GeoreferenceFile::GeoreferenceFile(const MapFrame& frame, const std::filesystem::path& folder) : frame_(frame), json_(folder / "georeference.json") {
  if (frame.georeferenced()) offset_ = std::make_unique<base::OutputFile>(folder / "offset.txt");
}

void GeoreferenceFile::Complete() {
  const Eigen::Vector3d& offset = frame_.offset();
  const geo::Geodetic& origin = frame_.origin();
  Json json;
  json["crs"] = frame_.georeferenced() ? Json(frame_.CrsName()) : Json(nullptr);
  json["offset"] = Json::array({offset.x(), offset.y(), offset.z()});
  json["vertical"] = frame_.VerticalName();
  json["origin"] = nullptr;
  if (frame_.georeferenced()) {
    json["origin"] = {{"latitude_deg", origin.latitude_deg}, {"longitude_deg", origin.longitude_deg}, {"height_m", origin.height_m}};
    json["note"] =
        "Add offset to x, y, z of mesh.obj, mesh.ply and cloud.ply to get easting, northing and height in the CRS. mesh.glb has y up: easting = x + "
        "offset[0], northing = offset[1] - z, height = y + offset[2]. cloud.las and the maps have full coordinates. tiles/tileset.json is placed in "
        "earth-centred coordinates (EPSG:4978) from the east-north-up frame at origin.";
  } else {
    json["note"] =
        "The survey has no geo-reference: all files have the coordinates of its local frame, z up (mesh.glb and the contents of tiles/: y up), in "
        "metres if its scale is known.";
  }
  json_.Append(base::JsonText(json, 2) + "\n");
  json_.Complete();
  if (!offset_) return;
  const geo::UtmZone& zone = frame_.zone();
  offset_->Append((zone.zone == 0 ? frame_.CrsName() : "WGS84 " + zone.Name()) + "\n" + Whole(offset.x()) + " " + Whole(offset.y()) + "\n");
  offset_->Complete();
}

void GeoreferenceFile::Publish() {
  if (offset_) offset_->Publish();
  json_.Publish();
}

std::vector<WrittenFile> GeoreferenceFile::Rows() const {
  const uint64_t bytes = json_.size() + (offset_ ? offset_->size() : 0);
  return {{.file = "georeference.json",
           .content = "CRS and offset of the files",
           .format = "JSON",
           .crs = frame_.CrsName(),
           .vertical = frame_.VerticalName(),
           .bytes = static_cast<int64_t>(bytes),
           .detail = ""}};
}

}  // namespace skyquilt::surface
