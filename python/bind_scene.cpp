#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <tuple>

#include "core/render/ray.h"
#include "core/scene/map_heights.h"
#include "products/camera_path.h"
#include "products/render_views.h"
#include "python/arrays.h"
#include "python/attend.h"
#include "python/bindings.h"
#include "python/open_scene.h"

namespace skyquilt::python {
namespace {

// name, camera model, width, height, parameters, rotation w x y z and translation of cam_from_enu
using ViewTuple = std::tuple<std::string, std::string, int, int, std::vector<double>, std::array<double, 4>, std::array<double, 3>>;

products::View ViewOf(const ViewTuple& tuple) {
  const auto& [name, model, width, height, params, q, t] = tuple;
  const std::optional<camera::CameraModel> known = camera::ModelFromName(model);
  if (!known) throw base::UsageError("the camera model '" + model + "' is not known: give " + camera::ModelNames());
  return {name,
          {.model = *known, .width = width, .height = height, .params = params},
          {.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]), .translation = {t[0], t[1], t[2]}}};
}

ViewTuple TupleOf(const products::View& view) {
  const Eigen::Quaterniond& q = view.cam_from_enu.rotation;
  const Eigen::Vector3d& t = view.cam_from_enu.translation;
  return {view.name,
          std::string(camera::ModelName(view.camera.model)),
          view.camera.width,
          view.camera.height,
          view.camera.params,
          {q.w(), q.x(), q.y(), q.z()},
          {t.x(), t.y(), t.z()}};
}

std::vector<ViewTuple> TuplesOf(const std::vector<products::View>& views) {
  std::vector<ViewTuple> tuples;
  for (const products::View& view : views) tuples.push_back(TupleOf(view));
  return tuples;
}

// The members of rendered rays, views of one memory.
py::dict ArraysOf(const std::shared_ptr<Colors>& colors, const std::vector<py::ssize_t>& shape) {
  const py::capsule owner = Keep(colors);
  const render::RayColor empty;
  const render::RayColor& first = colors->empty() ? empty : colors->front();
  const auto member = [&](const float& value, const std::vector<py::ssize_t>& inner) {
    return MemberArray<float, render::RayColor>(&value, shape, inner, owner);
  };
  py::dict arrays;
  arrays["color"] = member(first.rgb_srgb[0], {3});
  arrays["opacity"] = member(first.opacity, {});
  arrays["depth"] = member(first.depth_median, {});
  arrays["depth_mean"] = member(first.depth, {});
  arrays["depth_front"] = member(first.depth_front, {});
  arrays["depth_back"] = member(first.depth_back, {});
  return arrays;
}

py::array ImageArray(image::ImageF image) {
  return ListArray(std::move(image.data), {image.height, image.width, image.channels});
}

py::dict RenderView(OpenScene& scene, const ViewTuple& tuple, const std::string& exposure, const std::string& normals) {
  const products::View view = ViewOf(tuple);
  Rendered rendered;
  image::Image8 picture;
  Attend([&] {
    rendered = scene.Render(view, exposure, normals);
    picture = products::ColorImage(*rendered.colors, view.camera.width, view.camera.height);
  });
  py::dict arrays = ArraysOf(rendered.colors, {view.camera.height, view.camera.width});
  arrays["rgb8"] = ListArray(std::move(picture.data), {view.camera.height, view.camera.width, 3});
  if (!rendered.normals.Empty()) arrays["normals"] = ImageArray(std::move(rendered.normals));
  return arrays;
}

py::dict CastRays(OpenScene& scene, const Doubles& origins, const Doubles& directions, double near_m, double far_m, double width_m, double pitch,
                  const std::string& exposure, bool background) {
  const auto starts = Rows<3>(origins, "origins");
  const auto ways = Rows<3>(directions, "directions");
  const auto colors = std::make_shared<Colors>(starts.size());
  Attend([&] { scene.Cast(starts, ways, {near_m, far_m, width_m, pitch}, exposure, background, *colors); });
  return ArraysOf(colors, {static_cast<py::ssize_t>(starts.size())});
}

std::pair<py::array, py::array> QueryPlaces(OpenScene& scene, const Doubles& points, const std::string& frame_name, const Doubles& directions,
                                            double footprint_m, bool colors) {
  const Frame frame = FrameNamed(frame_name);
  const auto places = Rows<3>(points, "points");
  const auto ways = Rows<3>(directions, "directions");
  const auto found = std::make_shared<std::vector<scene::PointColor>>(places.size());
  Attend([&] { scene.Query(places, frame, ways, {.footprint_m = footprint_m, .colors = colors}, *found); });
  const py::capsule owner = Keep(found);
  const scene::PointColor empty;
  const scene::PointColor& first = found->empty() ? empty : found->front();
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(found->size())};
  return {MemberArray<float, scene::PointColor>(&first.density, shape, {}, owner),
          MemberArray<float, scene::PointColor>(&first.rgb_srgb[0], shape, {3}, owner)};
}

py::array HeightsAt(OpenScene& scene, const Doubles& places, const std::string& frame_name, double width_m) {
  const Frame frame = FrameNamed(frame_name);
  const auto plan = Rows<2>(places, "places");
  std::vector<double> heights(plan.size());
  Attend([&] { scene.Heights(plan, frame, width_m, heights); });
  const auto n = static_cast<py::ssize_t>(heights.size());
  return ListArray(std::move(heights), {n});
}

py::array Converted(OpenScene& scene, const Doubles& points, const std::string& frame_name, bool to_enu) {
  const Frame frame = FrameNamed(frame_name);
  const auto places = Rows<3>(points, "points");
  auto converted = std::make_shared<std::vector<Eigen::Vector3d>>(places.size());
  Attend([&] {
    if (to_enu) {
      scene.ToEnu(frame, places, *converted);
    } else {
      scene.FromEnu(frame, places, *converted);
    }
  });
  const double* const first = converted->empty() ? nullptr : converted->front().data();
  return py::array(py::dtype::of<double>(), std::vector<py::ssize_t>{static_cast<py::ssize_t>(converted->size()), 3}, first, Keep(converted));
}

py::dict InfoOf(const OpenScene& scene) {
  const scene::SceneInfo& info = scene.info();
  py::list blocks;
  for (const scene::SceneBlock& block : info.blocks) {
    py::dict entry;
    entry["name"] = block.name;
    entry["min_enu"] = std::array<double, 3>{block.min_enu.x(), block.min_enu.y(), block.min_enu.z()};
    entry["max_enu"] = std::array<double, 3>{block.max_enu.x(), block.max_enu.y(), block.max_enu.z()};
    entry["margin_m"] = block.margin_m;
    entry["parameters"] = block.parameters;
    entry["steps"] = block.steps;
    entry["shows_context"] = block.shows_context;
    blocks.append(entry);
  }
  py::dict dict;
  dict["origin"] = std::array<double, 3>{info.origin.longitude_deg, info.origin.latitude_deg, info.origin.height_m};
  dict["georeferenced"] = info.georeferenced;
  dict["epsg"] = scene.places().zone() ? py::object(py::int_(scene.places().zone()->Epsg())) : py::object(py::none());
  dict["heights"] = scene::MapHeights(info, geo::Vertical::kAsTagged).Name();
  dict["min_enu"] = std::array<double, 3>{info.min_enu.x(), info.min_enu.y(), info.min_enu.z()};
  dict["max_enu"] = std::array<double, 3>{info.max_enu.x(), info.max_enu.y(), info.max_enu.z()};
  dict["gsd_m"] = info.gsd_m;
  dict["parameters"] = info.parameters;
  dict["footprint_min_m"] = info.scales.footprint_min_m;
  dict["footprint_max_m"] = info.scales.footprint_max_m;
  dict["normals"] = [&] {
    std::vector<std::string> kinds = {"depth"};
    if (info.density_normals) kinds.emplace_back("density");
    if (info.normal_head) kinds.emplace_back("predicted");
    return kinds;
  }();
  dict["config"] = info.config;
  dict["blocks"] = blocks;
  return dict;
}

}  // namespace

void BindScene(py::module_& module) {
  py::class_<OpenScene>(module, "Scene")
      .def(py::init([](const std::filesystem::path& scene_h5, int threads, double memory_gb) {
             std::unique_ptr<OpenScene> scene;
             Attend([&] { scene = std::make_unique<OpenScene>(scene_h5, threads, memory_gb); });
             return scene;
           }),
           py::arg("scene_h5"), py::arg("threads"), py::arg("memory_gb"))
      .def("info", &InfoOf)
      .def("render", &RenderView, py::arg("view"), py::arg("exposure"), py::arg("normals"))
      .def("cast", &CastRays, py::arg("origins"), py::arg("directions"), py::arg("near_m"), py::arg("far_m"), py::arg("width_m"), py::arg("pitch"),
           py::arg("exposure"), py::arg("background"))
      .def("query", &QueryPlaces, py::arg("points"), py::arg("frame"), py::arg("directions"), py::arg("footprint_m"), py::arg("colors"))
      .def("heights", &HeightsAt, py::arg("places"), py::arg("frame"), py::arg("width_m"))
      .def("convert", &Converted, py::arg("points"), py::arg("frame"), py::arg("to_enu"))
      .def(
          "path",
          [](OpenScene& scene, const std::string& text, const std::filesystem::path& file, int width, int height) {
            return TuplesOf(scene.Path(text, file, width, height));
          },
          py::arg("text"), py::arg("file"), py::arg("width"), py::arg("height"));
  module.def(
      "views_of_photos",
      [](const std::filesystem::path& survey_folder, const std::vector<std::string>& names, int width) {
        return TuplesOf(products::ViewsOfPhotos(survey::LoadSurvey(survey_folder), names, width));
      },
      py::arg("survey_folder"), py::arg("names"), py::arg("width"));
  module.def(
      "look_at",
      [](const std::array<double, 3>& eye, const std::array<double, 3>& target) {
        const products::View view{{}, {}, products::PoseLookingAt({eye[0], eye[1], eye[2]}, {target[0], target[1], target[2]})};
        const ViewTuple tuple = TupleOf(view);
        return std::make_pair(std::get<5>(tuple), std::get<6>(tuple));
      },
      py::arg("eye"), py::arg("target"));
  module.def(
      "pinhole",
      [](int width, int height, double fov_deg) {
        const camera::Camera camera = products::PinholeCamera(width, height, fov_deg);
        return std::make_pair(std::string(camera::ModelName(camera.model)), camera.params);
      },
      py::arg("width"), py::arg("height"), py::arg("fov_deg"));
}

}  // namespace skyquilt::python
