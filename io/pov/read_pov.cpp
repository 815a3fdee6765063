#include "io/pov/read_pov.h"

#include "io/pov/interpreter.h"

namespace oktett::pov {

std::vector<std::string> ReadOptions::default_library_folders() {
  return {"/usr/share/povray-3.7/include", "/usr/share/povray/include",
          "/usr/local/share/povray-3.7/include"};
}

Document read_pov(const std::string& path, const ReadOptions& options) {
  Document document;
  if (options.queries != nullptr) options.queries->begin(document);
  Interpreter(options, document).run(path);
  return document;
}

}  // namespace oktett::pov
