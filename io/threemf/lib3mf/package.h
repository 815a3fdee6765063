#pragma once
/// \file The package of a 3MF file, which is a ZIP archive, before lib3mf reads it.

#include <string>
#include <string_view>

namespace oktett {

/// Unpacks all files of the archive and counts their bytes, and what the components of its models show
/// (check_components). Throws Error, which names `path`, if the archive or a file in it is damaged, or if
/// they unpack to more than most_unpacked in all. lib3mf, too, reads archives with libzip, but trusts the
/// sizes that they state.
void check_package(const std::string& path, std::string_view bytes);

}  // namespace oktett
