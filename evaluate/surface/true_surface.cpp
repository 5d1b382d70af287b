#include "evaluate/surface/true_surface.h"

#include <Eigen/Geometry>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"

namespace skyquilt::evaluate::surface {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr size_t kVertexBytes = 3 * sizeof(float);
constexpr size_t kFaceBytes = 1 + 3 * sizeof(int32_t) + 1;
constexpr const char* kSimulateAgain = "Run 'skyquilt simulate' again";

struct TruthHeader {
  size_t bytes = 0, vertices = 0, faces = 0;
};

// Nothing when the header is not that of a true surface.
std::optional<TruthHeader> ReadTruthHeader(const std::string& content) {
  constexpr std::string_view kEnd = "end_header\n";
  const size_t end = content.find(kEnd);
  if (!content.starts_with("ply\n") || end == std::string::npos) return std::nullopt;
  TruthHeader header{.bytes = end + kEnd.size()};
  std::istringstream lines(content.substr(0, end));
  std::string layout, line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string word, element;
    words >> word;
    if (word == "comment") continue;
    if (word == "element") {
      size_t count = 0;
      words >> element >> count;
      if (!words || (element != "vertex" && element != "face")) return std::nullopt;
      (element == "vertex" ? header.vertices : header.faces) = count;
      layout += element + ";";
    } else {
      layout += line + ";";
    }
  }
  const bool known = layout ==
                     "ply;format binary_little_endian 1.0;vertex;property float x;property float y;property float z;face;"
                     "property list uchar int vertex_indices;property uchar class;";
  return known ? std::optional(header) : std::nullopt;
}

std::optional<geo::Geodetic> TruthOrigin(const std::filesystem::path& simulate_json) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(simulate_json, ignored)) return std::nullopt;
  try {
    const nlohmann::json origin = base::ParseJson(base::ReadFile(simulate_json)).at("origin");
    const geo::Geodetic found{origin.at("latitude_deg").get<double>(), origin.at("longitude_deg").get<double>(), origin.at("height_m").get<double>()};
    if (!geo::IsValid(found)) throw base::InputError(simulate_json, "has an origin that is not a place on Earth", kSimulateAgain);
    return found;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(simulate_json, std::string("is damaged (") + error.what() + ")", kSimulateAgain);
  }
}

}  // namespace

geo::Rigid3d SurveyFromTruth(const std::filesystem::path& simulate_json, const geo::Geodetic& survey_origin) {
  const std::optional<geo::Geodetic> truth_origin = TruthOrigin(simulate_json);
  const bool same = !truth_origin || (truth_origin->latitude_deg == survey_origin.latitude_deg &&
                                      truth_origin->longitude_deg == survey_origin.longitude_deg && truth_origin->height_m == survey_origin.height_m);
  if (same || !geo::IsValid(survey_origin)) return {};
  const geo::EnuFrame truth(*truth_origin), survey(survey_origin);
  const auto moved = [&](const Eigen::Vector3d& x) { return survey.EnuFromGeodetic(truth.GeodeticFromEnu(x)); };
  constexpr double kReach_m = 1000.0;
  const Eigen::Vector3d shift = moved(Eigen::Vector3d::Zero());
  Eigen::Matrix3d rotation;
  for (Eigen::Index axis = 0; axis < 3; ++axis) rotation.col(axis) = (moved(kReach_m * Eigen::Vector3d::Unit(axis)) - shift) / kReach_m;
  return {Eigen::Quaterniond(rotation).normalized(), shift};
}

Eigen::Vector3d TrueSurface::Normal(uint32_t triangle_index) const {
  const Eigen::Vector3d a = Corner(triangle_index, 0), b = Corner(triangle_index, 1), c = Corner(triangle_index, 2);
  return (b - a).cross(c - a).normalized();
}

TrueSurface ReadTrueSurface(const std::filesystem::path& surface_ply, const geo::Geodetic& survey_origin) {
  const std::string content = base::ReadFile(surface_ply);
  const std::optional<TruthHeader> header = ReadTruthHeader(content);
  if (!header) throw base::InputError(surface_ply, "is not a mesh with a class per face as 'skyquilt simulate' writes it", kSimulateAgain);
  const size_t body = content.size() - header->bytes;
  const bool fits = header->vertices <= body / kVertexBytes && header->faces <= body / kFaceBytes &&
                    body == header->vertices * kVertexBytes + header->faces * kFaceBytes;
  if (!fits) throw base::InputError(surface_ply, "is damaged: its size does not agree with its header", kSimulateAgain);

  TrueSurface truth;
  truth.survey_from_truth = SurveyFromTruth(surface_ply.parent_path().parent_path() / "simulate.json", survey_origin);
  // Coordinates of the simulator are near its origin, so that is a middle that keeps their digits.
  truth.middle = truth.survey_from_truth.translation;
  truth.position.resize(header->vertices);
  const Eigen::Matrix3d rotation = truth.survey_from_truth.rotation.toRotationMatrix();
  const char* at = content.data() + header->bytes;
  for (Eigen::Vector3f& position : truth.position) {
    std::memcpy(position.data(), at, kVertexBytes);
    at += kVertexBytes;
    if (!position.allFinite()) throw base::InputError(surface_ply, "is damaged: a coordinate is not a number", kSimulateAgain);
    position = (rotation * position.cast<double>()).cast<float>();
  }
  truth.triangle.resize(header->faces);
  truth.class_id.resize(header->faces);
  for (size_t i = 0; i < header->faces; ++i) {
    const auto n_corners = static_cast<uint8_t>(*at);
    std::memcpy(truth.triangle[i].data(), at + 1, 3 * sizeof(int32_t));
    truth.class_id[i] = static_cast<uint8_t>(at[kFaceBytes - 1]);
    at += kFaceBytes;
    for (const uint32_t corner : truth.triangle[i]) {
      if (n_corners != 3 || corner >= header->vertices) {
        throw base::InputError(surface_ply, "is damaged: a face is not a triangle of its vertices", kSimulateAgain);
      }
    }
  }
  return truth;
}

}  // namespace skyquilt::evaluate::surface
