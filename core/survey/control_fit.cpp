#include "core/survey/control_fit.h"

#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/base/json_text.h"

namespace skyquilt::survey {
namespace {

using base::NanIfNull;
using base::NumberOrNull;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::array<std::pair<ControlUse, const char*>, 4> kUses = {
    {{ControlUse::kControl, "control"}, {ControlUse::kCheck, "check"}, {ControlUse::kRejected, "rejected"}, {ControlUse::kUnseen, "unseen"}}};

ControlUse UseFromName(const std::string& label, const std::string& name) {
  for (const auto& [use, known] : kUses) {
    if (known == name) return use;
  }
  throw std::invalid_argument("control point '" + label + "' has the unknown use '" + name + "'");
}

ordered_json ToJson(const Eigen::Vector3d& value) {
  return {NumberOrNull(value.x()), NumberOrNull(value.y()), NumberOrNull(value.z())};
}

template <int size>
Eigen::Vector<double, size> VectorFromJson(const std::string& label, const json& value) {
  if (!value.is_array() || value.size() != size) throw std::invalid_argument("control point '" + label + "' has a vector of the wrong length");
  Eigen::Vector<double, size> vector;
  for (int axis = 0; axis < size; ++axis) vector[axis] = NanIfNull(value[static_cast<size_t>(axis)]);
  return vector;
}

ControlPointFit PointFromJson(const json& value) {
  ControlPointFit point;
  point.label = value.at("label").get<std::string>();
  point.use = UseFromName(point.label, value.at("use").get<std::string>());
  point.given_in_enu = VectorFromJson<3>(point.label, value.at("given_in_enu_m"));
  if (!point.given_in_enu.head<2>().allFinite()) throw std::invalid_argument("control point '" + point.label + "' has no place");
  point.given_sigma_m = VectorFromJson<2>(point.label, value.at("given_sigma_m"));
  point.error_m = VectorFromJson<3>(point.label, value.at("error_m"));
  point.sigma_m = VectorFromJson<3>(point.label, value.at("sigma_m"));
  point.left_out_error_m = VectorFromJson<3>(point.label, value.at("left_out_error_m"));
  point.error_px = NanIfNull(value.at("error_px"));
  point.gsd_m = NanIfNull(value.at("gsd_m"));
  for (const json& entry : value.at("marks")) {
    ControlMarkFit mark;
    mark.photo = entry.at("photo").get<std::string>();
    mark.pixel = VectorFromJson<2>(point.label, entry.at("pixel"));
    if (!mark.pixel.allFinite()) throw std::invalid_argument("control point '" + point.label + "' has a mark without a pixel");
    mark.error_px = NanIfNull(entry.at("error_px"));
    mark.used = entry.at("used").get<bool>();
    point.marks.push_back(std::move(mark));
  }
  return point;
}

}  // namespace

ordered_json ToJson(const ControlFit& fit) {
  ordered_json points = ordered_json::array();
  for (const ControlPointFit& point : fit.points) {
    ordered_json marks = ordered_json::array();
    for (const ControlMarkFit& mark : point.marks) {
      marks.push_back(
          {{"photo", mark.photo}, {"pixel", {mark.pixel.x(), mark.pixel.y()}}, {"error_px", NumberOrNull(mark.error_px)}, {"used", mark.used}});
    }
    points.push_back({{"label", point.label},
                      {"use", NameOf(point.use)},
                      {"given_in_enu_m", ToJson(point.given_in_enu)},
                      {"given_sigma_m", {NumberOrNull(point.given_sigma_m.x()), NumberOrNull(point.given_sigma_m.y())}},
                      {"error_m", ToJson(point.error_m)},
                      {"sigma_m", ToJson(point.sigma_m)},
                      {"left_out_error_m", ToJson(point.left_out_error_m)},
                      {"error_px", NumberOrNull(point.error_px)},
                      {"gsd_m", NumberOrNull(point.gsd_m)},
                      {"marks", std::move(marks)}});
  }
  return {{"file", fit.file},     {"crs", fit.crs},           {"heights", fit.heights},
          {"placed", fit.placed}, {"adjusted", fit.adjusted}, {"points", std::move(points)}};
}

ControlFit ControlFitFromJson(const json& value) {
  ControlFit fit;
  fit.file = value.at("file").get<std::string>();
  fit.crs = value.at("crs").get<std::string>();
  fit.heights = value.at("heights").get<std::string>();
  fit.placed = value.at("placed").get<bool>();
  fit.adjusted = value.at("adjusted").get<bool>();
  std::set<std::string> labels;
  for (const json& entry : value.at("points")) {
    fit.points.push_back(PointFromJson(entry));
    if (!labels.insert(fit.points.back().label).second) {
      throw std::invalid_argument("control point '" + fit.points.back().label + "' appears twice");
    }
  }
  return fit;
}

}  // namespace skyquilt::survey
