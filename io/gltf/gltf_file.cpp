#include "io/gltf/gltf_file.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "io/mesh/failure.h"

namespace oktett {
namespace {

constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

std::uint32_t number_at(std::string_view text, std::size_t at) {
  std::uint32_t number = 0;
  std::memcpy(&number, text.data() + at, sizeof number);
  return number;
}

/// Whether the URI begins with a scheme, as in `http:`.
bool has_scheme(std::string_view uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  return end != std::string_view::npos && end > 0 && uri[end] == ':';
}

}  // namespace

GltfFile::GltfFile(const std::string& path) : path_(path), file_(path) {
  split_chunks(file_.text());
  total_bytes_ = file_.text().size();
  text_ = take_out_data(path_, json_);
  model_ = parse_gltf(path_, text_.json, is_binary_);
  text_.json = {};
  bool is_first = true;
  for (const GltfSource& source : model_.buffers) {
    const std::string where = "buffers[" + std::to_string(buffers_.size()) + "]";
    std::string_view bytes;
    if (is_first && is_binary_ && source.uri.empty() && !source.is_fallback)
      bytes = binary_;
    else
      bytes = open_buffer(source, where);
    is_first = false;
    if (!source.is_fallback && bytes.size() < source.length)
      fail(where + ": expected " + std::to_string(source.length) + " bytes, found " +
           std::to_string(bytes.size()));
    buffers_.push_back(bytes.substr(0, source.length));
  }
}

void GltfFile::fail(const std::string& message) const { throw Error(Location{path_}, message); }

void GltfFile::split_chunks(std::string_view text) {
  is_binary_ = text.starts_with("glTF");
  if (!is_binary_) {
    json_ = text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
    return;
  }
  if (text.size() < kHeaderBytes)
    fail("the file ends within its header, at byte " + std::to_string(text.size()));
  if (number_at(text, 4) != 2)
    fail("expected version 2 of the format, found " + std::to_string(number_at(text, 4)));
  const std::size_t length = number_at(text, 8);
  if (length > text.size())
    fail("byte 8: the file should have " + std::to_string(length) + " bytes, but ends at byte " +
         std::to_string(text.size()));
  text = text.substr(0, length);
  for (std::size_t at = kHeaderBytes, chunk = 0; at + kChunkHeaderBytes <= text.size(); ++chunk) {
    const std::size_t size = number_at(text, at), begin = at + kChunkHeaderBytes;
    const std::uint32_t kind = number_at(text, at + 4);
    if (size > text.size() - begin)
      fail("byte " + std::to_string(at) + ": a chunk of " + std::to_string(size) +
           " bytes, but the file ends at byte " + std::to_string(text.size()));
    if (chunk == 0 && kind != kJsonChunk) fail("byte 16: expected the chunk with the JSON first");
    if (chunk == 0) json_ = text.substr(begin, size);
    if (chunk == 1 && kind == kBinaryChunk) binary_ = text.substr(begin, size);
    at = begin + std::min(text.size() - begin, (size + 3) / 4 * 4);
  }
  if (json_.data() == nullptr) fail("expected a chunk with the JSON behind the header");
}

std::string_view GltfFile::open_buffer(const GltfSource& source, const std::string& where) {
  if (source.is_fallback && source.uri.empty()) return {};
  if (source.data_uri != kNoId || source.uri.starts_with("data:")) {
    const std::string& decoded = *decoded_.emplace_back(
        std::make_unique<std::string>(source.data_uri != kNoId ? data_uri(source.data_uri, where)
                                                               : decode_data_uri(path_, where, source.uri)));
    return decoded;
  }
  if (source.uri.empty()) fail(where + ": has no uri, and the file no bytes of its own for it");
  const FileContent& file = *files_.emplace_back(std::make_unique<FileContent>(path_of(source.uri, where)));
  total_bytes_ += file.text().size();
  return file.text();
}

std::string GltfFile::data_uri(std::uint32_t number, const std::string& where) const {
  if (number >= text_.data.size()) fail(where + ": expected a uri");
  return decode_data_uri(path_, where, text_.data[number]);
}

std::string GltfFile::path_of(const std::string& uri, const std::string& where) const {
  if (has_scheme(uri)) fail(where + ": expected the path of a file, found " + quote_name(uri));
  return (std::filesystem::path(path_).parent_path() / decode_percent(uri)).string();
}

std::string_view GltfFile::bytes(const GltfRange& range, const std::string& where) const {
  const std::string_view buffer = buffers_[range.buffer];
  if (range.offset > buffer.size() || range.length > buffer.size() - range.offset)
    fail(where + ": bytes " + std::to_string(range.offset) + " to " +
         std::to_string(range.offset + range.length) + " of buffer " + std::to_string(range.buffer) +
         ", which has " + std::to_string(buffer.size()));
  return buffer.substr(range.offset, range.length);
}

}  // namespace oktett
