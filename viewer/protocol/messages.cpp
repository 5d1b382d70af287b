#include "viewer/protocol/messages.h"

#include <array>
#include <cmath>
#include <limits>

#include "viewer/protocol/json_fields.h"

namespace skyquilt::viewer {
namespace {

constexpr double kLengthTolerance = 1e-3;  // of a rotation's quaternion
constexpr double kShortestDirection = 1e-6;

Which ProjectOf(JsonFields& fields) {
  return fields.OneOf("project", {"main", "before"}) == 0 ? Which::kMain : Which::kBefore;
}

template <int kN>
Eigen::Matrix<double, kN, 1> Coordinates(JsonFields& fields, const char* key) {
  Eigen::Matrix<double, kN, 1> x;
  fields.Numbers(key, kMaxCoordinateM, {x.data(), static_cast<size_t>(kN)});
  return x;
}

Hello ReadHello(JsonFields& fields) {
  return {.version = static_cast<int>(fields.Integer("version", 0, std::numeric_limits<int>::max()))};
}

ViewRequest ReadView(JsonFields& fields) {
  ViewRequest view;
  view.seq = fields.U32("seq");
  view.width = static_cast<int>(fields.Integer("w", kMinViewSize, kMaxViewSize));
  if (fields.Has("photo")) {
    view.photo = static_cast<int>(fields.Integer("photo", 0, std::numeric_limits<int>::max()));
    return view;
  }
  view.height = static_cast<int>(fields.Integer("h", kMinViewSize, kMaxViewSize));
  view.project = ProjectOf(fields);
  view.eye_enu = Coordinates<3>(fields, "eye");
  std::array<double, 4> wxyz{};
  fields.Numbers("rotation", 1.0 + kLengthTolerance, wxyz);
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (std::abs(rotation.norm() - 1.0) > kLengthTolerance) fields.Refuse("rotation", "must be a quaternion w, x, y, z of length 1");
  view.cam_from_enu = rotation.normalized();
  view.orthographic = fields.OneOf("projection", {"perspective", "orthographic"}) == 1;
  if (view.orthographic) {
    view.view_height_m = fields.Number("height_m", 0.01, 1e6);
  } else {
    view.fovy_deg = fields.Number("fovy_deg", 1.0, 150.0);
  }
  return view;
}

FrameAck ReadAck(JsonFields& fields) {
  return {.seq = fields.U32("seq"), .pass = static_cast<int>(fields.Integer("pass", 0, 255))};
}

PickRequest ReadPick(JsonFields& fields) {
  PickRequest pick;
  pick.id = fields.U32("id");
  pick.project = ProjectOf(fields);
  pick.origin_enu = Coordinates<3>(fields, "origin");
  pick.direction_enu = Coordinates<3>(fields, "direction");
  if (!(pick.direction_enu.norm() > kShortestDirection)) fields.Refuse("direction", "must have a length");
  pick.direction_enu.normalize();
  pick.pixel_pitch = fields.Number("pixel_pitch", 0.0, 1.0);
  pick.pixel_width_m = fields.Number("pixel_width_m", 0.0, 1e4);
  return pick;
}

PhotosAtRequest ReadPhotosAt(JsonFields& fields) {
  return {.id = fields.U32("id"), .point_enu = Coordinates<3>(fields, "point")};
}

ProfileRequest ReadProfile(JsonFields& fields) {
  ProfileRequest profile;
  profile.id = fields.U32("id");
  profile.project = ProjectOf(fields);
  profile.from_enu = Coordinates<2>(fields, "from");
  profile.to_enu = Coordinates<2>(fields, "to");
  if (profile.from_enu == profile.to_enu) fields.Refuse("to", "must be another place than \"from\"");
  profile.samples = static_cast<int>(fields.Integer("samples", 2, kMaxProfileSamples));
  return profile;
}

VolumeRequest ReadVolume(JsonFields& fields) {
  VolumeRequest volume;
  volume.id = fields.U32("id");
  volume.project = ProjectOf(fields);
  volume.polygon_enu = fields.Points("polygon", 3, kMaxPolygonCorners, kMaxCoordinateM);
  if (!IsSimplePolygon(volume.polygon_enu)) fields.Refuse("polygon", "its edges must not cross or touch each other, and it must have an area");
  // In the order of VolumeBase.
  volume.base = static_cast<VolumeBase>(fields.OneOf("base", {"plane", "lowest", "height", "before"}));
  if (volume.base == VolumeBase::kHeight || fields.Has("base_height_m")) {
    volume.base_height_m = fields.Number("base_height_m", -kMaxCoordinateM, kMaxCoordinateM);
  }
  return volume;
}

ClientMessage ReadMessage(JsonFields& fields) {
  const std::string type = fields.Text("type");
  if (type == "hello") return ReadHello(fields);
  if (type == "view") return ReadView(fields);
  if (type == "stop") return StopView{.seq = fields.U32("seq")};
  if (type == "ack") return ReadAck(fields);
  if (type == "pick") return ReadPick(fields);
  if (type == "photos_at") return ReadPhotosAt(fields);
  if (type == "profile") return ReadProfile(fields);
  if (type == "volume") return ReadVolume(fields);
  if (type == "error_map") return ErrorMapRequest{.id = fields.U32("id")};
  if (type == "cancel") return CancelRequest{.id = fields.U32("id")};
  throw BadMessage("type: " + Quoted(type) + " is not known");
}

}  // namespace

ClientMessage ParseClientMessage(std::string_view text) {
  try {
    JsonFields fields(text, kMaxMessageBytes);
    ClientMessage message = ReadMessage(fields);
    fields.RefuseOthers();
    return message;
  } catch (const BadMessage&) {
    throw;
  } catch (const std::exception&) {
    throw BadMessage("the message cannot be read");
  }
}

}  // namespace skyquilt::viewer
