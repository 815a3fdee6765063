#include "app/output_files.h"

#include <fmt/format.h>

#include <cstddef>

#include "core/error.h"
#include "io/image/output.h"

namespace oktett {

void check_files_differ(const std::vector<NamedFile>& files) {
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (!files[i].path.empty() && !files[k].path.empty() && is_same_output(files[i].path, files[k].path))
        throw Error(
            fmt::format("{} and {} name the same file '{}'; expected two files, since one would replace "
                        "the other",
                        files[k].name, files[i].name, files[i].path));
}

}  // namespace oktett
