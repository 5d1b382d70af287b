#include "tests/prepare/control/reading/made_control_files.h"

#include <fmt/core.h>

#include <fstream>

#include "core/geo/crs.h"

namespace skyquilt::test {
namespace {

// As they are written in files: east, north, height, all in the system's unit.
Eigen::Vector3d Written(const geo::Geodetic& place, const geo::Crs& crs) {
  Eigen::Vector3d x = crs.FromGeodetic(place);
  if (crs.heights() == geo::CrsHeights::kNone && crs.horizontal().unit_m > 0.0) x.z() = place.height_m / crs.horizontal().unit_m;
  return x;
}

// "x<between>y<between>z"; ten decimals are 0.01 mm in degrees.
std::string Numbers(const Eigen::Vector3d& x, const char* between) {
  return fmt::format("{:.10f}{}{:.10f}{}{:.10f}", x.x(), between, x.y(), between, x.z());
}

}  // namespace

MadeControl MakeControl() {
  MadeControl made;
  made.photos = {{"a/DJI_0001.JPG", 4000, 3000}, {"a/DJI_0002.JPG", 4000, 3000}, {"b/DJI_0003.JPG", 3000, 4000}, {"b/DJI_0004.JPG", 4000, 3000}};
  const std::vector<Eigen::Vector2d> places = {{0.0, 0.0}, {0.002, 0.0}, {0.002, 0.0015}, {0.0, 0.0015}, {0.001, 0.0007}};
  for (size_t i = 0; i < places.size(); ++i) {
    MadePoint point;
    point.label = "GCP-" + std::to_string(i + 1);
    point.place = {40.715 + places[i].y(), -73.98 + places[i].x(), -20.0 + 3.25 * static_cast<double>(i)};
    for (size_t k = 0; k < 3; ++k) {
      const double offset = 10.25 * static_cast<double>(i + k);
      point.marks.push_back({(i + k) % made.photos.size(), {1000.5 + offset, 2000.75 - 3.0 * offset}});
    }
    made.points.push_back(point);
  }
  return made;
}

ControlTexts OdmFiles(const MadeControl& made, const std::string& definition) {
  const geo::Crs crs(definition);
  std::string text = definition + "\n";
  for (const MadePoint& point : made.points) {
    for (const MadeMark& mark : point.marks) {
      text += fmt::format("{}\t{:.4f} {:.4f} {} {}\n", Numbers(Written(point.place, crs), " "), mark.pixel.x() - 0.5, mark.pixel.y() - 0.5,
                          made.photos[mark.photo].name, point.label);
    }
  }
  return {{"gcp_list.txt", text}};
}

ControlTexts OpensfmControlFiles(const MadeControl& made) {
  std::string points;
  for (const MadePoint& point : made.points) {
    std::string observations;
    for (const MadeMark& mark : point.marks) {
      const prepare::control::PhotoSize& photo = made.photos[mark.photo];
      const double unit = std::max(photo.width, photo.height);
      observations += fmt::format("{}\n    {{\"shot_id\": \"{}\", \"projection\": [{:.12f}, {:.12f}]}}", observations.empty() ? "" : ",", photo.name,
                                  (mark.pixel.x() - 0.5 * photo.width) / unit, (mark.pixel.y() - 0.5 * photo.height) / unit);
    }
    points += fmt::format(
        "{}\n  {{\"id\": \"{}\", \"position\": {{\"latitude\": {:.10f}, \"longitude\": {:.10f}, \"altitude\": {:.6f}}}, \"observations\": [{}]}}",
        points.empty() ? "" : ",", point.label, point.place.latitude_deg, point.place.longitude_deg, point.place.height_m, observations);
  }
  return {{"ground_control_points.json", "{\"points\": [" + points + "\n]}\n"}};
}

ControlTexts Pix4dFiles(const MadeControl& made, const std::string& definition) {
  const geo::Crs crs(definition);
  ControlTexts texts;
  for (const MadePoint& point : made.points) {
    texts["points.csv"] += point.label + "," + Numbers(Written(point.place, crs), ",") + "\n";
    for (const MadeMark& mark : point.marks) {
      texts["marks.csv"] += fmt::format("{},{},{:.4f},{:.4f}\n", made.photos[mark.photo].name, point.label, mark.pixel.x(), mark.pixel.y());
    }
  }
  return texts;
}

ControlTexts MetashapeControlFiles(const MadeControl& made, const std::string& definition) {
  const geo::Crs crs(definition);
  std::string table = "#Label,X/Easting,Y/Northing,Z/Altitude,Accuracy_(m)\n";
  std::string labels, marks, cameras, sensors;
  for (size_t i = 0; i < made.photos.size(); ++i) {
    const prepare::control::PhotoSize& photo = made.photos[i];
    sensors += fmt::format("<sensor id=\"{}\"><resolution width=\"{}\" height=\"{}\"/></sensor>\n", i, photo.width, photo.height);
    cameras += fmt::format("<camera id=\"{}\" sensor_id=\"{}\" label=\"{}\"/>\n", i, i, std::filesystem::path(photo.name).stem().string());
  }
  for (size_t i = 0; i < made.points.size(); ++i) {
    const MadePoint& point = made.points[i];
    table += fmt::format("{},{},0.015\n", point.label, Numbers(Written(point.place, crs), ","));
    labels += fmt::format("<marker id=\"{}\" label=\"{}\"/>\n", i, point.label);
    marks += fmt::format("<marker marker_id=\"{}\">\n", i);
    for (const MadeMark& mark : point.marks) {
      marks += fmt::format("<location camera_id=\"{}\" pinned=\"true\" x=\"{:.4f}\" y=\"{:.4f}\"/>\n", mark.photo, mark.pixel.x(), mark.pixel.y());
    }
    marks += "</marker>\n";
  }
  const std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.4.0\">\n<chunk label=\"Chunk 1\">\n<sensors>\n" +
                          sensors + "</sensors>\n<cameras>\n" + cameras + "</cameras>\n<markers>\n" + labels +
                          "</markers>\n<frames>\n<frame id=\"0\">\n<markers>\n" + marks + "</markers>\n</frame>\n</frames>\n</chunk>\n</document>\n";
  return {{"reference.csv", table}, {"markers.xml", xml}};
}

void WriteTexts(const ControlTexts& texts, const std::filesystem::path& folder) {
  for (const auto& [name, text] : texts) std::ofstream(folder / name, std::ios::binary) << text;
}

}  // namespace skyquilt::test
