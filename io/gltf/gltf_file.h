#pragma once
/// \file A glTF file with its buffers. Within io/ only.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/json_text.h"
#include "io/gltf/model.h"
#include "io/text/file_content.h"

namespace oktett {

class GltfFile {
 public:
  /// Reads the JSON and opens all buffers: a file that begins with `glTF` is a GLB file, any other is text.
  /// Throws Error.
  explicit GltfFile(const std::string& path);
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const std::string& path() const { return path_; }
  const GltfModel& model() const { return model_; }

  /// The bytes of a range. Throws Error, which begins with `where`, if they are not all there.
  std::string_view bytes(const GltfRange& range, const std::string& where) const;
  /// Bytes of the file and of all buffers beside it.
  std::uint64_t total_bytes() const { return total_bytes_; }
  /// The bytes of a data URI, decoded.
  std::string data_uri(std::uint32_t number, const std::string& where) const;
  /// The path that the URI of a file beside this one leads to.
  std::string path_of(const std::string& uri, const std::string& where) const;

  /// "PATH: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void split_chunks(std::string_view text);
  std::string_view open_buffer(const GltfSource& source, const std::string& where);

  std::string path_;
  FileContent file_;
  std::string_view json_, binary_;
  bool is_binary_ = false;
  GltfText text_;
  GltfModel model_;
  std::vector<std::unique_ptr<FileContent>> files_;
  std::vector<std::unique_ptr<std::string>> decoded_;
  std::vector<std::string_view> buffers_;
  std::uint64_t total_bytes_ = 0;
};

}  // namespace oktett
