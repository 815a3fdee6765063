#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "render/transport/render_code.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::wavefront_lanes_test {
namespace {

constexpr std::size_t kCounts[] = {0, 1, 7, 8, 9, 15, 16, 17, 31, 64, 100};

/// Equal bits, or both NaN.
void expect_same(const Color& a, const Color& b, std::size_t i) {
  for (int k = 0; k < 3; ++k)
    EXPECT_TRUE(std::bit_cast<std::uint32_t>(a[k]) == std::bit_cast<std::uint32_t>(b[k]) ||
                (std::isnan(a[k]) && std::isnan(b[k])))
        << i << ": " << a[k] << " and " << b[k];
}

/// A colour that is black one time in three, and has a number that is hard to add one time in five.
Color any_color(CaseRandom& r) {
  constexpr float kOdd[] = {-0.0f, kInf, -kInf, 1e38f, 1e-45f};
  if (r.bits() % 3 == 0) return {0, r.bits() % 2 == 0 ? 0.0f : -0.0f, 0};
  const auto number = [&] { return static_cast<float>(r.bits() % 1000) / 300; };
  Color c{number(), number(), number()};
  if (r.bits() % 5 == 0) c[static_cast<int>(r.bits() % 3)] = r.bits() % 6 == 5 ? kNan : kOdd[r.bits() % 5];
  return c;
}

ColorColumn any_colors(std::size_t count, CaseRandom& r) {
  ColorColumn colors;
  for (std::size_t i = 0; i < count; ++i) colors.push_back(any_color(r));
  return colors;
}

TEST(WavefrontLanes, RaysThatMissFindTheBackgroundAndHitsAreListed) {
  CaseRandom r(1);
  for (const Isa isa : available_isas())
    for (const std::size_t count : kCounts) {
      Column<std::uint32_t> item, hits;
      for (std::size_t i = 0; i < count; ++i)
        item.push_back(r.bits() % 3 == 0 ? kNoId : r.bits() % 2 == 0 ? 0 : 0xfffffffe);
      const ColorColumn throughput = any_colors(count, r);
      const Color background{0.5f, 2, 0};
      ColorColumn radiance;
      render_code(isa).split_rays(item, throughput, background, radiance, hits);
      ASSERT_EQ(radiance.size(), count);
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < count; ++i) {
        const bool missed = item[i] == kNoId;
        expect_same(radiance[i], missed ? throughput[i] * background : Color{0, 0, 0}, i);
        if (!missed) expected.push_back(i);
      }
      EXPECT_EQ(std::vector<std::uint32_t>(hits.begin(), hits.end()), expected);
    }
}

TEST(WavefrontLanes, BlockedLightIsBlack) {
  CaseRandom r(2);
  for (const Isa isa : available_isas())
    for (const std::size_t count : kCounts) {
      Column<std::uint8_t> blocked;
      for (std::size_t i = 0; i < count; ++i) blocked.push_back(r.bits() % 2 == 0 ? 1 : 0);
      const ColorColumn before = any_colors(count, r);
      ColorColumn light;
      for (std::size_t i = 0; i < count; ++i) light.push_back(before[i]);
      render_code(isa).block_light(blocked, light);
      for (std::size_t i = 0; i < count; ++i)
        expect_same(light[i], blocked[i] != 0 ? Color{0, 0, 0} : before[i], i);
    }
}

// Neighbours in one piece, rising numbers with gaps, and entries that come more than once.
TEST(WavefrontLanes, ColoursAreAddedInOrder) {
  CaseRandom r(3);
  for (const Isa isa : available_isas())
    for (const std::size_t count : kCounts)
      for (const std::uint32_t kind : {0u, 1u, 2u}) {
        const ColorColumn from = any_colors(count, r);
        ColorColumn to = any_colors(2 * count + 3, r), expected;
        for (std::size_t i = 0; i < to.size(); ++i) expected.push_back(to[i]);
        Column<std::uint32_t> entry;
        for (std::uint32_t i = 0; i < count; ++i)
          entry.push_back(kind == 0 ? i + 3 : kind == 1 ? 2 * i + r.bits() % 2 : r.bits() % 3);
        render_code(isa).add_colors(from, entry, to);
        for (std::size_t i = 0; i < count; ++i)
          if (!is_black(from[i])) expected.add(entry[i], from[i]);
        for (std::size_t i = 0; i < to.size(); ++i) expect_same(to[i], expected[i], i);
      }
}

TEST(WavefrontLanes, ANumberThatIsNotFiniteIsSeenAnywhere) {
  for (const Isa isa : available_isas()) {
    const auto& all_finite = render_code(isa).all_finite;
    for (const std::size_t count : kCounts) {
      std::vector<float> column(count, 3e38f);
      EXPECT_TRUE(all_finite(column.data(), count));
      for (std::size_t i = 0; i < count; ++i)
        for (const float bad : {kNan, kInf, -kInf}) {
          column[i] = bad;
          EXPECT_FALSE(all_finite(column.data(), count)) << i << " of " << count;
          column[i] = -3e38f;
        }
    }
  }
}

}  // namespace
}  // namespace oktett::wavefront_lanes_test
