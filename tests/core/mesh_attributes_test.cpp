/// \file What meshes carry, at corners and between them.

#include "core/mesh_attributes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/mesh.h"

namespace oktett::mesh_attributes_test {
namespace {

/// The curve of IEC 61966-2-1.
long double linear_of(long double part) {
  return part <= 0.04045L ? part / 12.92L : std::pow((part + 0.055L) / 1.055L, 2.4L);
}

TriangleMesh two_triangles() {
  TriangleMesh mesh;
  for (const Vec3f& p : {Vec3f{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}) mesh.positions.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 3u, 0u, 2u}) mesh.indices.push_back(i);
  return mesh;
}

TEST(MeshAttributes, BytesAreThoseOfTheSrgbCurve) {
  for (int byte = 0; byte < 256; ++byte) {
    const long double exact = linear_of(byte / 255.0L);
    const float value = linear_of_srgb_byte(static_cast<std::uint8_t>(byte));
    EXPECT_LE(std::abs(value - exact), 0x1p-24L * exact) << byte;
  }
}

/// Half a unit in the last place of `x`, as mesh.h says, and what the double sum may be off by.
long double bound(long double x, long double greatest) {
  const auto rounded = static_cast<float>(std::abs(x));
  const long double unit = std::nextafter(rounded, HUGE_VALF) - static_cast<long double>(rounded);
  return unit / 2 + std::ldexp(greatest, -50);
}

TEST(MeshAttributes, AreWeightedBetweenCorners) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-3, 3), part(0, 1);
  const TriangleMesh mesh = two_triangles();
  for (int round = 0; round < 2000; ++round) {
    MeshAttribute a;
    a.domain = static_cast<AttributeDomain>(round % 3);
    a.components = 1 + random() % 4;
    const bool bytes = random() % 2 == 0;
    const std::size_t size = domain_size(mesh, a.domain) * a.components;
    for (std::size_t i = 0; i < size; ++i)
      bytes ? a.srgb.push_back(static_cast<std::uint8_t>(random()))
            : a.floats.push_back(any(random) * std::ldexp(1.0f, static_cast<int>(random() % 40) - 20));
    ASSERT_EQ(a.size(), domain_size(mesh, a.domain));
    const std::uint32_t triangle = random() % 2;
    float u = part(random), v = part(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    if (round % 10 == 0) u = 0, v = 1;
    const AttributeValue value = attribute_at({&mesh, triangle, u, v}, a);
    for (std::uint32_t k = 0; k < a.components; ++k) {
      long double corner[3], greatest = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t element = a.domain == AttributeDomain::vertex ? mesh.indices[3 * triangle + c]
                                    : a.domain == AttributeDomain::face ? triangle
                                                                        : 3 * triangle + c;
        const std::size_t at = element * a.components + k;
        const long double byte = bytes ? a.srgb[at] / 255.0L : 0;
        // Bytes are rounded to float before they are weighted.
        corner[c] = bytes ? static_cast<float>(k < 3 ? linear_of(byte) : byte) : a.floats[at];
        greatest = std::max(greatest, std::abs(corner[c]));
      }
      const long double w = 1 - static_cast<long double>(u) - v;
      const long double exact = corner[0] * w + corner[1] * u + corner[2] * v;
      // The curve in double may round a byte to the float beside.
      const long double slack = bytes ? std::ldexp(greatest, -23) : 0;
      EXPECT_LE(std::abs(value[k] - exact), bound(exact, greatest) + slack);
    }
    EXPECT_TRUE(a.components != 1 || value[2] == value[0]);
    EXPECT_TRUE(a.components == 4 || value[3] == 1);
  }
}

TEST(MeshAttributes, AreFoundByName) {
  TriangleMesh mesh = two_triangles();
  EXPECT_EQ(find_attribute(mesh, "a"), nullptr);
  const std::size_t before = mesh.bytes();
  for (const char* name : {"b", "a"}) {
    MeshAttribute attribute;
    attribute.name = name;
    attribute.floats = Column<float>(4, 0.5f);
    mesh.attributes.push_back(std::move(attribute));
  }
  EXPECT_EQ(find_attribute(mesh, "a"), &mesh.attributes[1]);
  EXPECT_GT(mesh.bytes(), before);
}

}  // namespace
}  // namespace oktett::mesh_attributes_test
