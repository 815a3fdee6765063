#include "io/pov/document.h"

namespace oktett::pov {

Location Document::location(const Place& where) const {
  if (where.file >= files.size()) return {};
  return {files[where.file], static_cast<int>(where.line), static_cast<int>(where.column)};
}

Error Document::error(const Place& where, const std::string& message) const {
  constexpr int most = 8;  // of a recursive macro the innermost tell enough
  std::string text = message;
  std::uint32_t call = where.call;
  for (int i = 0; call < calls.size(); ++i) {
    const MacroCall& macro = calls[call];
    if (i == most) {
      text += ", ...";
      break;
    }
    text +=
        (i == 0 ? "; in macro '" : ", in '") + macro.name + "' called at " + to_string(location(macro.where));
    call = macro.where.call;
  }
  return Error(location(where), text);
}

}  // namespace oktett::pov
