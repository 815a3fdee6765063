#include "io/gltf/json_text.h"

#include <array>
#include <cstdint>

#include "core/error.h"

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
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
    throw Error(Location{path}, what + ": expected a data URI in base64");
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

}  // namespace oktett
