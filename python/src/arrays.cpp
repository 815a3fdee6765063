#include "python/src/arrays.h"

namespace oktett::python {
namespace {

[[noreturn]] void fail(const char* name, const std::string& expected, const std::string& found) {
  throw py::value_error(std::string(name) + ": expected " + expected + ", found " + found);
}

std::string text_of(const ArrayShape& shape) {
  std::string text = "(";
  for (std::size_t k = 0; k < shape.size(); ++k) text += (k > 0 ? ", " : "") + std::to_string(shape[k]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

ArrayShape shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

/// Throws ValueError unless `value` is, or can become, an array of real numbers.
py::array number_array(py::handle value, const char* name, const std::string& expected) {
  // What lies under the mask of a masked array is no number of the caller's, and conversion would take it for
  // one.
  if (py::hasattr(value, "mask") && py::hasattr(value, "filled")) fail(name, expected, "a masked array");
  py::array array = py::array::ensure(value);
  if (!array) {
    PyErr_Clear();
    fail(name, expected, "an object of type " + std::string(py::str(py::type::of(value).attr("__name__"))));
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    fail(name, expected, "elements of type " + std::string(py::str(array.dtype())));
  return array;
}

}  // namespace

std::string shape_text(const py::array& array) { return text_of(shape_of(array)); }

py::array number_rows(py::handle value, const char* name, py::ssize_t last) {
  const std::string expected = "an array of numbers of shape (..., " + std::to_string(last) + ")";
  const py::array array = number_array(value, name, expected);
  if (array.ndim() < 1 || array.shape(array.ndim() - 1) != last)
    fail(name, expected, "the shape " + shape_text(array));
  return array;
}

FloatArray float_rows(py::handle value, const char* name, py::ssize_t last) {
  return dense<float>(number_rows(value, name, last));
}

FloatArray floats_from(const Vec3d& origin, const py::array& rows) {
  if (origin == Vec3d{}) return dense<float>(rows);
  const DoubleArray from = dense<double>(rows);
  FloatArray result(shape_of(rows));
  const py::ssize_t size = rows.size(), last = rows.shape(rows.ndim() - 1);
  const double* const in = from.data();
  float* const out = result.mutable_data();
  for (py::ssize_t i = 0; i < size; i += last)
    for (py::ssize_t k = 0; k < last; ++k)
      out[i + k] = static_cast<float>(k < 3 ? in[i + k] - origin[static_cast<int>(k)] : in[i + k]);
  return result;
}

ArrayShape row_shape(const py::array& rows) { return {rows.shape(), rows.shape() + rows.ndim() - 1}; }

FloatArray float_each(py::handle value, const char* name, const ArrayShape& shape) {
  const std::string expected = "a number or an array of shape " + text_of(shape);
  const py::array array = number_array(value, name, expected);
  if (array.ndim() != 0 && shape_of(array) != shape) fail(name, expected, "the shape " + shape_text(array));
  return dense<float>(array);
}

py::array_t<std::uint32_t, py::array::c_style> triangle_rows(py::handle value, std::size_t vertices) {
  const char* const name = "faces";
  const std::string expected = "an array of whole numbers of shape (m, 3)";
  const py::array array = number_array(value, name, expected);
  if (array.ndim() != 2 || array.shape(1) != 3) fail(name, expected, "the shape " + shape_text(array));
  if (array.dtype().kind() == 'f' && array.size() > 0)
    fail(name, expected, "elements of type " + std::string(py::str(array.dtype())));
  // As 64 bits, so that negative numbers stay what they are; those beyond become negative.
  using Wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
  using Narrow = py::array_t<std::uint32_t, py::array::c_style>;
  const bool is_narrow =
      array.dtype().kind() == 'u' && array.itemsize() == 4 && (array.flags() & py::array::c_style) != 0;
  const auto check = [&](std::int64_t index, py::ssize_t k) {
    if (index >= 0 && static_cast<std::uint64_t>(index) < vertices) return;
    throw py::value_error("faces: row " + std::to_string(k / 3) + " names vertex " + std::to_string(index) +
                          ", expected 0 to " + std::to_string(vertices) + " - 1");
  };
  const py::ssize_t size = array.size();
  if (is_narrow) {
    Narrow narrow = py::reinterpret_borrow<Narrow>(array);
    for (py::ssize_t k = 0; k < size; ++k) check(narrow.data()[k], k);
    return narrow;
  }
  const auto wide = Wide::ensure(array);
  if (!wide) throw py::error_already_set();
  Narrow narrow(ArrayShape{array.shape(0), 3});
  for (py::ssize_t k = 0; k < size; ++k) {
    check(wide.data()[k], k);
    narrow.mutable_data()[k] = static_cast<std::uint32_t>(wide.data()[k]);
  }
  return narrow;
}

ArrayShape with_last(ArrayShape shape, py::ssize_t last) {
  shape.push_back(last);
  return shape;
}

}  // namespace oktett::python
