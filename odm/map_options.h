// From OpenDroneMap's options to ours.
#pragma once

#include "coordinator/project/settings.h"
#include "odm/dataset.h"
#include "odm/quality.h"
#include "odm/request.h"

namespace skyquilt::odm {

// What the request asks for beside the settings.
struct Wishes {
  bool orthophoto = true, dsm = false, dtm = false;
  bool mesh = true;       // textured, OBJ
  bool glb = false;       // and glTF
  bool cloud = true;      // LAS
  bool ept = false;       //
  bool tiles_3d = false;  //
  bool classes = false;   // of points, by buildings
  bool report = true;     //
  bool png = false;       // of the orthophoto
  bool cutline = false;   //
  // Whether the surface has to be made.
  bool Surface() const { return mesh || cloud || dtm || tiles_3d || classes; }
};
Wishes WishesOf(const Request& request);

// Changes `settings`, which hold defaults and the effort's preset, as the request says. boundary: from ProvideBoundary. training_s: of
// --skyquilt-time-budget or of the effort. Resolution and automatic boundary come later, when the poses are known (odm/after_poses.h).
void ApplyRequest(const Request& request, const Dataset& dataset, const Effort& effort, double training_s, const std::string& boundary,
                  coordinator::Settings* settings);

}  // namespace skyquilt::odm
