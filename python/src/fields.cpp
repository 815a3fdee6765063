#include "python/src/fields.h"

#include "core/error.h"

namespace oktett::python {

void check_fields(const Fields& fields, const Fields& known) {
  for (const std::string& field : fields) {
    if (contains(known, field)) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    throw py::value_error("fields: there is no field '" + field + "'" +
                          did_you_mean(field, known, "expected " + names));
  }
}

}  // namespace oktett::python
