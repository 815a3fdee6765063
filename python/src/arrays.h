#pragma once
/// \file Arrays of numpy that are given to queries: their shapes and types.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

namespace oktett::python {

namespace py = pybind11;

using FloatArray = py::array_t<float, py::array::c_style>;
using ArrayShape = std::vector<py::ssize_t>;

/// "(4, 6)".
std::string shape_text(const py::array& array);

/// `value` as an array of floats whose last dimension is `last`, e.g. of shape (..., 6). It is `value` itself
/// if that is a C-contiguous array of float32, else a copy. Throws ValueError for other shapes, and for what
/// holds no real numbers.
FloatArray float_rows(py::handle value, const char* name, py::ssize_t last);

/// The dimensions of rows without the last one.
ArrayShape row_shape(const FloatArray& rows);

/// One number for each of `shape`, or one for all: tmin and tmax of rays. Throws ValueError for other shapes.
FloatArray float_each(py::handle value, const char* name, const ArrayShape& shape);

/// Indices of shape (m, 3), each below `vertices`. Throws ValueError for others.
py::array_t<std::uint32_t, py::array::c_style> triangle_rows(py::handle value, std::size_t vertices);

/// `shape` with `last` behind it.
ArrayShape with_last(ArrayShape shape, py::ssize_t last);

}  // namespace oktett::python
