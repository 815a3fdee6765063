#pragma once
/// \file The files of the page that shows pictures. The build makes their bytes a part of the command.

#include <optional>
#include <string_view>

namespace oktett {

/// The bytes of a file of app/view/page; nothing for other names.
std::optional<std::string_view> page_file(std::string_view name);

}  // namespace oktett
