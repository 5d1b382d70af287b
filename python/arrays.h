// Numpy arrays over memory of ours, without copies: each array keeps its memory alive, whoever made it is gone by then.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::python {

namespace py = pybind11;

// Doubles of Python in rows, whatever they were.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Keeps what a shared pointer points to for as long as an array needs it.
template <typename T>
py::capsule Keep(std::shared_ptr<T> owner) {
  return {new std::shared_ptr<T>(std::move(owner)), [](void* kept) { delete static_cast<std::shared_ptr<T>*>(kept); }};
}

// A member of every element of a list, as an array of shape `shape` + `inner`: first is the member of the first element.
template <typename T, typename Element>
py::array MemberArray(const T* first, std::vector<py::ssize_t> shape, const std::vector<py::ssize_t>& inner, const py::capsule& owner) {
  std::vector<py::ssize_t> strides(shape.size());
  py::ssize_t stride = static_cast<py::ssize_t>(sizeof(Element));
  for (size_t i = shape.size(); i-- > 0;) {
    strides[i] = stride;
    stride *= shape[i];
  }
  for (const py::ssize_t n : inner) {
    shape.push_back(n);
    strides.push_back(static_cast<py::ssize_t>(sizeof(T)));  // at most one inner axis
  }
  return py::array(py::dtype::of<T>(), std::move(shape), std::move(strides), first, owner);
}

// A whole list as an array.
template <typename T>
py::array ListArray(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_shared<std::vector<T>>(std::move(values));
  const T* const first = kept->data();
  return py::array(py::dtype::of<T>(), std::move(shape), first, Keep(std::move(kept)));
}

// Rows of N numbers. Throws base::UsageError, which names the argument, for another shape.
template <int N>
std::span<const Eigen::Matrix<double, N, 1>> Rows(const Doubles& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != N) {
    std::string shape;
    for (py::ssize_t i = 0; i < array.ndim(); ++i) shape += (i == 0 ? "" : ", ") + std::to_string(array.shape(i));
    throw base::UsageError(std::string(name) + " has the shape (" + shape + "): it must be (N, " + std::to_string(N) + ")");
  }
  using Row = Eigen::Matrix<double, N, 1>;
  static_assert(sizeof(Row) == N * sizeof(double));
  return {reinterpret_cast<const Row*>(array.data()), static_cast<size_t>(array.shape(0))};
}

}  // namespace skyquilt::python
