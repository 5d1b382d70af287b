// The parts of the extension module _skyquilt. What Python sees of it is the package python/skyquilt, which names, checks and documents things for
// people; here only values are carried over, and python/skyquilt/_skyquilt.pyi says which.
#pragma once

#include <pybind11/pybind11.h>

namespace skyquilt::python {

void BindScene(pybind11::module_& module);
void BindSurvey(pybind11::module_& module);
void BindMetrics(pybind11::module_& module);
void BindStages(pybind11::module_& module);

}  // namespace skyquilt::python
