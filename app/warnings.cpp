#include "app/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace oktett {

void print_warnings(const std::vector<Warning>& warnings, std::size_t most) {
  const std::size_t shown = std::min(warnings.size(), most);
  for (std::size_t i = 0; i < shown; ++i) fmt::print(stderr, "{}\n", to_string(warnings[i]));
  if (warnings.size() > shown) fmt::print(stderr, "... and {} more warnings\n", warnings.size() - shown);
}

}  // namespace oktett
