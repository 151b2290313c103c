// Conversions between the vectors of relume's interface and Python: tuples for vectors, NumPy arrays for matrices and
// attribute arrays.
#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "relume/error.h"
#include "relume/math.h"

namespace relume::python {

namespace py = pybind11;

/// Array that accepts anything convertible, in row-major order.
template <typename T>
using InputArray = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// Result of `work()`, which runs without the GIL.
template <typename F>
auto without_gil(const F& work) {
  const py::gil_scoped_release released;
  return work();
}

/// Throws Error unless the elements of `array` are integers, each at least 0 and below 2^32.
void check_unsigned(const py::array& array, const char* what);

/// Shape as text: "(3, 4)".
std::string shape_text(const py::array& array);

/// A NumPy array of `shape` that shares `memory`, which `owner` keeps alive. Read-only.
template <typename T>
py::array shared_array(std::vector<py::ssize_t> shape, const T* memory, const py::handle& owner) {
  py::array_t<T> array(std::move(shape), memory, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// A read-only copy of `values` with the shape (n, components), or (n) for scalars.
template <typename Scalar, typename T>
py::array copied_array(const std::vector<T>& values) {
  constexpr size_t kComponents = sizeof(T) / sizeof(Scalar);
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(values.size())};
  if (kComponents > 1) shape.push_back(kComponents);
  py::array_t<Scalar> array(shape);
  std::memcpy(array.mutable_data(), values.data(), values.size() * sizeof(T));
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// The rows of an array of shape (n, components), or (n) for scalars. Throws Error that names `what` for other shapes.
template <typename Scalar, typename T>
std::vector<T> vector_from(const py::handle& object, const char* what) {
  constexpr py::ssize_t kComponents = sizeof(T) / sizeof(Scalar);
  if (object.is_none()) return {};
  if constexpr (std::is_same_v<Scalar, uint32_t>) check_unsigned(py::array::ensure(object), what);
  const auto array = InputArray<Scalar>::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw Error(std::string(what) + " is no array of numbers; give an array of shape (n" +
                (kComponents > 1 ? ", " + std::to_string(kComponents) : std::string()) + ")");
  }
  if (array.size() == 0) return {};
  const bool fits = kComponents > 1 ? array.ndim() == 2 && array.shape(1) == kComponents : array.ndim() == 1;
  if (!fits) {
    throw Error(std::string(what) + " has the shape " + shape_text(array) + "; give an array of shape (n" +
                (kComponents > 1 ? ", " + std::to_string(kComponents) : std::string()) + ")");
  }
  std::vector<T> values(static_cast<size_t>(array.shape(0)));
  std::memcpy(static_cast<void*>(values.data()), array.data(), values.size() * sizeof(T));
  return values;
}

}  // namespace relume::python

namespace pybind11::detail {

/// Vectors: any sequence of as many numbers; returned as tuples.
template <int length, typename T>
struct type_caster<glm::vec<length, T, glm::defaultp>> {
  using Vector = glm::vec<length, T, glm::defaultp>;
  PYBIND11_TYPE_CASTER(Vector, const_name("tuple[float, ...]"));

  bool load(handle source, bool) {
    if (PyUnicode_Check(source.ptr())) return false;
    const auto array = relume::python::InputArray<T>::ensure(source);
    if (!array) PyErr_Clear();
    if (!array || array.ndim() != 1 || array.size() != length) return false;
    for (int i = 0; i < length; ++i) value[i] = array.at(i);
    return true;
  }
  static handle cast(const Vector& vector, return_value_policy, handle) {
    tuple result(length);
    for (int i = 0; i < length; ++i) result[static_cast<size_t>(i)] = pybind11::cast(vector[i]);
    return result.release();
  }
};

/// Quaternions as (x, y, z, w), the order of glTF.
template <>
struct type_caster<relume::Quaternion> {
  PYBIND11_TYPE_CASTER(relume::Quaternion, const_name("tuple[float, float, float, float]"));

  bool load(handle source, bool convert) {
    type_caster<relume::Vec4> vector;
    if (!vector.load(source, convert)) return false;
    const auto& v = static_cast<relume::Vec4&>(vector);
    value = relume::Quaternion(v.w, v.x, v.y, v.z);
    return true;
  }
  static handle cast(const relume::Quaternion& q, return_value_policy policy, handle parent) {
    return type_caster<relume::Vec4>::cast({q.x, q.y, q.z, q.w}, policy, parent);
  }
};

/// Matrices as arrays of shape (4, 4) that multiply column vectors; relume's own storage is column-major.
template <>
struct type_caster<relume::Mat4> {
  PYBIND11_TYPE_CASTER(relume::Mat4, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const auto array = relume::python::InputArray<float>::ensure(source);
    if (!array) PyErr_Clear();
    if (!array || array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) return false;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) value[column][row] = array.at(row, column);
    }
    return true;
  }
  static handle cast(const relume::Mat4& matrix, return_value_policy, handle) {
    array_t<float> array({4, 4});
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) array.mutable_at(row, column) = matrix[column][row];
    }
    array.attr("flags").attr("writeable") = false;  // a copy: changes would be lost
    return array.release();
  }
};

}  // namespace pybind11::detail
