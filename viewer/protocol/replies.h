// Texts that the server sends to a browser: JSON objects with a "type". docs/viewer_protocol.md describes them. Numbers that are not finite become
// null; text is always valid UTF-8.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::viewer {

struct EngineState {
  bool ready = false;     // false: no exact frames
  std::string reason;     // why not, and which command helps
  uint32_t revision = 0;  // grows with every scene that is loaded
  std::string exposure;   // as `render --exposure`
  int clients = 0;
  int ranks = 1;
};
// {"type":"welcome","version":1,"client":7,"engine":{"ready":..,"reason":..,"revision":..,"exposure":..,"clients":..,"ranks":..}}
std::string WelcomeText(uint64_t client, const EngineState& state);
// {"type":"engine","engine":{...}}: sent when it changes.
std::string EngineText(const EngineState& state);
// {"type":"error","message":"..."} with "id" when a request failed.
std::string ErrorText(std::string_view message, std::optional<uint32_t> id = {});
// {"type":"progress","id":..,"fraction":0..1}
std::string ProgressText(uint32_t id, double fraction);

// A point of the surface, found by a ray.
struct SurfacePoint {
  bool hit = false;  // the transmittance falls below one half
  Eigen::Vector3d point_enu = Eigen::Vector3d::Zero();
  double depth_m = 0.0;   // along the ray
  double spread_m = 0.0;  // one standard deviation of the depth along the ray, from the depths where the transmittance falls below .85 and .15
  double opacity = 0.0;
};
// {"type":"picked","id":..,"hit":..,"point":[x,y,z],"depth_m":..,"spread_m":..,"opacity":..}
std::string PickedText(uint32_t id, const SurfacePoint& point);

struct PhotoSight {
  int photo = 0;                                    // index into the survey's photos
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the full photo, (0, 0) is the outer corner of the upper left pixel
  double distance_m = 0.0;
  double gsd_m = 0.0;    // metres per pixel of the photo there
  bool visible = false;  // nothing stands between photo and point
};
// {"type":"photos","id":..,"checked":bool,"photos":[{"photo":..,"pixel":[x,y],"distance_m":..,"gsd_m":..,"visible":..}]}: finest first.
// checked: false when there is no field to test for what stands between; then visible is true for all.
std::string PhotosText(uint32_t id, bool checked, const std::vector<PhotoSight>& photos);

// {"type":"profile","id":..,"length_m":..,"heights_m":[..or null],"spreads_m":[..or null]}: samples evenly from `from` to `to`, both included.
std::string ProfileText(uint32_t id, double length_m, const std::vector<double>& heights_m, const std::vector<double>& spreads_m);

struct VolumeResult {
  double cell_m = 0.0;                 // of the grid that was measured
  int64_t cells = 0;                   // inside the polygon
  double filled = 0.0;                 // their share with a surface, 0 to 1
  double plan_area_m2 = 0.0;           // of the polygon
  double surface_area_m2 = 0.0;        // of the measured surface, scaled up by 1 / filled
  double cut_m3 = 0.0, fill_m3 = 0.0;  // above the base, below it; both positive
  double net_m3 = 0.0;                 // cut - fill
  double sigma_m3 = 0.0;               // one standard deviation of net from the spread of the depths; without the geo-reference
  double base_mean_m = 0.0;            // mean height of the base
};
// {"type":"volume","id":..,...the members above...}
std::string VolumeText(uint32_t id, const VolumeResult& result);

struct ErrorMapResult {
  std::string url;  // below /data/
  Eigen::Vector2d min_enu = Eigen::Vector2d::Zero(), max_enu = Eigen::Vector2d::Zero();
  double scale = 0.0;  // mean absolute difference of display values (0 to 1) that has the last colour of the ramp
  int photos = 0;      // that it was made from
  int of_photos = 0;   // held out
};
// {"type":"trust_map","id":..,"url":..,"min":[x,y],"max":[x,y],"scale":..}
struct TrustMapResult {
  std::string url;  // below /data/
  Eigen::Vector2d min_enu = Eigen::Vector2d::Zero(), max_enu = Eigen::Vector2d::Zero();
  double scale = 0.0;  // error to expect (trust::TrustPicture) that has the last colour of the ramp
};
std::string TrustMapText(uint32_t id, const TrustMapResult& result);
// {"type":"error_map","id":..,"url":..,"min":[x,y],"max":[x,y],"scale":..,"photos":..,"of_photos":..}
std::string ErrorMapText(uint32_t id, const ErrorMapResult& result);

}  // namespace skyquilt::viewer
