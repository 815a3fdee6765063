#include "core/bytes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/error.h"

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

std::uint64_t piece_checksum(const void* data, std::size_t bytes) {
  // Four chains side by side, because the processor waits for each multiplication of one chain. Both steps
  // can be undone, so no difference between two words gets lost.
  constexpr int kChains = 4;
  std::uint64_t state[kChains] = {1, 2, 3, 4};
  const auto step = [](std::uint64_t& s, std::uint64_t word) {
    s = (s ^ word) * 0xbf58476d1ce4e5b9ull;
    s ^= s >> 32;
  };
  const auto* p = static_cast<const unsigned char*>(data);
  std::size_t left = bytes;
  for (; left >= 8 * kChains; left -= 8 * kChains, p += 8 * kChains) {
    std::uint64_t words[kChains];
    std::memcpy(words, p, sizeof words);
    for (int k = 0; k < kChains; ++k) step(state[k], words[k]);
  }
  for (; left > 0; left -= std::min<std::size_t>(left, 8), p += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, p, std::min<std::size_t>(left, 8));
    step(state[0], word);
  }
  Hasher hash;
  for (const std::uint64_t s : state) hash.add(s);
  hash.add(std::uint64_t{bytes});
  return hash.value();
}

/// `sum(first, size)` gives the checksum of the piece of `size` bytes that begins at byte `first`.
template <class Sum>
static std::uint64_t sum_pieces(std::size_t bytes, const Sum& sum) {
  std::vector<std::uint64_t> sums((bytes + kChecksumPiece - 1) / kChecksumPiece);
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t i) {
    const std::size_t first = i * kChecksumPiece;
    sums[i] = sum(first, std::min(kChecksumPiece, bytes - first));
  });
  Hasher hash;
  hash.add(std::uint64_t{bytes});
  for (const std::uint64_t s : sums) hash.add(s);
  return hash.value();
}

std::uint64_t block_checksum(const void* data, std::size_t bytes) {
  const auto* p = static_cast<const unsigned char*>(data);
  return sum_pieces(bytes,
                    [p](std::size_t first, std::size_t size) { return piece_checksum(p + first, size); });
}

std::uint64_t copy_with_checksum(const void* from, void* to, std::size_t bytes) {
  const auto* source = static_cast<const unsigned char*>(from);
  auto* target = static_cast<unsigned char*>(to);
  return sum_pieces(bytes, [=](std::size_t first, std::size_t size) {
    std::memcpy(target + first, source + first, size);
    return piece_checksum(target + first, size);
  });
}

}  // namespace oktett
