#include "io/obj/colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/math.h"
#include "core/parallel.h"

namespace oktett {
namespace {

/// 10^-k.
constexpr double kTenths[] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};
/// Six digits of a number that is a whole 255th.
constexpr double kLevelSlack = 4e-4;

/// The level of the number at `p`, which is moved behind it; -1 if it is none.
int read_level(const char*& p) {
  const unsigned whole = static_cast<unsigned char>(*p) - unsigned{'0'};
  if (whole > 1) return -1;
  double number = whole;
  if (*++p == '.') {
    const std::uint64_t digits = detail::load_digits(++p);
    const int count = detail::count_digits(digits);
    if (count == 0) return -1;
    // Those behind the seventh do not matter.
    const int kept = std::min(count, 7);
    number += static_cast<double>(detail::digits_value(digits, kept)) * kTenths[kept];
    p += count;
    while (*p >= '0' && *p <= '9') ++p;
  }
  if (!is_blank(*p) && !is_line_end(*p)) return -1;
  const double level = number * 255;
  const int rounded = static_cast<int>(level + 0.5);
  return rounded <= 255 && std::abs(level - rounded) <= kLevelSlack ? rounded : -1;
}

/// The curve above its straight start in pieces of 1 / 256, each a cubic with the values and slopes of its
/// ends: off by less than 2^-27 of a value.
class CurvePieces {
 public:
  static constexpr int kPieces = 256, kFirst = 10;

  CurvePieces() {
    for (int i = kFirst; i < kPieces; ++i) {
      const auto at = [](double s, double power) { return portable::pow((s + 0.055) / 1.055, power); };
      const double h = 1.0 / kPieces, a = i * h, b = a + h;
      const double fa = at(a, 2.4), fb = at(b, 2.4);
      const double da = 2.4 / 1.055 * at(a, 1.4) * h, db = 2.4 / 1.055 * at(b, 1.4) * h;
      pieces_[static_cast<std::size_t>(i)] = {fa, da, 3 * (fb - fa) - 2 * da - db, 2 * (fa - fb) + da + db};
    }
  }

  /// For numbers from kFirst / kPieces up to 1.
  double operator()(double s) const {
    const int i = std::min(static_cast<int>(s * kPieces), kPieces - 1);
    const double t = s * kPieces - i;
    const std::array<double, 4>& c = pieces_[static_cast<std::size_t>(i)];
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
  }

 private:
  std::array<std::array<double, 4>, kPieces> pieces_{};
};

}  // namespace

ObjColors& ObjColors::operator+=(const ObjColors& later) {
  count += later.count;
  if (without == nullptr) without = later.without;
  greatest = std::max(greatest, later.greatest);
  are_bytes = are_bytes && later.are_bytes;
  are_whole = are_whole && later.are_whole;
  return *this;
}

const char* read_color_levels(const char* p, std::uint8_t* out) {
  for (int k = 0; k < 3; ++k) {
    while (is_blank(*p)) ++p;
    const int level = read_level(p);
    if (level < 0) return nullptr;
    out[k] = static_cast<std::uint8_t>(level);
  }
  while (is_blank(*p)) ++p;
  return p;
}

float linear_of_obj_color(float encoded) {
  static const CurvePieces pieces;
  if (encoded <= 0.04045f || !(encoded <= 1)) return linear_of_srgb(static_cast<double>(encoded));
  return static_cast<float>(pieces(static_cast<double>(encoded)));
}

void set_colors(TriangleMesh& mesh, const ObjColors& found, ObjColorColumns colors) {
  MeshAttribute color;
  color.name = kColorAttribute, color.components = 3;
  Column<float>& numbers = colors.numbers;
  const bool up_to_255 = found.greatest > 1 && found.are_whole;
  if (numbers.empty()) {
    color.srgb = std::move(colors.levels.empty() ? colors.painted : colors.levels);
  } else if (up_to_255 || (found.are_bytes && found.greatest <= 1)) {
    const float scale = up_to_255 ? 1 : 255;
    color.srgb.resize_uninitialized(numbers.size());
    for_all(numbers.size(), [&](std::size_t i) {
      color.srgb[i] = numbers[i] == kNoObjColor
                          ? std::uint8_t{255}
                          : static_cast<std::uint8_t>(std::min(numbers[i] * scale + 0.5f, 255.0f));
    });
  } else {
    for_all(numbers.size(), [&](std::size_t i) {
      numbers[i] = numbers[i] == kNoObjColor ? 1 : linear_of_obj_color(numbers[i]);
    });
    color.floats = std::move(numbers);
  }
  mesh.attributes.push_back(std::move(color));
}

}  // namespace oktett
