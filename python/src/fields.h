#pragma once
/// \file The fields of answers: which are wanted, and the arrays that hold them.

#include <algorithm>
#include <string>
#include <vector>

#include "python/src/arrays.h"

namespace oktett::python {

using Fields = std::vector<std::string>;

inline bool contains(const Fields& fields, const std::string& name) {
  return std::find(fields.begin(), fields.end(), name) != fields.end();
}

/// Throws ValueError if one of `fields` is not in `known`.
void check_fields(const Fields& fields, const Fields& known);

/// Puts a new array of `shape`, with `components` as its last dimension if that is not 0, into `result` and
/// returns where it lies; None and null if the field is not wanted. The last argument tells the type.
template <class T>
T* make_column(py::dict& result, const char* name, const Fields& wanted, const ArrayShape& shape,
               py::ssize_t components, const T*) {
  result[name] = py::none();
  if (!contains(wanted, name)) return nullptr;
  py::array_t<T> array(components == 0 ? shape : with_last(shape, components));
  result[name] = array;
  return array.mutable_data();
}

}  // namespace oktett::python
