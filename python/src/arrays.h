#pragma once
/// \file Arrays of numpy that are given to queries: their shapes and types.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/vec3.h"

namespace oktett::python {

namespace py = pybind11;

using FloatArray = py::array_t<float, py::array::c_style>;
using DoubleArray = py::array_t<double, py::array::c_style>;
using ArrayShape = std::vector<py::ssize_t>;

/// The array as one of T, C-contiguous. It is `array` itself if that is such a one, else a copy.
template <class T>
py::array_t<T, py::array::c_style> dense(const py::array& array) {
  auto result = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!result) throw py::error_already_set();
  return py::reinterpret_borrow<py::array_t<T, py::array::c_style>>(result);
}

/// The fewest digits that give back the number.
inline std::string number_text(double number) { return py::str(py::float_(number)); }

/// "(4, 6)".
std::string shape_text(const py::array& array);

/// `value` as an array of real numbers of any type whose last dimension is `last`, e.g. of shape (..., 6).
/// Throws ValueError for others.
py::array number_rows(py::handle value, const char* name, py::ssize_t last);
/// The same in float32. It is `value` itself if that is a C-contiguous array of float32, else a copy.
FloatArray float_rows(py::handle value, const char* name, py::ssize_t last);

/// Rows that begin with a place, such as points or rays, in float32, with the place counted from `origin`,
/// which is taken off in double. It is `rows` itself if nothing has to be changed.
FloatArray floats_from(const Vec3d& origin, const py::array& rows);

/// The dimensions of rows without the last one.
ArrayShape row_shape(const py::array& rows);

/// One number for each of `shape`, or one for all: tmin and tmax of rays. Throws ValueError for other shapes.
FloatArray float_each(py::handle value, const char* name, const ArrayShape& shape);

/// Indices of shape (m, 3), each below `vertices`. Throws ValueError for others.
py::array_t<std::uint32_t, py::array::c_style> triangle_rows(py::handle value, std::size_t vertices);

/// `shape` with `last` behind it.
ArrayShape with_last(ArrayShape shape, py::ssize_t last);

}  // namespace oktett::python
