// A valid text of every message that a browser sends.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::viewer {

inline const std::string kViewSample =
    R"({"type":"view","seq":7,"project":"main","eye":[1.5,-2,300],"rotation":[0,1,0,0],"projection":"perspective","fovy_deg":45,"w":1000,"h":563})";
inline const std::string kVolumeSample =
    R"({"type":"volume","id":5,"project":"main","polygon":[[0,0],[10,0],[10,8.5]],"base":"height","base_height_m":-3.25})";

inline std::vector<std::string> SampleMessages() {
  return {R"({"type":"hello","version":1})",
          kViewSample,
          R"({"type":"view","seq":8,"project":"before","eye":[0,0,9e6],"rotation":[0.5,0.5,-0.5,0.5],"projection":"orthographic","height_m":80.5,)"
          R"("w":16,"h":2048})",
          R"({"type":"view","seq":4294967295,"photo":12,"w":640})",
          R"({"type":"stop","seq":7})",
          R"({"type":"ack","seq":7,"pass":2})",
          R"({"type":"pick","id":3,"project":"main","origin":[0,0,100],"direction":[0,3,-4],"pixel_pitch":0.001,"pixel_width_m":0})",
          R"({"type":"photos_at","id":4,"point":[10,20,1.25]})",
          R"({"type":"profile","id":9,"project":"before","from":[0,0],"to":[30,40],"samples":256})",
          kVolumeSample,
          R"({"type":"volume","id":6,"project":"main","polygon":[[0,0],[10,0],[10,8.5]],"base":"before"})",
          R"({"type":"error_map","id":10})",
          R"({"type":"trust_map","id":11})",
          R"({"type":"cancel","id":10})"};
}

// The text with its first `what` replaced.
inline std::string With(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  return at == std::string::npos ? "the sample has no " + what : text.replace(at, what.size(), by);
}

}  // namespace skyquilt::viewer
