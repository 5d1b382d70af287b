// A tour in which every kind of member occurs, and a way to spoil it.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/json_text.h"

namespace skyquilt::tour {

inline const std::string kSamplePicture = std::string(64, 'a') + ".jpg", kSampleModel = std::string(64, 'b') + ".glb";

inline nlohmann::json SampleTour() {
  nlohmann::json json = base::ParseJson(R"({
    "version": 1, "title": "Der Hof, 農場, <script>alert(1)</script>", "start": "gate",
    "stops": [
      {"id": "gate", "title": "The gate \"1\"", "text": "Line 1\nLine 2 <b>&amp;</b>", "picture": null,
       "link": {"label": "More", "url": "https://example.org/a?b=c#d"},
       "pose": {"eye_enu": [1.25, -2, 30.1], "rotation": [0.5, -0.5, 0.5, -0.5], "fovy_deg": 60},
       "exposure_stops": -1.5, "layers": {"surface": true, "errorMap": false}, "measurements": ["m1", "ridge 2"], "pause_s": 8,
       "next": {"to": null, "path": {"kind": "orbit", "about": [0, 0, 5]}},
       "branches": [{"to": "roof", "label": "To the roof", "path": {"kind": "over"}}]},
      {"id": "roof", "title": "The roof", "text": "", "picture": null, "link": null,
       "pose": {"eye_enu": [5, 6, 7], "rotation": [1, 0, 0, 0], "fovy_deg": 10},
       "exposure_stops": null, "layers": null, "measurements": [], "pause_s": 0,
       "next": {"to": "gate", "path": {"kind": "jump"}}, "branches": []},
      {"id": "end", "title": "End", "text": "", "picture": null, "link": null,
       "pose": {"eye_enu": [5, 6, 7], "rotation": [1, 0, 0, 0], "fovy_deg": 120},
       "exposure_stops": 0, "layers": {}, "measurements": [], "pause_s": 600, "next": null, "branches": []}],
    "things": [
      {"id": "l1", "kind": "label", "at": [1, 2, 3], "text": "A <i>label</i>", "stops": null},
      {"id": "m1", "kind": "marker", "at": [1, 2, 3], "text": "Up", "to": "roof", "stops": ["gate"]},
      {"id": "m2", "kind": "marker", "at": [1, 2, 3], "text": "Here", "to": null, "stops": []},
      {"id": "shed", "kind": "model", "at": [1, 2, 3], "yaw_deg": -360, "scale": 0.001, "name": "Shed", "asset": "", "stops": ["gate", "end"]}],
    "assets": {}})");
  json["stops"][0]["picture"] = kSamplePicture;
  json["things"][3]["asset"] = kSampleModel;
  json["assets"][kSamplePicture] = {{"name", "house & garden.JPG"}, {"bytes", 1234}};
  json["assets"][kSampleModel] = {{"name", "shed.glb"}, {"bytes", 77}};
  return json;
}

inline std::string SampleTourWith(const std::function<void(nlohmann::json&)>& change) {
  nlohmann::json json = SampleTour();
  change(json);
  return base::JsonText(json);
}

}  // namespace skyquilt::tour
