#include "core/survey/refined_poses.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/order_statistics.h"
#include "core/geo/pose_gauge.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::survey {
namespace {

constexpr const char* kRefinedFormat = "skyquilt refined poses";
constexpr int kRefinedVersion = 1;
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

std::filesystem::path RefinedFile(const std::filesystem::path& survey_folder) {
  return RefinedPosesFolder(survey_folder) / "poses.json";
}

nlohmann::ordered_json NumbersOf(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

double FiniteNumber(const nlohmann::json& value) {
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw std::invalid_argument("has a number that is not finite");
  return number;
}

Eigen::Vector3d VectorFromJson(const nlohmann::json& value) {
  return {FiniteNumber(value.at(0)), FiniteNumber(value.at(1)), FiniteNumber(value.at(2))};
}

// Median and largest; zeros of nothing.
std::pair<double, double> MedianAndLargest(const std::vector<double>& values) {
  if (values.empty()) return {0.0, 0.0};
  return {base::Median(values), base::Quantile(values, 1.0)};
}

}  // namespace

geo::Rigid3d WithOffset(const geo::Rigid3d& enu_from_cam, const PoseOffset& offset) {
  return {enu_from_cam.rotation * geo::RotationOfVector(offset.rotation), enu_from_cam.translation + enu_from_cam.rotation * offset.translation};
}

PoseOffset OffsetBetween(const geo::Rigid3d& given, const geo::Rigid3d& changed) {
  const Eigen::Quaterniond back = given.rotation.conjugate();
  return {geo::VectorOfRotation(back * changed.rotation), back * (changed.translation - given.translation)};
}

OffsetSizes SizesOf(const RefinedPoses& poses) {
  std::vector<double> metres, degrees, pixels;
  for (const RefinedPoses::Photo& photo : poses.photos) {
    metres.push_back(photo.offset.translation.norm());
    degrees.push_back(kDegreesPerRadian * photo.offset.rotation.norm());
    pixels.push_back(photo.moved_px);
  }
  OffsetSizes sizes;
  std::tie(sizes.median_m, sizes.largest_m) = MedianAndLargest(metres);
  std::tie(sizes.median_deg, sizes.largest_deg) = MedianAndLargest(degrees);
  std::tie(sizes.median_px, sizes.largest_px) = MedianAndLargest(pixels);
  return sizes;
}

std::string RefinedPoses::Summary() const {
  const OffsetSizes s = SizesOf(*this);
  return fmt::format(
      "poses of {} photos refined: median {:.1f} cm, {:.3f} degrees, {:.2f} pixels as trained; largest {:.1f} cm, {:.3f} degrees, {:.2f} pixels",
      photos.size(), 100.0 * s.median_m, s.median_deg, s.median_px, 100.0 * s.largest_m, s.largest_deg, s.largest_px);
}

void ApplyRefinedPoses(const RefinedPoses& poses, Survey& survey) {
  std::map<std::string, const RefinedPoses::Photo*> by_name;
  for (const RefinedPoses::Photo& photo : poses.photos) by_name.emplace(photo.name, &photo);
  for (Photo& photo : survey.photos) {
    const auto found = by_name.find(photo.name);
    if (photo.is_test || found == by_name.end()) continue;
    photo.cam_from_enu = WithOffset(photo.cam_from_enu.Inverse(), found->second->offset).Inverse();
  }
}

std::filesystem::path RefinedPosesFolder(const std::filesystem::path& survey_folder) {
  return survey_folder / "refined";
}

void SaveRefinedPoses(const RefinedPoses& poses, const Survey& survey, const std::filesystem::path& survey_folder) {
  const std::filesystem::path folder = RefinedPosesFolder(survey_folder);
  std::filesystem::create_directories(folder / "sparse");
  nlohmann::ordered_json value = {{"format", kRefinedFormat}, {"version", kRefinedVersion}, {"photos", nlohmann::ordered_json::array()}};
  for (const RefinedPoses::Photo& photo : poses.photos) {
    value["photos"].push_back({{"name", photo.name},
                               {"rotation_deg", NumbersOf(kDegreesPerRadian * photo.offset.rotation)},
                               {"translation_m", NumbersOf(photo.offset.translation)},
                               {"moved_px", photo.moved_px}});
  }

  Survey refined;
  refined.cameras = survey.cameras;
  refined.photos = survey.photos;
  ApplyRefinedPoses(poses, refined);
  ColmapModel model;
  for (size_t i = 0; i < refined.cameras.size(); ++i) model.cameras.emplace(static_cast<uint32_t>(i + 1), refined.cameras[i]);
  for (size_t i = 0; i < refined.photos.size(); ++i) {
    const Photo& photo = refined.photos[i];
    ColmapImage image;
    image.id = static_cast<uint32_t>(i + 1);
    image.camera_id = static_cast<uint32_t>(photo.camera + 1);
    image.name = photo.name;
    image.cam_from_world = photo.cam_from_enu;
    model.images.push_back(std::move(image));
  }
  WriteColmapText(model, folder / "sparse");
  base::WriteFileAtomically(RefinedFile(survey_folder), base::JsonText(value, 1) + "\n");
}

std::optional<RefinedPoses> LoadRefinedPoses(const std::filesystem::path& survey_folder) {
  const std::filesystem::path file = RefinedFile(survey_folder);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  const std::string fix = "Remove the folder, then train again with --restart: skyquilt train PROJECT --restart";
  try {
    const nlohmann::json value = base::ParseJson(base::ReadFile(file));
    if (value.value("format", "") != kRefinedFormat) throw std::invalid_argument("is no table of refined poses");
    if (value.value("version", 0) != kRefinedVersion) throw std::invalid_argument("was written by another version of skyquilt");
    RefinedPoses poses;
    for (const nlohmann::json& photo : value.at("photos")) {
      poses.photos.push_back({.name = photo.at("name").get<std::string>(),
                              .offset = {VectorFromJson(photo.at("rotation_deg")) / kDegreesPerRadian, VectorFromJson(photo.at("translation_m"))},
                              .moved_px = FiniteNumber(photo.at("moved_px"))});
    }
    return poses;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", fix);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, error.what(), fix);
  }
}

void RemoveRefinedPoses(const std::filesystem::path& survey_folder) {
  std::filesystem::remove_all(RefinedPosesFolder(survey_folder));
}

Survey LoadRefinedSurvey(const std::filesystem::path& survey_folder) {
  Survey survey = LoadSurvey(survey_folder);
  if (const std::optional<RefinedPoses> poses = LoadRefinedPoses(survey_folder)) ApplyRefinedPoses(*poses, survey);
  return survey;
}

}  // namespace skyquilt::survey
