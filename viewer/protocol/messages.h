// Messages that a browser sends to the viewer's WebSocket, as typed values. docs/viewer_protocol.md describes both directions.
// Everything a client sends is untrusted: ParseClientMessage checks types, ranges, lengths and finiteness, and refuses unknown types and keys.
// Frame: ENU of the main project, metres. Rotations are cam_from_enu with COLMAP's camera axes (x right, y down, z ahead).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace skyquilt::viewer {

constexpr int kProtocolVersion = 1;
constexpr size_t kMaxMessageBytes = 4096;              // of a client's message
constexpr double kMaxCoordinateM = 1e7;                // of anything that a client sends
constexpr int kMinViewSize = 16, kMaxViewSize = 2048;  // pixels
constexpr int kMaxProfileSamples = 1024;
constexpr int kMaxPolygonCorners = 64;

// The survey that is shown, or the earlier one of `view --compare`.
enum class Which : uint8_t { kMain, kBefore };

// First message of every connection.
struct Hello {
  int version = 0;
};

// The camera rests: render this view in passes, replacing the client's former view.
struct ViewRequest {
  uint32_t seq = 0;  // chosen by the client, larger than before; comes back in the frames
  Which project = Which::kMain;
  Eigen::Vector3d eye_enu = Eigen::Vector3d::Zero();
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();  // length 1
  bool orthographic = false;
  double fovy_deg = 60.0;      // perspective: vertical field of view, 1 to 150
  double view_height_m = 0.0;  // orthographic: height of the picture in the scene, 0.01 to 1e6
  int width = 0, height = 0;   // pixels of the last pass
  int photo = -1;              // index into the survey's photos: its camera and pose instead of the above; `height` follows from its aspect ratio
};

// The camera moves again: stop rendering views up to this seq.
struct StopView {
  uint32_t seq = 0;
};

// A frame was decoded; at most two may be unacknowledged.
struct FrameAck {
  uint32_t seq = 0;
  int pass = 0;
};

// What the field shows along a ray.
struct PickRequest {
  uint32_t id = 0;
  Which project = Which::kMain;
  Eigen::Vector3d origin_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_enu = Eigen::Vector3d::UnitZ();  // normalised by the parser
  double pixel_pitch = 0.0;                                  // radians per pixel, 0 to 1
  double pixel_width_m = 0.0;                                // orthographic views, 0 to 1e4
};

// Which photos see this point.
struct PhotosAtRequest {
  uint32_t id = 0;
  Eigen::Vector3d point_enu = Eigen::Vector3d::Zero();
};

// Heights along a line on the ground.
struct ProfileRequest {
  uint32_t id = 0;
  Which project = Which::kMain;
  Eigen::Vector2d from_enu = Eigen::Vector2d::Zero(), to_enu = Eigen::Vector2d::Zero();
  int samples = 0;  // 2 to kMaxProfileSamples
};

// The surface that a volume is measured against.
enum class VolumeBase : uint8_t {
  kPlane,   // fitted through the surface at the polygon's corners
  kLowest,  // horizontal, through the lowest corner
  kHeight,  // horizontal at base_height_m (z of ENU)
  kBefore,  // the surface of the earlier survey
};

struct VolumeRequest {
  uint32_t id = 0;
  Which project = Which::kMain;
  std::vector<Eigen::Vector2d> polygon_enu;  // 3 to kMaxPolygonCorners corners, either direction; not closed; may not cross itself
  VolumeBase base = VolumeBase::kPlane;
  double base_height_m = 0.0;
};

// The error of the held-out photos, as a map.
struct TrustMapRequest {
  uint32_t id = 0;
};
struct ErrorMapRequest {
  uint32_t id = 0;
};

// Forget the request with this id.
struct CancelRequest {
  uint32_t id = 0;
};

using ClientMessage = std::variant<Hello, ViewRequest, StopView, FrameAck, PickRequest, PhotosAtRequest, ProfileRequest, VolumeRequest,
                                   ErrorMapRequest, TrustMapRequest, CancelRequest>;

// A message that is not allowed; what() names the field and the allowed values, and never repeats more than 40 characters of the client's text.
class BadMessage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Throws BadMessage; no other exception, whatever the bytes.
ClientMessage ParseClientMessage(std::string_view text);

// The polygon's edges do not cross or touch each other apart from their shared corners, and it has an area.
bool IsSimplePolygon(const std::vector<Eigen::Vector2d>& polygon);

}  // namespace skyquilt::viewer
