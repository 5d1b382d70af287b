// A project with a tour of two stops about the house of sample_fields.h, an asset that is there and one that is not, and a surface of three levels.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/sha256.h"
#include "tests/support/temporary_folder.h"
#include "tests/tour/format/sample_assets.h"
#include "tests/tour/pictures/sample_fields.h"
#include "tour/export/export_tour.h"
#include "tour/format/tour_file.h"

namespace skyquilt::tour {

inline nlohmann::ordered_json SampleTile(const std::string& name, double error_m, double x0, double y0, double size) {
  return {{"boundingVolume", {{"box", {x0 + size / 2, y0 + size / 2, 5, size / 2, 0, 0, 0, size / 2, 0, 0, 0, 5}}}},
          {"geometricError", error_m},
          {"content", {{"uri", name + ".glb"}}}};
}

// 64 x 64 m: one tile, 4 below it, 16 below these. Finer tiles are larger files.
inline void WriteSampleTiles(const std::filesystem::path& folder) {
  using Json = nlohmann::ordered_json;
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& name, size_t bytes) { base::WriteFileAtomically(folder / (name + ".glb"), std::string(bytes, 'g')); };
  Json root = SampleTile("2_0_0", 8.0, 0.0, 0.0, 64.0);
  write("2_0_0", 1000);
  for (int i = 0; i < 4; ++i) {
    const int x = i % 2, y = i / 2;
    const std::string name = "1_" + std::to_string(x) + "_" + std::to_string(y);
    Json middle = SampleTile(name, 2.0, 32.0 * x, 32.0 * y, 32.0);
    write(name, 2000);
    for (int j = 0; j < 4; ++j) {
      const int u = 2 * x + j % 2, v = 2 * y + j / 2;
      const std::string fine = "0_" + std::to_string(u) + "_" + std::to_string(v);
      middle["children"].push_back(SampleTile(fine, 0.0, 16.0 * u, 16.0 * v, 16.0));
      write(fine, 4000);
    }
    root["children"].push_back(middle);
  }
  root["refine"] = "REPLACE";
  root["transform"] = Json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 200, 300, 1});
  const Json tileset = {{"asset", {{"version", "1.1"}}}, {"geometricError", 16.0}, {"root", root}};
  base::WriteFileAtomically(folder / "tileset.json", base::JsonText(tileset, 1));
}

struct SampleTourProject {
  TemporaryFolder folder;
  std::filesystem::path project = folder / "project", out = folder / "given away";
  std::string picture = SampleJpg(), picture_name = base::Sha256Hex(picture) + ".jpg", lost = std::string(64, 'a') + ".png";
  CountedField counted;
  base::ThreadPool threads{2};
  ExportParts parts;
  TourOptions options;

  SampleTourProject() {
    std::filesystem::create_directories(AssetFolder(project));
    base::WriteFileAtomically(AssetFolder(project) / picture_name, picture);
    WriteSampleTiles(project / "surface" / "tiles");
    SaveTour(TourWith("The <house>"), project);
    base::WriteFileAtomically(project / "measurements.geojson", "{}");
    parts.page = {{"index.html", "<!doctype html>"}, {"tour.js", "js"}, {"tour.css", "css"}, {"licences.txt", "MIT"}};
    parts.made_by = "skyquilt 9";
    parts.project_json = R"({"name": "project", "scene": {"blocks": 1}, "tiles": "tiles/tileset.json", "points": "points.bin", "contours": null,
      "terrain": "terrain.bin", "orthophoto": null, "photos": [{"name": "a.jpg", "available": true}], "buildings": null,
      "missing": [{"what": "x", "reason": "not in /home/somebody/photos", "advice": "y"}]})";
    parts.tiles = project / "surface" / "tiles";
    parts.terrain = [] { return std::string("terrain"); };
    options.still_width = 48;
    options.still_height = 27;
    options.panorama_width = 64;
  }

  Tour TourWith(const std::string& title) const {
    Tour tour;
    tour.title = title;
    Stop stop;
    stop.id = "first";
    stop.title = "</script><script>alert(1)</script>";
    stop.text = "\");alert(1);//";
    stop.pose.eye_enu = {4.0, 4.0, 40.0};
    stop.pose.cam_from_enu = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    stop.picture = picture_name;
    stop.next = Next{};
    tour.stops.push_back(stop);
    stop.id = "second";
    stop.title = "農場";
    stop.pose.eye_enu = {20.0, 8.0, 45.0};
    stop.picture = lost;
    tour.stops.push_back(stop);
    tour.assets[picture_name] = {"house.jpg", picture.size()};
    tour.assets[lost] = {"lost.png", 12};
    return tour;
  }

  ExportInput Input() const { return {.project = project, .work = project / "tour" / "work", .out = out, .options = options, .make_video = {}}; }
  Exported Export() { return ExportTour(Input(), parts, counted.field, threads); }
};

// The content of a data script, decoded by the rules of RFC 4648; "?" when the file is no such script.
inline std::string ContentOf(const std::filesystem::path& out, const std::string& name) {
  const std::string script = base::ReadFile(out / "data" / (name + ".js"));
  const std::string begin = "skyquiltData(\"" + name + "\", \"", end = "\");\n";
  if (!script.starts_with(begin) || !script.ends_with(end)) return "?";
  const std::string text = script.substr(begin.size(), script.size() - begin.size() - end.size());
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  unsigned count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const size_t digit = digits.find(c);
    if (digit == std::string::npos) return "?";
    bits = bits << 6U | static_cast<uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 255U));
  }
  return bytes;
}

}  // namespace skyquilt::tour
