// The operations of core/simd.h in each instruction set of this machine, bit by bit against the same
// arithmetic on single numbers. xsimd's own differ: minus of +0 is +0 with AVX-512, quotients and roots of
// floats are estimates on NEON, min and max treat NaN and zeros by set.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "verify/probes/simd_probe.h"

namespace oktett::simd_sets_test {
namespace {

constexpr SimdOp kOps[] = {SimdOp::add,    SimdOp::subtract, SimdOp::multiply,   SimdOp::divide,
                           SimdOp::negate, SimdOp::min,      SimdOp::max,        SimdOp::abs,
                           SimdOp::sqrt,   SimdOp::less,     SimdOp::less_equal, SimdOp::equal};

template <class T>
T on_one(SimdOp op, T a, T b) {
  if constexpr (std::is_integral_v<T>) {
    const auto ua = static_cast<std::uint32_t>(a), ub = static_cast<std::uint32_t>(b);
    if (op == SimdOp::add) return static_cast<T>(ua + ub);
    if (op == SimdOp::subtract) return static_cast<T>(ua - ub);
    if (op == SimdOp::multiply) return static_cast<T>(ua * ub);
    if (op == SimdOp::negate) return static_cast<T>(0 - ua);
  } else {
    if (op == SimdOp::add) return a + b;
    if (op == SimdOp::subtract) return a - b;
    if (op == SimdOp::multiply) return a * b;
    if (op == SimdOp::divide) return a / b;
    if (op == SimdOp::negate) return std::copysign(a, std::signbit(a) ? T(1) : T(-1));
    if (op == SimdOp::min) return a < b ? a : b;
    if (op == SimdOp::max) return a > b ? a : b;
    if (op == SimdOp::abs) return std::copysign(a, T(1));
    if (op == SimdOp::sqrt) return std::sqrt(a);
  }
  if (op == SimdOp::less) return T(a < b);
  if (op == SimdOp::less_equal) return T(a <= b);
  if (op == SimdOp::equal) return T(a == b);
  return a;
}

/// Zeros, denormals, infinities, NaN, ends of the range, and numbers of all sizes at random.
template <class T>
std::vector<T> awkward() {
  std::mt19937_64 random(7);
  std::vector<T> x;
  if constexpr (std::is_integral_v<T>) {
    x = {0, 1, -1, 2, -2, INT32_MAX, INT32_MIN, INT32_MAX - 1, INT32_MIN + 1, 0x7f800000};
    for (int i = 0; i < 118; ++i) x.push_back(static_cast<T>(random()));
  } else {
    using L = std::numeric_limits<T>;
    for (const T v : {T(0), T(1), T(1.5), T(3), L::min(), L::denorm_min(), L::min() / 2, L::max(),
                      L::infinity(), L::quiet_NaN(), T(1) + L::epsilon(), T(1) - L::epsilon() / 2})
      x.push_back(v), x.push_back(-v);
    for (int i = 0; i < 104; ++i) {
      const T m = static_cast<T>(1 + static_cast<double>(random() >> 11) * 0x1p-53);
      const int spread = i % 2 == 0 ? 3 : 2 * L::max_exponent;
      x.push_back(std::ldexp(i % 3 ? m : -m,
                             static_cast<int>(random() % static_cast<unsigned>(spread)) - spread / 2));
    }
  }
  return x;
}

template <class T>
void expect_same(T got, T wanted, Isa isa, int width, SimdOp op, T a, T b) {
  bool same = got == wanted;
  if constexpr (std::is_floating_point_v<T>)
    same = std::isnan(wanted) ? std::isnan(got) : same && std::signbit(got) == std::signbit(wanted);
  ASSERT_TRUE(same) << to_string(isa) << ", " << width << " lanes, operation " << static_cast<int>(op)
                    << " of " << a << " and " << b << ": " << got << " for " << wanted;
}

template <class T, class Run>
void expect_all_pairs(Run&& run) {
  const std::vector<T> x = awkward<T>();
  std::vector<T> a, b;
  for (const T p : x)
    for (const T q : x) a.push_back(p), b.push_back(q);
  std::vector<T> out(a.size());
  for (const Isa isa : available_isas())
    for (const int width : {4, 8, 16})
      for (const SimdOp op : kOps) {
        run(isa, op, width, SimdColumns<T>{a.size(), a.data(), b.data(), out.data()});
        for (std::size_t i = 0; i < a.size(); ++i)
          expect_same(out[i], on_one(op, a[i], b[i]), isa, width, op, a[i], b[i]);
      }
}

TEST(SimdSets, FloatsAreComputedAsSingleNumbers) {
  expect_all_pairs<float>(
      [](Isa isa, SimdOp op, int width, const auto& run) { simd_probe_code(isa).floats(op, width, run); });
}

TEST(SimdSets, DoublesAreComputedAsSingleNumbers) {
  expect_all_pairs<double>(
      [](Isa isa, SimdOp op, int width, const auto& run) { simd_probe_code(isa).doubles(op, width, run); });
}

// GCC's signed sums of vectors on ARM are undefined where they overflow, and comparisons of them go wrong.
TEST(SimdSets, WholeNumbersWrapAround) {
  expect_all_pairs<std::int32_t>(
      [](Isa isa, SimdOp op, int width, const auto& run) { simd_probe_code(isa).ints(op, width, run); });
}

TEST(SimdSets, MinusAndNanDoNotDependOnTheSet) {
  const float zero[4] = {0.0f, -0.0f, 0.0f, -0.0f}, nan[4] = {NAN, NAN, NAN, NAN};
  float out[4];
  for (const Isa isa : available_isas()) {
    const SimdProbeCode& code = simd_probe_code(isa);
    code.floats(SimdOp::negate, 4, {4, zero, zero, out});
    EXPECT_TRUE(std::signbit(out[0]) && !std::signbit(out[1])) << to_string(isa);
    code.floats(SimdOp::equal, 4, {4, nan, nan, out});
    EXPECT_EQ(out[0], 0.0f) << to_string(isa);
  }
}

TEST(SimdSets, SortsTheChosenLanesByDescendingKey) {
  std::mt19937 random(3);
  for (const Isa isa : available_isas())
    for (int run = 0; run < 2000; ++run) {
      float keys[8], out_keys[8];
      std::uint32_t values[8], out_values[8];
      for (int i = 0; i < 8; ++i) {
        // A quarter of the keys are far apart, the others often equal.
        keys[i] =
            run % 4 ? static_cast<float>(random() % 5)
                    : std::bit_cast<float>(static_cast<std::uint32_t>(0x10000000u + random() % 0x60000000u));
        values[i] = static_cast<std::uint32_t>(random());
      }
      const unsigned lanes = static_cast<unsigned>(run) % 256;
      const int size = simd_probe_code(isa).store_descending(keys, lanes, values, out_values, out_keys);
      ASSERT_EQ(size, std::popcount(lanes));
      unsigned seen = 0;
      for (int i = 0; i < size; ++i) {
        ASSERT_GE(out_keys[i > 0 ? i - 1 : 0], out_keys[i]) << to_string(isa);
        unsigned lane = 0;
        while (lane < 8 && (!(lanes >> lane & 1) || seen >> lane & 1 || values[lane] != out_values[i]))
          ++lane;
        ASSERT_LT(lane, 8u) << to_string(isa) << ": a value that no chosen lane has";
        seen |= 1u << lane;
        ASSERT_LE(out_keys[i], keys[lane]) << to_string(isa);
        ASSERT_LE(std::bit_cast<std::int32_t>(keys[lane]) - std::bit_cast<std::int32_t>(out_keys[i]), 8)
            << to_string(isa);
      }
      ASSERT_EQ(seen, lanes);
    }
}

TEST(SimdSets, TakesTheChosenLanesByAscendingKey) {
  std::mt19937 random(4);
  for (const Isa isa : available_isas())
    for (unsigned lanes = 0; lanes < 256; ++lanes) {
      float keys[8];
      std::uint32_t values[8], out_values[8], out_keys[8];
      std::vector<std::pair<std::uint32_t, std::uint32_t>> expected, taken;
      for (std::uint32_t i = 0; i < 8; ++i) {
        keys[i] = random() % 4 == 0 ? INFINITY : static_cast<float>(random() % 5) * 0.3f;
        values[i] = static_cast<std::uint32_t>(random());
        if (lanes >> i & 1)
          expected.emplace_back((std::bit_cast<std::uint32_t>(keys[i]) & ~7u) | i, values[i]);
      }
      std::sort(expected.begin(), expected.end());
      const int size = simd_probe_code(isa).take_least(keys, lanes, values, out_values, out_keys);
      for (int i = 0; i < size; ++i) taken.emplace_back(out_keys[i], out_values[i]);
      ASSERT_EQ(taken, expected) << to_string(isa);
    }
}

TEST(SimdSets, CompactsLooksUpAndLoadsWordsAsSingleNumbers) {
  std::mt19937 random(5);
  for (const Isa isa : available_isas()) {
    const SimdProbeCode& code = simd_probe_code(isa);
    for (unsigned lanes = 0; lanes < 256; ++lanes) {
      std::uint32_t values[8], out[8];
      for (std::uint32_t& v : values) v = static_cast<std::uint32_t>(random());
      std::vector<std::uint32_t> chosen;
      for (int i = 0; i < 8; ++i)
        if (lanes >> i & 1) chosen.push_back(values[i]);
      const int size = code.store_compact(lanes, values, out);
      ASSERT_EQ(std::vector<std::uint32_t>(out, out + size), chosen) << to_string(isa);
    }
    for (unsigned flip = 0; flip < 16; ++flip) {
      std::uint16_t words[16];
      float row[16], found[8], loaded[16];
      for (std::uint16_t& w : words) w = static_cast<std::uint16_t>(random());
      for (float& r : row) r = static_cast<float>(random());
      for (int k = 0; k < 3; ++k) {
        code.look_up(words, k, row, found);
        for (int i = 0; i < 8; ++i) ASSERT_EQ(found[i], row[words[i] >> 4 * k & 15]) << to_string(isa);
      }
      code.load_words(words, flip, loaded);
      for (unsigned i = 0; i < 16; ++i)
        ASSERT_EQ(loaded[i], static_cast<float>(words[i ^ flip])) << to_string(isa);
    }
  }
}

}  // namespace
}  // namespace oktett::simd_sets_test
