#include "core/bytes.h"

#include "core/error.h"
#include "core/hash.h"

namespace oktett {

std::uint64_t checksum(std::string_view bytes) {
  Hasher hash;
  hash.add(std::uint64_t{bytes.size()});
  std::uint64_t word;
  for (; bytes.size() >= sizeof word; bytes.remove_prefix(sizeof word)) {
    std::memcpy(&word, bytes.data(), sizeof word);
    hash.add(word);
  }
  word = 0;
  if (!bytes.empty()) std::memcpy(&word, bytes.data(), bytes.size());
  hash.add(word);
  return hash.value();
}

void append_text(std::string& bytes, std::string_view text) {
  append_number(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

std::string_view ByteReader::take(std::size_t size) {
  if (size > bytes_.size()) throw Error("the file is cut short");
  const std::string_view taken = bytes_.substr(0, size);
  bytes_.remove_prefix(size);
  return taken;
}

std::string ByteReader::text() { return std::string(take(number<std::uint32_t>())); }

std::uint32_t ByteReader::count(std::size_t size) {
  const auto count = number<std::uint32_t>();
  if (count > bytes_.size() / size) throw Error("the file is cut short");
  return count;
}

}  // namespace oktett
