// Maps and points of a project in the formats of docs/viewer_protocol.md. All throw base::InputError when a file of the project cannot be read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "viewer/data/survey_place.h"

namespace skyquilt::viewer {

// Maps may have other heights than the survey (products.vertical); what is made of them has the survey's, like everything that is shown.
// terrain.bin from dsm.tif: at most 512 cells along the longer side, each with the highest of the DSM's.
std::string TerrainFile(const std::filesystem::path& dsm, const SurveyFrame& frame);
// orthophoto.jpg from orthophoto.tif: from the first to the last column and row of points of that grid, at most 2048 pixels along the longer side;
// grey where it has no data.
std::string OrthophotoFile(const std::filesystem::path& orthophoto, const std::filesystem::path& dsm);
// points.bin: at most 2,000,000 points, every n-th when there are more.
std::string PointsFile(const std::vector<survey::SparsePoint>& points);
// tiles/tileset.json, its root where the survey's heights put it. A damaged one is sent as it is: the page says what is wrong.
std::string TilesetFile(const std::filesystem::path& tileset_json);
// contours.json: at most 300,000 vertices.
std::string ContoursFile(const std::filesystem::path& gpkg, const SurveyFrame& frame);

}  // namespace skyquilt::viewer
