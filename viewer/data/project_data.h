// What browsers get below /data/: descriptions and files of one project, or of two that are compared. Every path comes from a fixed table that is
// made when the project is opened; docs/viewer_protocol.md lists them.
//   project.json                     what there is and, for what is missing, the reason and the command that makes it
//   tiles/tileset.json, tiles/*.glb  surface/tiles
//   terrain.bin, orthophoto.jpg      DSM as a grid and orthophoto, at most 512 points and 2048 pixels long: shown when there are no tiles
//   points.bin, contours.json        sparse points; contours.gpkg as lines
//   buildings/buildings.json, .csv, .city.json, .gpkg, .glb, .dxf   what 'skyquilt buildings' wrote
//   photos/<i>/thumbnail.jpg, /photo.jpg, /full.jpg   256 and 2048 pixels wide; the photo itself
//   measurements.geojson, gcp.json, camera_path.json, tour.json  saved documents (GET, PUT)
//   gcp_list.txt                     answers with the control points of the list that is sent (PUT)
//   tour/assets/<digest>.<type>      models and pictures of the tour (GET, PUT)
//   pictures/<n>.png                 made by queries
//   before/...                       the same of the earlier project, without the saved documents
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "coordinator/project/project.h"
#include "core/survey/survey.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

class ProjectData : public DataSource {
 public:
  // Opens as much as can be read; what is damaged or missing becomes a reason in project.json. Throws only when the folder is not a project.
  explicit ProjectData(const coordinator::Project& project, const std::optional<coordinator::Project>& before = {});
  ~ProjectData() override;

  DataReply Get(const std::string& path, const std::string& query) override;
  DataReply Put(const std::string& path, const std::string& body, const std::string& if_match) override;

  // The survey of the main project; null when it cannot be read. Thread-safe, as are the following.
  std::shared_ptr<const survey::Survey> survey() const;
  // Reads the project again after a new merge, surface or evaluation. Called by the engine when scene.h5, surface.json or metrics.json changed.
  void Reload();
  // Publishes a picture; keeps the newest 8. Returns "pictures/<n>.png".
  std::string AddPicture(std::string png);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::viewer
