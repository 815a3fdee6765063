#include "io/gltf/gltf_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "io/mesh/reading.h"
#include "io/text/scan.h"

namespace oktett {

namespace {

constexpr std::size_t kLongUri = 256;

constexpr std::uint8_t kNoDigit = 64;

constexpr std::array<std::uint8_t, 256> base64_digits() {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(kNoDigit);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    digits[static_cast<unsigned char>(kDigits[i])] = static_cast<std::uint8_t>(i);
  return digits;
}

constexpr std::array<std::uint8_t, 256> kDigitOf = base64_digits();

/// The place of the quote that ends the string whose first character is at `p`.
std::size_t string_end(std::string_view text, std::size_t p) {
  for (;;) {
    p = text.find_first_of("\"\\", p);
    if (p == std::string_view::npos) return text.size();
    if (text[p] == '"') return p;
    p += 2;
    if (p > text.size()) return text.size();
  }
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = static_cast<char>(c | 0x20);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

}  // namespace

GltfText take_out_data(const std::string& path, std::string_view text) {
  GltfText result;
  std::size_t values = 0, kept = 0;
  int depth = 0;
  const auto keep = [&](std::size_t end) { result.json.append(text.substr(kept, end - kept)); };
  for (std::size_t p = 0; p < text.size(); ++p) {
    switch (text[p]) {
      case '{':
      case '[':
        if (++depth > kMostGltfDepth)
          throw Error(Location{path},
                      "the JSON is nested deeper than " + std::to_string(kMostGltfDepth) + " levels");
        ++values;
        break;
      case '}':
      case ']':
        --depth;
        break;
      case ',':
        ++values;
        break;
      case '"': {
        const std::size_t begin = p + 1;
        p = string_end(text, begin);
        const std::string_view word = text.substr(begin, p - begin);
        if (word.size() < kLongUri || !word.starts_with("data:")) break;
        keep(begin);
        kept = p;
        result.json.append(kGltfDataUri).append(std::to_string(result.data.size()));
        result.data.push_back(word);
        break;
      }
      default:
        break;
    }
    if (values > kMostGltfValues)
      throw Error(Location{path}, "the JSON has more than " + std::to_string(kMostGltfValues) + " values");
    if (p - kept + result.json.size() > kMostGltfJson && p < text.size())
      throw Error(Location{path}, "the JSON is larger than " + std::to_string(kMostGltfJson >> 20) + " MiB");
  }
  keep(text.size());
  return result;
}

std::string decode_data_uri(const std::string& path, const std::string& what, std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) throw Error(Location{path}, what + ": expected a data URI");
  if (!uri.substr(0, comma).ends_with(";base64")) return decode_percent(uri.substr(comma + 1));
  std::string bytes;
  bytes.resize((uri.size() - comma) / 4 * 3 + 3);
  auto* out = reinterpret_cast<unsigned char*>(bytes.data());
  std::uint32_t bits = 0;
  int digits = 0;
  std::size_t p = comma + 1;
  for (; p < uri.size(); ++p) {
    const std::uint8_t digit = kDigitOf[static_cast<unsigned char>(uri[p])];
    if (digit == kNoDigit) {
      // JSON may write a slash as \/.
      if (uri[p] == '\\' && p + 1 < uri.size() && uri[p + 1] == '/') continue;
      break;
    }
    bits = bits << 6 | digit;
    if (++digits < 4) continue;
    *out++ = static_cast<unsigned char>(bits >> 16);
    *out++ = static_cast<unsigned char>(bits >> 8);
    *out++ = static_cast<unsigned char>(bits);
    digits = 0;
  }
  if (uri.substr(p).find_first_not_of('=') != std::string_view::npos || digits == 1)
    throw Error(Location{path}, what + ": its data URI is not base64 at character " + std::to_string(p));
  if (digits >= 2) *out++ = static_cast<unsigned char>(bits >> (digits == 2 ? 4 : 10));
  if (digits == 3) *out++ = static_cast<unsigned char>(bits >> 2);
  bytes.resize(static_cast<std::size_t>(out - reinterpret_cast<unsigned char*>(bytes.data())));
  return bytes;
}

std::string decode_percent(std::string_view uri) {
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    path += low >= 0 ? static_cast<char>(16 * high + low) : uri[i];
    if (low >= 0) i += 2;
  }
  return path;
}

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

GltfFile::GltfFile(const std::string& path, const std::string& variant) : path_(path), file_(path) {
  split_chunks(file_.text());
  total_bytes_ = file_.text().size();
  text_ = take_out_data(path_, json_);
  model_ = parse_gltf(path_, text_.json, is_binary_);
  text_.json = {};
  buffers_.resize(model_.buffers.size());
  if (!variant.empty()) choose_variant(variant);
}

void GltfFile::choose_variant(const std::string& name) {
  const auto found = std::ranges::find(model_.variants, name);
  if (found == model_.variants.end()) {
    std::string names;
    for (const std::string& known : model_.variants) names += (names.empty() ? "" : ", ") + quote_name(known);
    fail("there is no variant " + quote_name(name) + "; " +
         (names.empty() ? "the file has none" : "expected one of " + names));
  }
  const auto number = static_cast<std::uint32_t>(found - model_.variants.begin());
  for (GltfMesh& mesh : model_.meshes)
    for (GltfPrimitive& primitive : mesh.primitives)
      if (const auto material = primitive.variants.find(number); material != primitive.variants.end())
        primitive.material = material->second;
}

std::string_view GltfFile::buffer(std::uint32_t number) const {
  Buffer& buffer = buffers_[number];
  if (buffer.is_open) return buffer.bytes;
  const GltfSource& source = model_.buffers[number];
  const std::string where = "buffers[" + std::to_string(number) + "]";
  const std::string_view bytes = open_buffer(number, where);
  if (!source.is_fallback && bytes.size() < source.length)
    fail(where + ": expected " + std::to_string(source.length) + " bytes, found " +
         std::to_string(bytes.size()));
  buffer = {true, bytes.substr(0, source.length)};
  return buffer.bytes;
}

void GltfFile::fail(const std::string& message) const { throw Error(Location{path_}, message); }

void GltfFile::split_chunks(std::string_view text) {
  is_binary_ = text.starts_with("glTF");
  if (!is_binary_) {
    json_ = without_byte_order_mark(text);
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

std::string_view GltfFile::open_buffer(std::uint32_t number, const std::string& where) const {
  const GltfSource& source = model_.buffers[number];
  if (number == 0 && is_binary_ && source.uri.empty() && !source.is_fallback) return binary_;
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
  const std::string_view buffer = this->buffer(range.buffer);
  if (range.offset > buffer.size() || range.length > buffer.size() - range.offset)
    fail(where + ": bytes " + std::to_string(range.offset) + " to " +
         std::to_string(range.offset + range.length) + " of buffer " + std::to_string(range.buffer) +
         ", which has " + std::to_string(buffer.size()));
  return buffer.substr(range.offset, range.length);
}

}  // namespace oktett
