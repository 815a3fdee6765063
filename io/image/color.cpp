#include "io/image/color.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/error.h"
#include "core/math.h"
#include "io/image/byte_table.h"

namespace oktett {
namespace {

std::uint8_t rounded_srgb(float linear) {
  return static_cast<std::uint8_t>(linear_to_srgb(linear) * 255.0f + 0.5f);
}

}  // namespace

float linear_to_srgb(float linear) {
  if (linear <= 0.0031308f) return 12.92f * linear;
  return static_cast<float>(1.055 * portable::pow(static_cast<double>(linear), 1 / 2.4) - 0.055);
}

float srgb_to_linear(float encoded) {
  if (encoded <= 0.04045f) return encoded / 12.92f;
  return static_cast<float>(portable::pow((static_cast<double>(encoded) + 0.055) / 1.055, 2.4));
}

float decode(const ColorEncoding& encoding, float stored) {
  if (encoding.curve == TransferCurve::srgb) return srgb_to_linear(stored);
  if (encoding.curve != TransferCurve::gamma || stored <= 0) return stored;
  return static_cast<float>(
      portable::pow(static_cast<double>(stored), static_cast<double>(encoding.exponent)));
}

// ---- Primaries.

namespace {

struct Matrix3 {
  double a[3][3];

  Matrix3 operator*(const Matrix3& b) const {
    Matrix3 product{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) product.a[i][j] += a[i][k] * b.a[k][j];
    return product;
  }
  Vec3d operator*(const Vec3d& v) const {
    const auto row = [&](int i) { return a[i][0] * v.x + a[i][1] * v.y + a[i][2] * v.z; };
    return {row(0), row(1), row(2)};
  }
  /// Columns times the components of `s`.
  Matrix3 scaled(const Vec3d& s) const { return *this * Matrix3{{{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}}}; }
  /// By cofactors; numbers that are not finite if there is none.
  Matrix3 inverse() const {
    Matrix3 inverse{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int r = (j + 1) % 3, s = (j + 2) % 3, p = (i + 1) % 3, q = (i + 2) % 3;
        inverse.a[i][j] = a[r][p] * a[s][q] - a[r][q] * a[s][p];
      }
    const double determinant =
        a[0][0] * inverse.a[0][0] + a[0][1] * inverse.a[1][0] + a[0][2] * inverse.a[2][0];
    for (auto& row : inverse.a)
      for (double& x : row) x /= determinant;
    return inverse;
  }
};

constexpr Chromaticities kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
constexpr Matrix3 kBradford{
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

/// XYZ of luminance 1.
Vec3d xyz_of(const Chromaticities& c, std::size_t which) {
  const double x = static_cast<double>(c[2 * which]), y = static_cast<double>(c[2 * which + 1]);
  return {x / y, 1, (1 - x - y) / y};
}

/// From light of these primaries, of which the same amounts make their white, to XYZ.
Matrix3 to_xyz(const Chromaticities& c) {
  const Vec3d r = xyz_of(c, 0), g = xyz_of(c, 1), b = xyz_of(c, 2);
  const Matrix3 primaries{{{r.x, g.x, b.x}, {r.y, g.y, b.y}, {r.z, g.z, b.z}}};
  return primaries.scaled(primaries.inverse() * xyz_of(c, 3));
}

}  // namespace

std::optional<ColorMatrix> to_rec709(const Chromaticities& chromaticities) {
  bool same = true;
  for (std::size_t i = 0; i < kRec709.size(); ++i)
    same = same && std::abs(chromaticities[i] - kRec709[i]) < 1e-4f;
  if (same) return std::nullopt;
  const Vec3d from = kBradford * xyz_of(chromaticities, 3), to = kBradford * xyz_of(kRec709, 3);
  const Matrix3 adapted =
      kBradford.inverse().scaled({to.x / from.x, to.y / from.y, to.z / from.z}) * kBradford;
  const Matrix3 all = to_xyz(kRec709).inverse() * adapted * to_xyz(chromaticities);
  ColorMatrix result{};
  for (std::size_t i = 0; i < 9; ++i) {
    const double x = all.a[i / 3][i % 3];
    // Real primaries give less than ten.
    if (!(std::abs(x) < 1e3)) throw Error("its chromaticities are not those of red, green, blue and white");
    result[i] = static_cast<float>(x);
  }
  return result;
}

Color transformed(const ColorMatrix& m, const Color& c) {
  return {m[0] * c.x + m[1] * c.y + m[2] * c.z, m[3] * c.x + m[4] * c.y + m[5] * c.z,
          m[6] * c.x + m[7] * c.y + m[8] * c.z};
}

// ---- Bytes.

std::uint16_t linear_to_srgb16(float linear) {
  if (!(linear > 0) || !std::isfinite(linear)) return 0;
  return linear < 1 ? static_cast<std::uint16_t>(linear_to_srgb(linear) * 65535.0f + 0.5f) : 65535;
}

std::uint8_t linear_to_srgb8(float linear) {
  static const ByteTable<16> table(rounded_srgb);
  return table(linear);
}

}  // namespace oktett
