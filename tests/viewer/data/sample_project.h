// A small project in a temporary folder: a survey of two photos, a surface model with its orthophoto, and a surface with one tile.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/gis/geotiff.h"
#include "core/image/image.h"
#include "tests/support/temporary_folder.h"
#include "viewer/data/project_data.h"

namespace skyquilt::viewer {

struct SampleProject {
  TemporaryFolder folder;
  coordinator::Project project{folder.path() / "project"};
  std::filesystem::path photos = folder.path() / "photos";

  SampleProject() {
    std::filesystem::create_directories(photos);
    std::filesystem::create_directories(project.folder);
    survey::Survey survey;
    survey.origin = {47.3769, 8.5417, 408.0};
    survey.georeferenced = true;
    survey.photo_root = photos;
    survey.cameras.push_back({camera::CameraModel::kSimplePinhole, 640, 400, {500.0, 320.0, 200.0}});
    for (int i = 0; i < 2; ++i) {
      survey::Photo photo;
      photo.name = "IMG_" + std::to_string(i) + ".jpg";
      photo.is_test = i == 1;
      // Straight down from 50 m: x east, y south.
      photo.cam_from_enu.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
      photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * Eigen::Vector3d(10.0 * i, 0.0, 50.0));
      survey.photos.push_back(photo);
      image::SaveJpeg(image::Image8(640, 400, 3, static_cast<uint8_t>(60 + 100 * i)), photos / photo.name, 90);
    }
    for (int i = 0; i < 100; ++i) survey.points.push_back({{-20.0 + 0.4 * i, 0.2 * i, 1.0}, {10, 20, 30}, 0.5F, 3});
    survey::SaveSurvey(survey, project.SurveyFolder());
  }

  // A plane 10 m above the origin, with one hole, and an orthophoto of one colour.
  // dsm_height_m: of all cells but one, in a map whose heights had the undulation of EGM96 added so often.
  void AddMaps(int width = 40, int height = 30, double dsm_height_m = 418.0, int undulations = 0) const {
    gis::MapGrid grid;
    grid.georeferenced = true;
    const geo::Geodetic origin{47.3769, 8.5417, 408.0};
    grid.zone = geo::UtmZoneOf(origin);
    const Eigen::Vector2d middle = geo::UtmFromGeodetic(origin, grid.zone);
    grid.resolution_m = 0.5;
    grid.width = width;
    grid.height = height;
    grid.left = middle.x() - 0.25 * width;
    grid.top = middle.y() + 0.25 * height;
    std::filesystem::create_directories(project.ProductsFolder());
    std::vector<float> heights(static_cast<size_t>(width) * static_cast<size_t>(height), static_cast<float>(dsm_height_m));
    heights[0] = -9999.0F;
    gis::GeoTiffSpec heights_spec;
    heights_spec.grid = grid;
    heights_spec.type = gis::PixelType::kFloat32;
    heights_spec.nodata = -9999.0;
    if (undulations != 0) heights_spec.metadata[geo::kUndulationsItem] = std::to_string(undulations);
    gis::GeoTiffWriter dsm(project.ProductsFolder() / "dsm.tif", heights_spec);
    dsm.WriteRows(0, height, std::span<const float>(heights));
    dsm.Close();
    WriteOrthophoto(grid, [](double, double) { return std::array<uint8_t, 4>{200, 200, 200, 200}; });
  }

  // color: red, green, blue, alpha at easting and northing.
  void WriteOrthophoto(const gis::MapGrid& grid, const std::function<std::array<uint8_t, 4>(double, double)>& color) const {
    std::vector<uint8_t> colors;
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        const Eigen::Vector2d at = grid.CellCentre(column, row);
        for (const uint8_t value : color(at.x(), at.y())) colors.push_back(value);
      }
    }
    gis::GeoTiffSpec spec;
    spec.grid = grid;
    spec.bands = 4;
    gis::GeoTiffWriter ortho(project.ProductsFolder() / "orthophoto.tif", spec);
    ortho.WriteRows(0, grid.height, std::span<const uint8_t>(colors));
    ortho.Close();
  }

  void AddSurface() const {
    std::filesystem::create_directories(project.SurfaceFolder() / "tiles");
    base::WriteFileAtomically(project.SurfaceTable(), R"({"triangles": 12, "points": 34, "area_m2": 5.5, "voxel_m": 0.25})");
    base::WriteFileAtomically(project.SurfaceFolder() / "tiles" / "tileset.json", "{}");
    base::WriteFileAtomically(project.SurfaceFolder() / "tiles" / "0_-1_2.glb", "glTF");
    base::WriteFileAtomically(project.SurfaceFolder() / "tiles" / "notes.txt", "private");
  }
};

// Tests that add files to the project first open it themselves.
class SampleProjectTest : public ::testing::Test {
 protected:
  SampleProject sample_;
  ProjectData data_{sample_.project};
};

inline nlohmann::json DescriptionOf(ProjectData& data) {
  const DataReply reply = data.Get("project.json", "");
  return reply.status == 200 ? base::ParseJson(reply.body) : nlohmann::json();
}

inline bool IsMissing(const nlohmann::json& description, const std::string& what) {
  for (const nlohmann::json& one : description["missing"]) {
    if (one["what"] == what) return !one["reason"].get<std::string>().empty() && !one["advice"].get<std::string>().empty();
  }
  return false;
}

}  // namespace skyquilt::viewer
