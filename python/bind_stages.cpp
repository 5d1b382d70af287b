#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <utility>

#include "app/settings/duration.h"
#include "app/settings/memory_size.h"
#include "app/settings/presets.h"
#include "python/attend.h"
#include "python/bindings.h"
#include "python/stage_call.h"

namespace skyquilt::python {
namespace {

namespace py = pybind11;

void CallFromPython(const std::string& stage, const std::filesystem::path& folder, const std::vector<std::string>& photos,
                    const std::filesystem::path& model, const std::string& config, const std::vector<std::pair<std::string, std::string>>& options,
                    bool restart, bool quiet, bool verbose, const py::object& progress) {
  StageCall call{.stage = stage, .folder = folder, .photos = photos, .model = model, .choice = {.config = config}};
  for (const auto& [key, value] : options) call.choice.overrides.push_back({key, value});
  call.restart = restart;
  call.quiet = quiet;
  call.verbose = verbose;
  Attention attention;
  if (!progress.is_none()) {
    // By pointer, because copies of a Python object need the lock.
    call.progress = [&attention, told = &progress](const std::string& label, double share) {
      const py::gil_scoped_acquire acquire;
      try {
        (*told)(label, share);
      } catch (py::error_already_set& error) {
        attention.Stop(error);
      }
    };
  }
  attention.Run([&] { CallStage(call); });
}

}  // namespace

void BindStages(py::module_& module) {
  module.def("call_stage", &CallFromPython, py::arg("stage"), py::arg("folder"), py::arg("photos"), py::arg("model"), py::arg("config"),
             py::arg("options"), py::arg("restart"), py::arg("quiet"), py::arg("verbose"), py::arg("progress"));
  module.def("seconds_of", &app::ParseDurationSeconds, py::arg("text"));
  module.def(
      "gib_of", [](const std::string& text) { return app::FormatGib(app::ParseBytes(text)); }, py::arg("text"));
  module.def("sections", [] {
    std::vector<std::string> names;
    coordinator::Settings settings;
    const config::Sections sections = settings.AllSections();
    for (const config::Sections::Entry& entry : sections.entries()) names.push_back(entry.name);
    return names;
  });
  module.def("presets", &app::PresetNames);
}

}  // namespace skyquilt::python
