#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <new>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "python/bindings.h"

namespace skyquilt::python {
namespace {

namespace py = pybind11;

// The exceptions are classes of the package, python/skyquilt/errors.py.
void Raise(const char* name, const char* message) {
  const py::object type = py::module_::import("skyquilt.errors").attr(name);
  PyErr_SetString(type.ptr(), message);
}

void RaiseInput(const base::InputError& error) {
  const py::object type = py::module_::import("skyquilt.errors").attr("InputError");
  const py::object value = type(error.what(), error.file());
  PyErr_SetObject(type.ptr(), value.ptr());
}

void Translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const base::UsageError& error) {
    Raise("UsageError", error.what());
  } catch (const base::InputError& error) {
    RaiseInput(error);
  } catch (const base::BlockError& error) {
    Raise("BlockError", error.what());
  } catch (const base::Interrupted& error) {
    Raise("Interrupted", error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

}  // namespace
}  // namespace skyquilt::python

PYBIND11_MODULE(_skyquilt, module) {
  namespace python = skyquilt::python;
  skyquilt::base::InitLog(false);
  skyquilt::base::SetLogLevel(skyquilt::base::LogLevel::kWarning);
  skyquilt::base::Progress::SetQuiet(true);
  pybind11::register_exception_translator(&python::Translate);
  module.attr("version") = SKYQUILT_VERSION;
  python::BindScene(module);
  python::BindSurvey(module);
  python::BindMetrics(module);
  python::BindStages(module);
}
