// What an exported tour needs of its project beside the tour itself. Made by whoever knows the project: the viewer shows the same files.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace skyquilt::tour {

struct PageFile {
  std::string name;  // index.html, tour.js, tour.css, licences.txt
  std::string content;
};

struct ExportParts {
  std::vector<PageFile> page;
  std::string made_by;                      // "skyquilt 1.2.0"
  std::string project_json;                 // as the viewer's
  std::filesystem::path tiles;              // folder of the surface's tiles; empty: there are none
  std::filesystem::path buildings;          // buildings.json; empty: there are none
  std::function<std::string()> terrain;     // content of terrain.bin; null: there is no surface model. May throw base::InputError
  std::function<std::string()> orthophoto;  // of orthophoto.jpg; null: there is none
};

}  // namespace skyquilt::tour
