#pragma once
/// \file The JSON text of glTF files before it is parsed. Within io/ only.

#include <string>
#include <string_view>
#include <vector>

namespace oktett {

/// What the JSON of a glTF file may hold beside data URIs: parsers need many times its size.
inline constexpr std::size_t kMostGltfJson = std::size_t{256} << 20;
inline constexpr std::size_t kMostGltfValues = 10'000'000;
inline constexpr int kMostGltfDepth = 64;

struct GltfText {
  std::string json;                    ///< a data URI is replaced by the URI that starts with kGltfDataUri
  std::vector<std::string_view> data;  ///< the data URIs, as they stand in the text
};

/// What stands for a long data URI, followed by its number.
inline constexpr std::string_view kGltfDataUri = "oktett-data:";

/// Takes the long data URIs out of `text`, without a copy. Throws Error, which names `path`, if the rest is
/// larger than the limits above.
GltfText take_out_data(const std::string& path, std::string_view text);

/// The bytes of a data URI in base64. Throws Error, which names `path` and `what` has the URI.
std::string decode_data_uri(const std::string& path, const std::string& what, std::string_view uri);

/// "a b.bin" of "a%20b.bin".
std::string decode_percent(std::string_view uri);

}  // namespace oktett
