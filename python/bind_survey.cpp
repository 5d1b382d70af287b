#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <limits>

#include "coordinator/project/project.h"
#include "core/survey/survey.h"
#include "python/arrays.h"
#include "python/attend.h"
#include "python/bindings.h"
#include "python/building_features.h"

namespace skyquilt::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using SharedSurvey = std::shared_ptr<const survey::Survey>;

// One number per photo; NaN where it is not known.
template <typename Value>
py::array PhotoNumbers(const survey::Survey& survey, const Value& value) {
  std::vector<double> numbers;
  for (const survey::Photo& photo : survey.photos) numbers.push_back(value(photo));
  const auto n = static_cast<py::ssize_t>(numbers.size());
  return ListArray(std::move(numbers), {n});
}

// A list of `width` numbers per photo.
template <typename Value>
py::array PhotoRows(const survey::Survey& survey, py::ssize_t width, const Value& value) {
  std::vector<double> numbers;
  for (const survey::Photo& photo : survey.photos) {
    for (const double number : value(photo)) numbers.push_back(number);
  }
  return ListArray(std::move(numbers), {static_cast<py::ssize_t>(survey.photos.size()), width});
}

py::dict PhotosOf(const survey::Survey& survey) {
  using Four = std::array<double, 4>;
  using Three = std::array<double, 3>;
  py::dict photos;
  py::list names, masks;
  std::vector<int> cameras, flights;
  std::vector<uint8_t> held_out, agrees;
  for (const survey::Photo& photo : survey.photos) {
    names.append(photo.name);
    masks.append(photo.mask);
    cameras.push_back(photo.camera);
    flights.push_back(photo.flight);
    held_out.push_back(photo.is_test ? 1 : 0);
    agrees.push_back(photo.gps_inlier ? 1 : 0);
  }
  const auto n = static_cast<py::ssize_t>(survey.photos.size());
  photos["names"] = names;
  photos["masks"] = masks;
  photos["camera"] = ListArray(std::move(cameras), {n});
  photos["flight"] = ListArray(std::move(flights), {n});
  photos["held_out"] = ListArray(std::move(held_out), {n}).attr("view")("bool");
  photos["gps_agrees"] = ListArray(std::move(agrees), {n}).attr("view")("bool");
  photos["rotation_wxyz"] = PhotoRows(survey, 4, [](const survey::Photo& p) {
    const Eigen::Quaterniond& q = p.cam_from_enu.rotation;
    return Four{q.w(), q.x(), q.y(), q.z()};
  });
  photos["translation_m"] = PhotoRows(survey, 3, [](const survey::Photo& p) {
    const Eigen::Vector3d& t = p.cam_from_enu.translation;
    return Three{t.x(), t.y(), t.z()};
  });
  photos["gps"] = PhotoRows(survey, 3, [](const survey::Photo& p) {
    return p.gps ? Three{p.gps->longitude_deg, p.gps->latitude_deg, p.gps->height_m} : Three{kNan, kNan, kNan};
  });
  photos["gps_residual_m"] = PhotoNumbers(survey, [](const survey::Photo& p) { return p.gps_residual_m; });
  photos["agl_m"] = PhotoNumbers(survey, [](const survey::Photo& p) { return p.agl_m; });
  photos["time_s"] = PhotoNumbers(survey, [](const survey::Photo& p) { return p.time_s.value_or(kNan); });
  photos["exposure_time_s"] = PhotoNumbers(survey, [](const survey::Photo& p) { return p.exposure.time_s.value_or(kNan); });
  photos["f_number"] = PhotoNumbers(survey, [](const survey::Photo& p) { return p.exposure.f_number.value_or(kNan); });
  photos["iso"] = PhotoNumbers(survey, [](const survey::Photo& p) { return p.exposure.iso.value_or(kNan); });
  return photos;
}

py::dict PointsOf(const SharedSurvey& survey) {
  const std::vector<survey::SparsePoint>& points = survey->points;
  const py::capsule owner = Keep(survey);
  const survey::SparsePoint empty;
  const survey::SparsePoint& first = points.empty() ? empty : points.front();
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(points.size())};
  py::dict arrays;
  arrays["xyz"] = MemberArray<double, survey::SparsePoint>(first.x_in_enu.data(), shape, {3}, owner);
  arrays["rgb"] = MemberArray<uint8_t, survey::SparsePoint>(first.rgb.data(), shape, {3}, owner);
  arrays["error_px"] = MemberArray<float, survey::SparsePoint>(&first.error_px, shape, {}, owner);
  arrays["track_length"] = MemberArray<int, survey::SparsePoint>(&first.track_length, shape, {}, owner);
  return arrays;
}

py::dict LoadSurvey(const std::filesystem::path& folder) {
  SharedSurvey survey;
  Attend([&] { survey = std::make_shared<const survey::Survey>(survey::LoadSurvey(folder)); });
  py::list cameras;
  for (const camera::Camera& camera : survey->cameras) {
    cameras.append(py::make_tuple(std::string(camera::ModelName(camera.model)), camera.width, camera.height, camera.params));
  }
  py::dict dict;
  dict["photo_root"] = survey->photo_root.string();
  dict["origin"] = std::array<double, 3>{survey->origin.longitude_deg, survey->origin.latitude_deg, survey->origin.height_m};
  dict["georeferenced"] = survey->georeferenced;
  dict["height_reference"] = geo::NameOf(survey->height_reference);
  dict["cameras"] = cameras;
  dict["photos"] = PhotosOf(*survey);
  dict["points"] = PointsOf(survey);
  return dict;
}

}  // namespace

void BindSurvey(py::module_& module) {
  module.def("load_survey", &LoadSurvey, py::arg("survey_folder"));
  module.def(
      "open_project", [](const std::filesystem::path& folder) { return coordinator::Project::OpenToRead(folder).folder; }, py::arg("folder"));
  module.def(
      "building_features",
      [](const std::filesystem::path& folder) {
        std::string text;
        Attend([&] { text = BuildingFeatures(coordinator::Project::OpenToRead(folder)); });
        return text;
      },
      py::arg("folder"));
}

}  // namespace skyquilt::python
