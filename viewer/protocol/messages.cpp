#include "viewer/protocol/messages.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/base/checked_json.h"
#include "core/base/json_object.h"

namespace skyquilt::viewer {
namespace {

constexpr double kLengthTolerance = 1e-3;  // of a rotation's quaternion
constexpr double kShortestDirection = 1e-6;
constexpr int kMaxMessageDepth = 4;

uint32_t U32(base::JsonObject& fields, const char* key) {
  return static_cast<uint32_t>(fields.Integer(key, 0, std::numeric_limits<uint32_t>::max()));
}

Which ProjectOf(base::JsonObject& fields) {
  return fields.OneOf("project", {"main", "before"}) == 0 ? Which::kMain : Which::kBefore;
}

template <int kN>
Eigen::Matrix<double, kN, 1> Coordinates(base::JsonObject& fields, const char* key) {
  Eigen::Matrix<double, kN, 1> x;
  fields.Numbers(key, kMaxCoordinateM, {x.data(), static_cast<size_t>(kN)});
  return x;
}

Hello ReadHello(base::JsonObject& fields) {
  return {.version = static_cast<int>(fields.Integer("version", 0, std::numeric_limits<int>::max()))};
}

ViewRequest ReadView(base::JsonObject& fields) {
  ViewRequest view;
  view.seq = U32(fields, "seq");
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

FrameAck ReadAck(base::JsonObject& fields) {
  return {.seq = U32(fields, "seq"), .pass = static_cast<int>(fields.Integer("pass", 0, 255))};
}

PickRequest ReadPick(base::JsonObject& fields) {
  PickRequest pick;
  pick.id = U32(fields, "id");
  pick.project = ProjectOf(fields);
  pick.origin_enu = Coordinates<3>(fields, "origin");
  pick.direction_enu = Coordinates<3>(fields, "direction");
  if (!(pick.direction_enu.norm() > kShortestDirection)) fields.Refuse("direction", "must have a length");
  pick.direction_enu.normalize();
  pick.pixel_pitch = fields.Number("pixel_pitch", 0.0, 1.0);
  pick.pixel_width_m = fields.Number("pixel_width_m", 0.0, 1e4);
  return pick;
}

PhotosAtRequest ReadPhotosAt(base::JsonObject& fields) {
  return {.id = U32(fields, "id"), .point_enu = Coordinates<3>(fields, "point")};
}

ProfileRequest ReadProfile(base::JsonObject& fields) {
  ProfileRequest profile;
  profile.id = U32(fields, "id");
  profile.project = ProjectOf(fields);
  profile.from_enu = Coordinates<2>(fields, "from");
  profile.to_enu = Coordinates<2>(fields, "to");
  if (profile.from_enu == profile.to_enu) fields.Refuse("to", "must be another place than \"from\"");
  profile.samples = static_cast<int>(fields.Integer("samples", 2, kMaxProfileSamples));
  return profile;
}

VolumeRequest ReadVolume(base::JsonObject& fields) {
  VolumeRequest volume;
  volume.id = U32(fields, "id");
  volume.project = ProjectOf(fields);
  for (const auto& [x, y] : fields.Pairs("polygon", 3, kMaxPolygonCorners, kMaxCoordinateM)) volume.polygon_enu.emplace_back(x, y);
  if (!IsSimplePolygon(volume.polygon_enu)) fields.Refuse("polygon", "its edges must not cross or touch each other, and it must have an area");
  // In the order of VolumeBase.
  volume.base = static_cast<VolumeBase>(fields.OneOf("base", {"plane", "lowest", "height", "before"}));
  if (volume.base == VolumeBase::kHeight || fields.Has("base_height_m")) {
    volume.base_height_m = fields.Number("base_height_m", -kMaxCoordinateM, kMaxCoordinateM);
  }
  return volume;
}

std::string TypeOf(base::JsonObject& fields) {
  const auto type = fields.Find("type");
  if (!type || !type->json().is_string()) throw BadMessage("type: must be a text");
  return type->json().get<std::string>();
}

ClientMessage ReadMessage(const std::string& type, base::JsonObject& fields) {
  if (type == "hello") return ReadHello(fields);
  if (type == "view") return ReadView(fields);
  if (type == "stop") return StopView{.seq = U32(fields, "seq")};
  if (type == "ack") return ReadAck(fields);
  if (type == "pick") return ReadPick(fields);
  if (type == "photos_at") return ReadPhotosAt(fields);
  if (type == "profile") return ReadProfile(fields);
  if (type == "volume") return ReadVolume(fields);
  if (type == "trust_map") return TrustMapRequest{.id = U32(fields, "id")};
  if (type == "error_map") return ErrorMapRequest{.id = U32(fields, "id")};
  if (type == "cancel") return CancelRequest{.id = U32(fields, "id")};
  throw BadMessage("type: \"" + base::ShownStart(type) + "\" is not known");
}

}  // namespace

ClientMessage ParseClientMessage(std::string_view text) {
  if (text.size() > kMaxMessageBytes) throw BadMessage("a message has at most " + std::to_string(kMaxMessageBytes) + " bytes");
  if (base::NestingOf(text) > kMaxMessageDepth) {
    throw BadMessage("a message has at most " + std::to_string(kMaxMessageDepth) + " levels of brackets");
  }
  std::string type;
  try {
    const nlohmann::json document = base::ParseDocument(text, base::RepeatedKeys::kRefused);
    base::JsonObject fields{base::JsonValue(document)};
    type = TypeOf(fields);
    ClientMessage message = ReadMessage(type, fields);
    for (const std::string& key : fields.Rest()) throw BadMessage(type + ": the key \"" + base::ShownStart(key) + "\" is not allowed here");
    return message;
  } catch (const BadMessage&) {
    throw;
  } catch (const base::Refused& refused) {
    throw BadMessage(refused.place().empty() ? std::string("the message cannot be read: ") + refused.what()
                                             : type + "." + refused.place() + ": " + refused.rule());
  } catch (const std::exception&) {
    throw BadMessage("the message cannot be read");
  }
}

}  // namespace skyquilt::viewer
