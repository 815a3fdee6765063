#pragma once
/// \file The fields of answers: which are wanted, and the arrays that hold them.

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "python/src/arrays.h"
#include "python/src/ray_queries.h"

namespace oktett::python {

using Fields = std::vector<std::string>;

inline bool contains(const Fields& fields, const std::string& name) {
  return std::find(fields.begin(), fields.end(), name) != fields.end();
}

/// Throws ValueError if one of `fields` is not in `known` and names no attribute.
void check_fields(const Fields& fields, const Fields& known);

/// The columns of the attributes that are wanted: "color" and those named "attribute:NAME". A column has the
/// most components that any mesh of the world has. Throws ValueError if no mesh has such an attribute, but
/// for colours.
std::vector<AttributeColumn> attribute_columns(const Fields& fields, const World& world);
/// Puts new arrays of `shape` for them into `result`, as "color" and in a dict "attributes", and has the
/// columns lie there.
void make_attributes(py::dict& result, const ArrayShape& shape, std::vector<AttributeColumn>& columns,
                     const Fields& fields);
/// Calls make(column) for each column, which returns its array, and puts them there likewise.
void put_attributes(py::dict& result, const std::vector<AttributeColumn>& columns, const Fields& fields,
                    const std::function<py::object(std::size_t)>& make);

/// Puts a new array of places, shape (..., 3), into `result` and has the column lie there: in float64 if the
/// world counts from an `origin`, else in float32. None if the field is not wanted.
void make_places(py::dict& result, const char* name, const Fields& wanted, const ArrayShape& shape,
                 const Vec3d& origin, PlaceColumn& column);

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
