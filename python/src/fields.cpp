#include "python/src/fields.h"

#include <string_view>

#include "core/error.h"

namespace oktett::python {

static constexpr std::string_view kAttributeField = "attribute:";

void check_fields(const Fields& fields, const Fields& known) {
  for (const std::string& field : fields) {
    if (contains(known, field) || field.starts_with(kAttributeField)) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    throw py::value_error("fields: there is no field '" + field + "'" +
                          did_you_mean(field, known, "expected " + names));
  }
}

namespace {

/// The most components that an attribute of this name has; 0 if no mesh has one.
std::uint32_t components_of(const std::string& name, const World& world) {
  std::uint32_t most = 0;
  for (const auto& mesh : world.meshes)
    if (const MeshAttribute* const attribute = find_attribute(*mesh, name))
      most = std::max(most, attribute->components);
  return most;
}

[[noreturn]] void fail_unknown(const std::string& name, const World& world) {
  std::vector<std::string> known;
  for (const auto& mesh : world.meshes)
    for (const MeshAttribute& attribute : mesh->attributes)
      if (!contains(known, attribute.name)) known.push_back(attribute.name);
  throw py::value_error("fields: no mesh has an attribute '" + name + "'" + did_you_mean(name, known));
}

}  // namespace

std::vector<AttributeColumn> attribute_columns(const Fields& fields, const World& world) {
  std::vector<AttributeColumn> columns;
  if (contains(fields, kColorAttribute)) columns.push_back({kColorAttribute, 3, nullptr});
  for (const std::string& field : fields) {
    if (!field.starts_with(kAttributeField)) continue;
    const std::string name = field.substr(kAttributeField.size());
    const std::uint32_t components = components_of(name, world);
    if (components == 0) fail_unknown(name, world);
    columns.push_back({name, components, nullptr});
  }
  return columns;
}

void make_places(py::dict& result, const char* name, const Fields& wanted, const ArrayShape& shape,
                 const Vec3d& origin, PlaceColumn& column) {
  column.origin = origin;
  if (origin == Vec3d{})
    column.floats = make_column(result, name, wanted, shape, 3, column.floats);
  else
    column.doubles = make_column(result, name, wanted, shape, 3, column.doubles);
}

void put_attributes(py::dict& result, const std::vector<AttributeColumn>& columns, const Fields& fields,
                    const std::function<py::object(std::size_t)>& make) {
  result["color"] = py::none(), result["attributes"] = py::none();
  const std::size_t first = contains(fields, kColorAttribute) ? 1 : 0;
  py::dict named;
  for (std::size_t i = 0; i < columns.size(); ++i)
    (i < first ? result[py::str("color")] : named[py::str(columns[i].name)]) = make(i);
  if (columns.size() > first) result["attributes"] = named;
}

void make_attributes(py::dict& result, const ArrayShape& shape, std::vector<AttributeColumn>& columns,
                     const Fields& fields) {
  put_attributes(result, columns, fields, [&](std::size_t i) -> py::object {
    AttributeColumn& column = columns[i];
    const bool scalar = column.components == 1;
    py::array_t<float> array(scalar ? shape : with_last(shape, static_cast<py::ssize_t>(column.components)));
    column.values = array.mutable_data();
    return array;
  });
}

}  // namespace oktett::python
