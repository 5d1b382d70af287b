#include "simulate/control_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/crs.h"
#include "core/geo/utm.h"

namespace skyquilt::simulate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Coordinates of a point as text, in the order east or longitude, north or latitude, height: to 0.1 mm, in degrees to 0.01 mm. Heights of a map in
// feet without heights of its own are in feet too.
struct Written {
  std::string x, y, z;
};

Written InCrs(const geo::Crs& crs, const geo::Geodetic& place) {
  Eigen::Vector3d at = crs.FromGeodetic(place);
  if (crs.heights() == geo::CrsHeights::kNone && crs.horizontal().unit_m > 0.0) at.z() /= crs.horizontal().unit_m;
  const int digits = std::abs(at.x()) <= 360.0 && std::abs(at.y()) <= 360.0 ? 10 : 4;
  return {fmt::format("{:.{}f}", at.x(), digits), fmt::format("{:.{}f}", at.y(), digits), fmt::format("{:.4f}", at.z())};
}

template <typename Visit>
void ForEachMark(const ControlFiles& files, const Visit& visit) {
  for (const SurveyedTarget& point : files.points) {
    for (const TargetMark& mark : point.marks) visit(point, mark, files.photos[mark.photo]);
  }
}

std::string GcpList(const ControlFiles& files, const std::vector<Written>& written) {
  std::string text = files.crs + "\n";
  for (size_t i = 0; i < files.points.size(); ++i) {
    for (const TargetMark& mark : files.points[i].marks) {
      text += fmt::format("{} {} {} {:.3f} {:.3f} {} {}\n", written[i].x, written[i].y, written[i].z, mark.pixel.x() - 0.5, mark.pixel.y() - 0.5,
                          files.photos[mark.photo], files.points[i].target.label);
    }
  }
  return text;
}

Json OpenSfm(const ControlFiles& files, const std::vector<geo::Geodetic>& places) {
  const double size = std::max(files.camera.width, files.camera.height);
  Json points = Json::array();
  for (size_t i = 0; i < files.points.size(); ++i) {
    Json observations = Json::array();
    for (const TargetMark& mark : files.points[i].marks) {
      observations.push_back(
          {{"shot_id", files.photos[mark.photo]},
           {"projection", {(mark.pixel.x() - 0.5 * files.camera.width) / size, (mark.pixel.y() - 0.5 * files.camera.height) / size}}});
    }
    points.push_back(
        {{"id", files.points[i].target.label},
         {"observations", std::move(observations)},
         {"position", {{"latitude", places[i].latitude_deg}, {"longitude", places[i].longitude_deg}, {"altitude", places[i].height_m}}}});
  }
  return {{"points", std::move(points)}};
}

std::string Table(const ControlFiles& files, const std::vector<Written>& written) {
  std::string text;
  for (size_t i = 0; i < files.points.size(); ++i) {
    text += files.points[i].target.label + "," + written[i].x + "," + written[i].y + "," + written[i].z + "\n";
  }
  return text;
}

std::string MarkTable(const ControlFiles& files) {
  std::string text;
  ForEachMark(files, [&text](const SurveyedTarget& point, const TargetMark& mark, const std::string& photo) {
    text += fmt::format("{},{},{:.3f},{:.3f}\n", photo, point.target.label, mark.pixel.x(), mark.pixel.y());
  });
  return text;
}

// Names of photos and labels are letters, digits, dots and underscores: nothing to escape.
std::string MetashapeMarks(const ControlFiles& files) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\">\n  <chunk label=\"Chunk 1\" enabled=\"true\">\n    <sensors "
      "next_id=\"1\">\n      <sensor id=\"0\" label=\"Simulated\" type=\"frame\">\n        <resolution width=\"{}\" height=\"{}\"/>\n      "
      "</sensor>\n    </sensors>\n    <cameras next_id=\"{}\" next_group_id=\"0\">\n",
      files.camera.width, files.camera.height, files.photos.size());
  for (size_t i = 0; i < files.photos.size(); ++i) {
    text += fmt::format("      <camera id=\"{}\" sensor_id=\"0\" label=\"{}\" enabled=\"true\"/>\n", i, files.photos[i]);
  }
  text += fmt::format("    </cameras>\n    <markers next_id=\"{}\" next_group_id=\"0\">\n", files.points.size());
  for (size_t i = 0; i < files.points.size(); ++i) text += fmt::format("      <marker id=\"{}\" label=\"{}\"/>\n", i, files.points[i].target.label);
  text += "    </markers>\n    <frames next_id=\"1\">\n      <frame id=\"0\">\n        <markers>\n";
  for (size_t i = 0; i < files.points.size(); ++i) {
    text += fmt::format("          <marker marker_id=\"{}\">\n", i);
    for (const TargetMark& mark : files.points[i].marks) {
      text += fmt::format("            <location camera_id=\"{}\" pinned=\"true\" x=\"{:.3f}\" y=\"{:.3f}\"/>\n", mark.photo, mark.pixel.x(),
                          mark.pixel.y());
    }
    text += "          </marker>\n";
  }
  return text + "        </markers>\n      </frame>\n    </frames>\n  </chunk>\n</document>\n";
}

Json Vector(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json Truth(const ControlFiles& files, const geo::EnuFrame& frame) {
  Json points = Json::array();
  for (const SurveyedTarget& point : files.points) {
    const geo::Geodetic place = frame.GeodeticFromEnu(point.target.position);
    Json marks = Json::array();
    for (const TargetMark& mark : point.marks) {
      marks.push_back({{"photo", files.photos[mark.photo]},
                       {"true_pixel", {mark.true_pixel.x(), mark.true_pixel.y()}},
                       {"pixel", {mark.pixel.x(), mark.pixel.y()}},
                       {"wrong", mark.wrong}});
    }
    points.push_back({{"label", point.target.label},
                      {"check", point.target.check},
                      {"enu_m", Vector(point.target.position)},
                      {"latitude_deg", place.latitude_deg},
                      {"longitude_deg", place.longitude_deg},
                      {"height_m", place.height_m},
                      {"wrong", point.wrong},
                      {"given_enu_m", Vector(point.given)},
                      {"side_m", point.target.side_m},
                      {"marks", std::move(marks)}});
  }
  return {{"about",
           "enu_m: true position of the target's centre; given_enu_m: where the other files have it; pixels: the photo's corner is (0, 0); heights "
           "are ellipsoidal"},
          {"crs", files.crs},
          {"points", std::move(points)}};
}

}  // namespace

std::string ControlCrsOf(const std::string& option, const geo::Geodetic& place) {
  return option.empty() ? "EPSG:" + std::to_string(geo::UtmZoneOf(place).Epsg()) : option;
}

void WriteControlFiles(const ControlFiles& files, const geo::EnuFrame& frame, const fs::path& folder) {
  const fs::path control = folder / "control";
  fs::create_directories(control);
  const geo::Crs crs(files.crs);
  std::vector<geo::Geodetic> places;
  std::vector<Written> written;
  std::string checks;
  for (const SurveyedTarget& point : files.points) {
    places.push_back(frame.GeodeticFromEnu(point.given));
    written.push_back(InCrs(crs, places.back()));
    if (point.target.check) checks += point.target.label + "\n";
  }
  base::WriteFileAtomically(control / "gcp_list.txt", GcpList(files, written));
  base::WriteFileAtomically(control / "ground_control_points.json", base::JsonText(OpenSfm(files, places), 1) + "\n");
  base::WriteFileAtomically(control / "pix4d.csv", Table(files, written));
  base::WriteFileAtomically(control / "pix4d_marks.csv", MarkTable(files));
  base::WriteFileAtomically(control / "metashape.csv", "label,x,y,z\n" + Table(files, written));
  base::WriteFileAtomically(control / "metashape_marks.xml", MetashapeMarks(files));
  base::WriteFileAtomically(control / "check_points.txt", checks);
  base::WriteFileAtomically(control / "truth.json", base::JsonText(Truth(files, frame), 1) + "\n");
}

}  // namespace skyquilt::simulate
