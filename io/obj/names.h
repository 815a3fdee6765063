#pragma once
/// \file Names of files and materials as programs write them behind OBJ and MTL statements.

#include <string>
#include <string_view>
#include <vector>

namespace oktett {

/// What `text`, all that stands behind a statement, may name, likeliest first: the text as it is; without a
/// comment (`brick.png # old`); with `\ ` as a blank; without quotes; with slashes for the backslashes of
/// Windows. Never empty.
std::vector<std::string> readings_of_name(std::string_view text);

/// The file in `directory` that `text` names: of its readings the first that exists, else what names no
/// comment and has slashes.
std::string find_named_file(const std::string& directory, std::string_view text);

/// `text` up to a `#` with a blank before it; one within a word belongs to the name.
std::string_view without_comment(std::string_view text);

/// The name of a material without a comment, and with `\ ` as a blank: what two spellings of it share.
std::string plain_material_name(std::string_view text);

}  // namespace oktett
