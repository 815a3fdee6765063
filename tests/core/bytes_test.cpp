#include "core/bytes.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"

namespace oktett::bytes_test {
namespace {

TEST(Bytes, ReadersGiveBackWhatWasAppended) {
  std::string bytes;
  append_number(bytes, 1.5), append_number(bytes, std::uint32_t{7}), append_text(bytes, "ab");
  append_text(bytes, "");
  EXPECT_EQ(bytes.size(), 8u + 4 + 4 + 2 + 4);
  ByteReader reader(bytes);
  EXPECT_EQ(reader.number<double>(), 1.5);
  EXPECT_EQ(reader.number<std::uint32_t>(), 7u);
  EXPECT_EQ(reader.text(), "ab");
  EXPECT_EQ(reader.text(), "");
  EXPECT_EQ(reader.left(), 0u);
  EXPECT_THROW(reader.take(1), Error);
}

/// A length of 4 GB must not be asked of memory.
TEST(Bytes, LengthsAreComparedWithWhatIsLeft) {
  std::string bytes;
  append_number(bytes, std::uint32_t{0xffffffff});
  bytes += "abcdefg";
  EXPECT_THROW(ByteReader(bytes).text(), Error);
  EXPECT_THROW(ByteReader(bytes).count(1), Error);
  bytes[0] = 7, bytes[1] = bytes[2] = bytes[3] = 0;
  EXPECT_EQ(ByteReader(bytes).text(), "abcdefg");
  EXPECT_EQ(ByteReader(bytes).count(1), 7u);
  EXPECT_THROW(ByteReader(bytes).count(2), Error);
}

TEST(Bytes, ChecksumsTellLengthsAndAllBitsApart) {
  const std::string text = "a checksum of some words";
  std::set<std::uint64_t> seen{checksum(text)};
  for (std::size_t bit = 0; bit < text.size() * 8; ++bit) {
    std::string other = text;
    other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << bit % 8));
    EXPECT_TRUE(seen.insert(checksum(other)).second) << bit;
  }
  for (std::size_t n = 0; n < 20; ++n) EXPECT_TRUE(seen.insert(checksum(std::string(n, '\0'))).second) << n;
}

}  // namespace
}  // namespace oktett::bytes_test
