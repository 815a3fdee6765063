#include "kernels/open_surface.h"

namespace oktett {

bool is_open(const ExactShape& shape) {
  return std::visit(
      [](const auto& form) {
        // Without a box a quadric or a blob has no faces that could be missing.
        if constexpr (requires { form.clipped; })
          return form.open && form.clipped;
        else if constexpr (requires { form.bounded; })
          return form.open && form.bounded;
        else if constexpr (requires { form.open; })
          return form.open;
        else
          return false;
      },
      shape.form);
}

}  // namespace oktett
