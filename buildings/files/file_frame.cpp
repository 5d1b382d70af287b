#include "buildings/files/file_frame.h"

#include <array>
#include <charconv>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

constexpr int kDigits = 4;

}  // namespace

FileFrame::FileFrame(const BuildingSet& set, const surface::MapFrame& frame) : map_(frame), metric_(set.metric), scale_(set.scale) {}

Eigen::Vector3d FileFrame::PositionOf(const Eigen::Vector3d& enu) const {
  const Eigen::Vector3d exact = map_.georeferenced() ? map_.MapFromEnu(enu) : Eigen::Vector3d(scale_ * enu);
  SKYQUILT_CHECK(exact.allFinite(), "a building with a coordinate that is not finite");
  return exact.unaryExpr([](double value) { return Rounded(value, kDigits); });
}

std::vector<Eigen::Vector3d> FileFrame::PositionsOf(const Solid& solid) const {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(solid.vertex.size());
  for (const Eigen::Vector3d& vertex : solid.vertex) positions.push_back(PositionOf(vertex));
  return positions;
}

std::string FileFrame::CrsName() const {
  return metric_ || map_.georeferenced() ? map_.CrsName() : "local frame, unknown scale";
}

std::string FileFrame::VerticalName() const {
  return map_.VerticalName();
}

double Rounded(double value, int digits) {
  const double steps = std::pow(10.0, digits);
  return std::round(value * steps) / steps + 0.0;
}

std::string NumberText(double value) {
  std::array<char, 400> text;  // the longest double has 309 digits before the point
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), value + 0.0, std::chars_format::fixed);
  return {text.data(), end.ptr};
}

}  // namespace skyquilt::buildings
