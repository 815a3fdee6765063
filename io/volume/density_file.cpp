#include "io/volume/density_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "io/text/file_content.h"
#include "io/text/files.h"
#include "io/text/scan.h"

namespace oktett {
namespace {

class DensityReader {
 public:
  DensityReader(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

  std::shared_ptr<const DensityGrid> read() {
    if (line() != "oktett density grid 1") fail("expected the line 'oktett density grid 1'");
    read_size();
    const std::string_view kind = line();
    if (kind != "values float32" && kind != "values text") fail("expected 'values float32' or 'values text'");
    return std::make_shared<const DensityGrid>(size_[0], size_[1], size_[2],
                                               kind == "values text" ? read_text() : read_floats());
  }

 private:
  std::string_view line() {
    ++line_;
    if (rest_.find('\n') == std::string_view::npos) fail("the file ends here; expected another line");
    std::string_view text = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(text.size() + 1);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }

  void read_size() {
    const std::string_view text = line();
    const std::string expected =
        fmt::format("expected 'size NX NY NZ', three numbers from 2 to {}", kMostDensitySide);
    if (!text.starts_with("size ")) fail(expected);
    const char *at = text.data() + 4, *end = text.data() + text.size();
    count_ = 1;
    for (std::uint32_t& side : size_) {
      if (at == end || *at != ' ') fail(expected);
      const auto [stop, error] = std::from_chars(at + 1, end, side);
      if (error != std::errc() || side < 2 || side > kMostDensitySide) fail(expected);
      at = stop;
      count_ *= side;
    }
    if (at != end) fail(expected);
    if (count_ > kMostDensities) fail(fmt::format("a grid has at most {} values", kMostDensities));
  }

  Column<float> read_floats() {
    static_assert(std::endian::native == std::endian::little, "values are copied as they are");
    if (rest_.size() != count_ * sizeof(float))
      fail(fmt::format("expected {} bytes of values after this line, found {}", count_ * sizeof(float),
                       rest_.size()));
    Column<float> values(count_);
    std::memcpy(values.data(), rest_.data(), rest_.size());
    for (std::size_t i = 0; i < count_; ++i) check(i, static_cast<double>(values[i]));
    return values;
  }

  Column<float> read_text() {
    // Each value takes a digit and a blank, so a short file cannot ask for much memory.
    Column<float> values(std::min(count_, rest_.size() / 2 + 1));
    const char *at = rest_.data(), *end = at + rest_.size();
    const auto skip_blanks = [&] {
      for (; at != end && (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n'); ++at)
        line_ += *at == '\n' ? 1 : 0;
    };
    ++line_;
    for (std::size_t i = 0; i < count_; ++i) {
      skip_blanks();
      if (at == end) fail(fmt::format("expected {} values, found {}", count_, i));
      double value = 0;
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error == std::errc::invalid_argument) fail("expected a number");
      check(i, error == std::errc() ? value : HUGE_VAL);
      values[i] = static_cast<float>(value);
      at = stop;
    }
    skip_blanks();
    if (at != end) fail(fmt::format("expected {} values, found more", count_));
    return values;
  }

  void check(std::size_t i, double value) const {
    if (value >= 0 && value <= kMostDensity) return;
    const std::size_t x = i % size_[0], y = i / size_[0] % size_[1], z = i / size_[0] / size_[1];
    fail(fmt::format("the value at x {}, y {}, z {} is {:g}; expected a density from 0 to {:g}", x, y, z,
                     value, kMostDensity));
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(Location{path_, line_, 0}, message);
  }

  static constexpr double kMostDensity = 1e9;

  const std::string& path_;
  std::string_view rest_;
  int line_ = 0;
  std::uint32_t size_[3] = {};
  std::size_t count_ = 0;
};

/// The grid of a DF3 file.
std::shared_ptr<const DensityGrid> read_df3(const std::string& path, std::string_view bytes) {
  const auto fail = [&](const std::string& message) { throw Error(Location{path}, message); };
  const auto number = [&](std::size_t at, std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  constexpr std::size_t kHeader = 6;
  if (bytes.size() < kHeader) fail("expected three sides of two bytes each");
  std::uint32_t side[3];
  std::size_t count = 1, stored = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    side[k] = number(2 * k, 2);
    if (side[k] < 1 || side[k] >= kMostDensitySide)
      fail(fmt::format("expected sides from 1 to {}, found {}", kMostDensitySide - 1, side[k]));
    count *= side[k], stored *= std::size_t{side[k]} + 1;
  }
  if (stored > kMostDensities) fail(fmt::format("a grid has at most {} values", kMostDensities));
  const std::size_t size = (bytes.size() - kHeader) / count;
  if ((size != 1 && size != 2 && size != 4) || size * count != bytes.size() - kHeader)
    fail(fmt::format("expected {} values of 1, 2 or 4 bytes each, found {} bytes", count,
                     bytes.size() - kHeader));
  const double most = std::ldexp(1.0, static_cast<int>(8 * size)) - 1;
  Column<float> values(stored);
  std::size_t next = 0;
  for (std::uint32_t z = 0; z <= side[2]; ++z)
    for (std::uint32_t y = 0; y <= side[1]; ++y)
      for (std::uint32_t x = 0; x <= side[0]; ++x) {
        const std::size_t from = (std::size_t{z % side[2]} * side[1] + y % side[1]) * side[0] + x % side[0];
        values[next++] = static_cast<float>(number(kHeader + from * size, size) / most);
      }
  return std::make_shared<const DensityGrid>(side[0] + 1, side[1] + 1, side[2] + 1, std::move(values));
}

}  // namespace

std::shared_ptr<const DensityGrid> read_density_file(const std::string& path) {
  const MappedFile file(path);
  if (lower_case_extension(path) == ".df3") return read_df3(path, file.text());
  return DensityReader(path, without_byte_order_mark(file.text())).read();
}

}  // namespace oktett
