#include "tests/prepare/models/made_models.h"

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "core/base/json_text.h"
#include "core/geo/ecef.h"

namespace skyquilt::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kChunkScale = 10.0;

// Columns right, up, back: OpenGL's camera and photogrammetry's image.
Matrix3d RightUpBack(const Matrix3d& axes) {
  Matrix3d turned = axes;
  turned.col(1) *= -1.0;
  turned.col(2) *= -1.0;
  return turned;
}

json Rows(const Matrix3d& rotation, const Vector3d& position) {
  json rows = json::array();
  for (int row = 0; row < 3; ++row) rows.push_back({rotation(row, 0), rotation(row, 1), rotation(row, 2), position[row]});
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

json List(const Vector3d& x) {
  return {x.x(), x.y(), x.z()};
}

template <typename T>
void Append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string Text(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

// x and y after division by depth, distorted as Brown wrote it: radial, and tangential with P_x along x.
struct Distorted {
  double x, y;
};
Distorted Brown(double x, double y, const MadeLens& lens, double along_x, double along_y) {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + lens.k1 * r2 + lens.k2 * r2 * r2 + lens.k3 * r2 * r2 * r2;
  return {x * radial + along_x * (r2 + 2.0 * x * x) + 2.0 * along_y * x * y, y * radial + along_y * (r2 + 2.0 * y * y) + 2.0 * along_x * x * y};
}

}  // namespace

Matrix3d MetashapeTurn() {
  return Eigen::AngleAxisd(0.8, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
}

MadeModel MakeModel() {
  MadeModel survey;
  for (int i = 0; i < 3; ++i) {
    const Matrix3d down = (Matrix3d() << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0).finished();  // north is up in the image
    const Matrix3d tilt = Eigen::AngleAxisd(0.2 * i - 0.1, Vector3d(0.3, 1.0, 0.2).normalized()).toRotationMatrix();
    const Matrix3d yaw = Eigen::AngleAxisd(1.3 * i + 0.4, Vector3d::UnitZ()).toRotationMatrix();
    survey.photos.push_back({"DJI_000" + std::to_string(i + 1) + ".png", yaw * tilt * down, Vector3d(6.0 * i - 5.0, 4.0 - 3.0 * i, 52.0 + i)});
  }
  for (int i = 0; i < 6; ++i) survey.points.emplace_back(5.0 * (i % 3) - 5.0, 4.0 * (i / 3) - 2.0, 0.7 * i);
  return survey;
}

void WriteFiles(const Files& files, const std::filesystem::path& folder) {
  for (const auto& [name, content] : files) std::ofstream(folder / name, std::ios::binary) << content;
}

Files TransformsFiles(const MadeModel& survey) {
  const MadeLens& lens = survey.lens;
  json file = {{"camera_model", "OPENCV"},
               {"fl_x", lens.fx},
               {"fl_y", lens.fy},
               {"cx", lens.cx},
               {"cy", lens.cy},
               {"w", lens.width},
               {"h", lens.height},
               {"k1", lens.k1},
               {"k2", lens.k2},
               {"k3", lens.k3},
               {"p1", lens.p1},
               {"p2", lens.p2},
               {"ply_file_path", "points.ply"}};
  for (const MadePhoto& photo : survey.photos) {
    file["frames"].push_back({{"file_path", "images/" + photo.name}, {"transform_matrix", Rows(RightUpBack(photo.axes), photo.centre)}});
  }
  std::string ply =
      "ply\nformat ascii 1.0\ncomment made\nelement vertex " + std::to_string(survey.points.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (const Vector3d& x : survey.points) ply += Text(x.x()) + " " + Text(x.y()) + " " + Text(x.z()) + " 10 20 30\n";
  return {{"transforms.json", base::JsonText(file, 1)}, {"points.ply", ply}};
}

Files BlenderFiles(const MadeModel& survey) {
  json train = {{"camera_angle_x", 2.0 * std::atan(0.5 * survey.lens.width / survey.lens.fx)}};
  json test = train;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const MadePhoto& photo = survey.photos[i];
    const std::string stem = "./" + photo.name.substr(0, photo.name.find('.'));
    json& part = i + 1 < survey.photos.size() ? train : test;
    part["frames"].push_back({{"file_path", stem}, {"rotation", 0.01}, {"transform_matrix", Rows(RightUpBack(photo.axes), photo.centre)}});
  }
  return {{"transforms_train.json", base::JsonText(train, 1)}, {"transforms_test.json", base::JsonText(test, 1)}};
}

Files OpensfmFiles(const MadeModel& survey) {
  const MadeLens& lens = survey.lens;
  const double unit = std::max(lens.width, lens.height);
  json reconstruction;
  reconstruction["cameras"]["v2 made"] = {{"projection_type", "brown"},
                                          {"width", lens.width},
                                          {"height", lens.height},
                                          {"focal_x", lens.fx / unit},
                                          {"focal_y", lens.fy / unit},
                                          {"c_x", (lens.cx - 0.5 * lens.width) / unit},
                                          {"c_y", (lens.cy - 0.5 * lens.height) / unit},
                                          {"k1", lens.k1},
                                          {"k2", lens.k2},
                                          {"p1", lens.p1},
                                          {"p2", lens.p2},
                                          {"k3", lens.k3}};
  std::string tracks = "OPENSFM_TRACKS_VERSION_v2\n";
  for (const MadePhoto& photo : survey.photos) {
    const Matrix3d cam_from_world = photo.axes.transpose();
    const Eigen::AngleAxisd turn(cam_from_world);
    reconstruction["shots"][photo.name] = {{"rotation", List(turn.angle() * turn.axis())},
                                           {"translation", List(-cam_from_world * photo.centre)},
                                           {"camera", "v2 made"},
                                           {"gps_position", {0.0, 0.0, 0.0}}};
    for (size_t i = 0; i < survey.points.size(); ++i) tracks += photo.name + "\t" + std::to_string(i) + "\t7\t0.1\t0.2\t0.001\t10\t20\t30\t-1\t-1\n";
  }
  for (size_t i = 0; i < survey.points.size(); ++i) {
    reconstruction["points"][std::to_string(i)] = {{"color", {10.0, 20.0, 30.0}}, {"coordinates", List(survey.points[i])}};
  }
  const json lla = {{"latitude", kModelOrigin.latitude_deg}, {"longitude", kModelOrigin.longitude_deg}, {"altitude", kModelOrigin.height_m}};
  return {
      {"reconstruction.json", base::JsonText(json::array({reconstruction}), 1)}, {"reference_lla.json", base::JsonText(lla)}, {"tracks.csv", tracks}};
}

Files MetashapeFiles(const MadeModel& survey) {
  const MadeLens& lens = survey.lens;
  const auto element = [](const std::string& name, double value) { return "<" + name + ">" + Text(value) + "</" + name + ">\n"; };
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"2.0.0\">\n<chunk label=\"Chunk 1\" enabled=\"true\">\n<sensors>\n";
  xml += "<sensor id=\"0\" label=\"made\" type=\"frame\">\n<resolution width=\"640\" height=\"480\"/>\n";
  xml += "<calibration type=\"frame\" class=\"initial\">\n<resolution width=\"640\" height=\"480\"/>\n<f>400</f>\n</calibration>\n";
  xml += "<calibration type=\"frame\" class=\"adjusted\">\n<resolution width=\"" + std::to_string(lens.width) + "\" height=\"" +
         std::to_string(lens.height) + "\"/>\n";
  xml += element("f", lens.fy) + element("cx", lens.cx - 0.5 * lens.width) + element("cy", lens.cy - 0.5 * lens.height) +
         element("b1", lens.fx - lens.fy) + element("k1", lens.k1) + element("k2", lens.k2) + element("k3", lens.k3) + element("p1", lens.p2) +
         element("p2", lens.p1);
  xml += "</calibration>\n</sensor>\n</sensors>\n<components>\n<component id=\"0\" active=\"true\">\n<transform>\n<rotation>";
  // ecef_from_chunk = ecef_from_enu * (10 turn).
  const Eigen::Matrix4d ecef_from_enu = geo::EcefFromEnu(kModelOrigin);
  const Matrix3d rotation = ecef_from_enu.topLeftCorner<3, 3>() * MetashapeTurn();
  for (int i = 0; i < 9; ++i) xml += Text(rotation(i / 3, i % 3)) + " ";
  xml += "</rotation>\n<translation>";
  for (int i = 0; i < 3; ++i) xml += Text(ecef_from_enu(i, 3)) + " ";
  xml += "</translation>\n<scale>" + Text(kChunkScale) + "</scale>\n</transform>\n</component>\n</components>\n<cameras>\n";
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const MadePhoto& photo = survey.photos[i];
    const Matrix3d axes = MetashapeTurn().transpose() * photo.axes;
    const Vector3d centre = MetashapeTurn().transpose() * photo.centre / kChunkScale;
    xml += "<camera id=\"" + std::to_string(i) + "\" sensor_id=\"0\" component_id=\"0\" label=\"" + photo.name.substr(0, photo.name.find('.')) +
           "\">\n<transform>";
    for (int row = 0; row < 3; ++row) xml += Text(axes(row, 0)) + " " + Text(axes(row, 1)) + " " + Text(axes(row, 2)) + " " + Text(centre[row]) + " ";
    xml += "0 0 0 1</transform>\n</camera>\n";
  }
  xml += "<camera id=\"9\" sensor_id=\"0\" label=\"not_aligned\"/>\n</cameras>\n";
  xml += "<reference>GEOGCS[\"WGS 84\",DATUM[\"World Geodetic System 1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]]]</reference>\n";
  return {{"cameras.xml", xml + "</chunk>\n</document>\n"}};
}

Files OpfFiles(const MadeModel& survey) {
  const MadeLens& lens = survey.lens;
  const auto resource = [](const char* type, std::vector<std::pair<const char*, const char*>> files) {
    json item = {{"id", type}, {"type", type}, {"sources", json::array()}};
    for (const auto& [uri, format] : files) item["resources"].push_back({{"uri", uri}, {"format", format}});
    return item;
  };
  const json project = {
      {"format", "application/opf-project+json"},
      {"version", "1.0"},
      {"items",
       {resource("camera_list", {{"cameras.json", "application/opf-camera-list+json"}}),
        resource("input_cameras", {{"input.json", "application/opf-input-cameras+json"}}),
        resource("scene_reference_frame", {{"frame.json", "application/opf-scene-reference-frame+json"}}),
        resource("calibration", {{"calibrated.json", "application/opf-calibrated-cameras+json"}, {"tracks.gltf", "model/gltf+json"}})}}};
  json list, calibrated;
  json input;
  input["sensors"].push_back({{"id", 77}, {"image_size_px", {lens.width, lens.height}}});
  calibrated["sensors"].push_back({{"id", 77},
                                   {"internals",
                                    {{"type", "perspective"},
                                     {"principal_point_px", {lens.cx, lens.cy}},
                                     {"focal_length_px", lens.fy},
                                     {"radial_distortion", {lens.k1, lens.k2, lens.k3}},
                                     {"tangential_distortion", {lens.p1, lens.p2}}}}});
  constexpr uint64_t kFirstId = 9843086184167632639ULL;  // as large as the hashes that Pix4D writes
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const MadePhoto& photo = survey.photos[i];
    const Matrix3d r = RightUpBack(photo.axes);
    list["cameras"].push_back({{"id", kFirstId + i}, {"uri", "file:///c:/flight/" + photo.name}});
    calibrated["cameras"].push_back(
        {{"id", kFirstId + i},
         {"sensor_id", 77},
         {"position", List(photo.centre)},
         {"orientation_deg", {std::atan2(-r(1, 2), r(2, 2)) / kDegree, std::asin(r(0, 2)) / kDegree, std::atan2(-r(0, 1), r(0, 0)) / kDegree}}});
  }
  const json frame = {{"crs", {{"definition", "EPSG:32632"}}},
                      {"base_to_canonical", {{"shift", List(kOpfShift)}, {"scale", {1.0, 1.0, 1.0}}, {"swap_xy", false}}}};
  // Positions with z up; the node turns them to glTF's y up. Every point is seen by all photos.
  std::string positions, colors, camera_ids, ranges;
  const size_t n = survey.photos.size();
  for (size_t i = 0; i < survey.points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) Append(positions, static_cast<float>(survey.points[i][axis]));
    for (const int c : {10, 20, 30, 255}) Append(colors, static_cast<uint8_t>(c));
    for (size_t k = 0; k < n; ++k) Append(camera_ids, static_cast<uint32_t>(k));
    Append(ranges, static_cast<uint64_t>(n * i) | (static_cast<uint64_t>(n) << 40U));
  }
  json uids = json::array();
  for (size_t i = 0; i < n; ++i) uids.push_back(kFirstId + i);
  const auto accessor = [](int view, int component, size_t count, const char* type) {
    return json{{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
  };
  const auto view = [](int buffer, size_t offset, size_t length) { return json{{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}}; };
  json primitive = {{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"mode", 0}};
  primitive["extensions"]["OPF_mesh_primitive_matches"] = {{"cameraIds", 2}, {"pointIndexRanges", 3}, {"cameraUids", uids}};
  const json gltf = {{"asset", {{"version", "2.0"}}},
                     {"scene", 0},
                     {"scenes", json::array({{{"nodes", json::array({0})}}})},
                     {"nodes", json::array({{{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}}}})},
                     {"meshes", json::array({{{"primitives", json::array({primitive})}}})},
                     {"accessors",
                      {accessor(0, 5126, survey.points.size(), "VEC3"), accessor(1, 5121, survey.points.size(), "VEC4"),
                       accessor(2, 5125, n * survey.points.size(), "SCALAR"), accessor(3, 5125, survey.points.size(), "VEC2")}},
                     {"bufferViews",
                      {view(0, 0, positions.size()), view(0, positions.size(), colors.size()), view(1, 0, camera_ids.size()),
                       view(1, camera_ids.size(), ranges.size())}},
                     {"buffers", json::array({{{"uri", "points.bin"}, {"byteLength", positions.size() + colors.size()}},
                                              {{"uri", "matches.bin"}, {"byteLength", camera_ids.size() + ranges.size()}}})}};
  return {{"project.opf", base::JsonText(project, 1)},
          {"cameras.json", base::JsonText(list, 1)},
          {"input.json", base::JsonText(input, 1)},
          {"frame.json", base::JsonText(frame, 1)},
          {"calibrated.json", base::JsonText(calibrated, 1)},
          {"tracks.gltf", base::JsonText(gltf, 1)},
          {"points.bin", positions + colors},
          {"matches.bin", camera_ids + ranges}};
}

// Camera x right, y up, z backward; the image's v grows downwards.
Vector2d ProjectTransforms(const MadeLens& lens, const MadePhoto& photo, const Vector3d& x) {
  const Vector3d p = RightUpBack(photo.axes).transpose() * (x - photo.centre);
  const Distorted d = Brown(p.x() / -p.z(), -p.y() / -p.z(), lens, lens.p2, lens.p1);
  return {lens.fx * d.x + lens.cx, lens.fy * d.y + lens.cy};
}

// Normalized coordinates to pixels whose first has its centre at 0, and from there to the corner.
Vector2d ProjectOpensfm(const MadeLens& lens, const MadePhoto& photo, const Vector3d& x) {
  const Vector3d p = photo.axes.transpose() * x - photo.axes.transpose() * photo.centre;
  const double unit = std::max(lens.width, lens.height);
  const Distorted d = Brown(p.x() / p.z(), p.y() / p.z(), lens, lens.p2, lens.p1);
  const double u = lens.fx / unit * d.x + (lens.cx - 0.5 * lens.width) / unit;
  const double v = lens.fy / unit * d.y + (lens.cy - 0.5 * lens.height) / unit;
  return {unit * u + 0.5 * (lens.width - 1) + 0.5, unit * v + 0.5 * (lens.height - 1) + 0.5};
}

// The manual's formula, with its P1 along x.
Vector2d ProjectMetashape(const MadeLens& lens, const MadePhoto& photo, const Vector3d& x) {
  const Vector3d p = photo.axes.transpose() * (x - photo.centre);
  const double metashape_p1 = lens.p2, metashape_p2 = lens.p1;
  const Distorted d = Brown(p.x() / p.z(), p.y() / p.z(), lens, metashape_p1, metashape_p2);
  const double f = lens.fy, b1 = lens.fx - lens.fy;
  return {0.5 * lens.width + (lens.cx - 0.5 * lens.width) + d.x * f + d.x * b1, 0.5 * lens.height + (lens.cy - 0.5 * lens.height) + d.y * f};
}

// R^T (X - T) in the image's axes right, top, back.
Vector2d ProjectOpf(const MadeLens& lens, const MadePhoto& photo, const Vector3d& x) {
  const Vector3d p = RightUpBack(photo.axes).transpose() * (x - photo.centre);
  const Distorted d = Brown(-p.x() / p.z(), p.y() / p.z(), lens, lens.p2, lens.p1);
  return {lens.fy * d.x + lens.cx, lens.fy * d.y + lens.cy};
}

Vector2d ProjectBlender(const MadeLens& lens, const MadePhoto& photo, const Vector3d& x) {
  const Vector3d p = RightUpBack(photo.axes).transpose() * (x - photo.centre);
  return {0.5 * lens.width + lens.fx * p.x() / -p.z(), 0.5 * lens.height - lens.fx * p.y() / -p.z()};
}

}  // namespace skyquilt::test
