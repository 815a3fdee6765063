#pragma once
/// \file A glTF file: its JSON text before it is parsed, its buffers, and its materials as ours. Within io/
/// only.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/gltf.h"
#include "io/gltf/model.h"
#include "io/text/file_content.h"

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

/// The bytes of a data URI, in base64 or percent-encoded. Throws Error, which names `path` and `what` has the
/// URI.
std::string decode_data_uri(const std::string& path, const std::string& what, std::string_view uri);

/// "a b.bin" of "a%20b.bin".
std::string decode_percent(std::string_view uri);

class GltfFile {
 public:
  /// Reads the JSON: a file that begins with `glTF` is a GLB file, any other is text. Primitives have the
  /// materials of the variant of that name, if one is given. Throws Error.
  explicit GltfFile(const std::string& path, const std::string& variant = "");
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const std::string& path() const { return path_; }
  const GltfModel& model() const { return model_; }

  /// The bytes of a range, for one thread at a time. Throws Error, which begins with `where`, if they are not
  /// all there.
  std::string_view bytes(const GltfRange& range, const std::string& where) const;
  /// Bytes of the file and of all buffers beside it that were used so far.
  std::uint64_t total_bytes() const { return total_bytes_; }
  /// The bytes of a data URI, decoded.
  std::string data_uri(std::uint32_t number, const std::string& where) const;
  /// The path that the URI of a file beside this one leads to.
  std::string path_of(const std::string& uri, const std::string& where) const;

  /// "PATH: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  /// A buffer, opened when it is first asked for: those that are not used may be missing.
  struct Buffer {
    bool is_open = false;
    std::string_view bytes;
  };

  void split_chunks(std::string_view text);
  void choose_variant(const std::string& name);
  std::string_view buffer(std::uint32_t number) const;
  std::string_view open_buffer(std::uint32_t number, const std::string& where) const;

  std::string path_;
  FileContent file_;
  std::string_view json_, binary_;
  bool is_binary_ = false;
  GltfText text_;
  GltfModel model_;
  mutable std::vector<std::unique_ptr<FileContent>> files_;
  mutable std::vector<std::unique_ptr<std::string>> decoded_;
  mutable std::vector<Buffer> buffers_;
  mutable std::uint64_t total_bytes_ = 0;
};

/// How steeply a mask goes from nothing to all: a hard edge, as glTF has it. What is equal to the cutoff is
/// all there, however the numbers are rounded.
inline constexpr float kGltfMaskSlope = 1e4f, kGltfMaskAtCutoff = 1 + 0x1p-9f;

/// Sets the materials and textures of `scene`; the images of textures that are not in files are copied from
/// the buffers. Throws Error.
void add_gltf_materials(const GltfFile& file, FileScene& scene);

}  // namespace oktett
