#pragma once
/// \file The triangles of meshes in leaves of the tree. A leaf holds up to eight, a block of 256 bytes one
/// leaf as it is, or two in packed form.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/lanes.h"
#include "core/simd_memory.h"
#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

// ---- Blocks.

/// Floats as integers in the same order, and back: the number of floats between two of them is the difference
/// of their numbers. -0 comes just before 0. Every bit pattern has a number of its own.
OKTETT_INLINE std::int32_t number_of_bits(std::int32_t bits) { return bits ^ (bits >> 31 & 0x7fffffff); }
OKTETT_INLINE std::int32_t float_number(float x) { return number_of_bits(std::bit_cast<std::int32_t>(x)); }
OKTETT_INLINE float float_of_number(std::int32_t n) { return std::bit_cast<float>(number_of_bits(n)); }

/// Up to sixteen corners that the triangles of one or two leaves share: 256 bytes. In a *plain* block there
/// is one leaf, and the corners are floats. In a *packed* block there are two, and along each axis corners
/// are 24-bit distances from the least one, counted in floats. No bit is lost: corners that lie farther apart
/// are not packed.
struct alignas(64) TriangleBlock {
  static constexpr int kSize = 8, kCorners = 16;  ///< triangles of a leaf, corners of a block
  static constexpr std::uint32_t kLeaves = 2;     ///< leaves of a block, the second only if it is packed
  static constexpr std::uint16_t kPacked = 1u << 12;
  static constexpr std::uint32_t kMostDistance = (1u << 24) - 1;

  /// The triangles of a leaf. Unused lanes have the same corner three times, so no ray hits them, and the
  /// item kNoId.
  struct Lists {
    /// Of each triangle: the number of corner k in the bits from 4 k on; kPacked in all of a packed block.
    std::uint16_t corners[kSize];
    std::uint32_t item[kSize];
  };
  struct Second {
    std::int32_t base[3];  ///< the float_number() of the least corner, per axis
    std::uint32_t padding;
    Lists lists;
  };

  // Of plain blocks: the corners x[n], y[n], z[n]; unused ones repeat number 0. Of packed ones: the distance
  // of corner n in x in the lower 24 bits of low[n], in y in those of high[n], in z in the upper 8 bits of
  // both and in top[n]. The lists of the second leaf stand half a block behind those of the first.
  union {
    float x[kCorners];
    std::uint32_t low[kCorners];
  };
  std::uint8_t top[kCorners];  ///< plain: 0
  Lists first;
  union {
    float y[kCorners];
    std::uint32_t high[kCorners];
  };
  union {
    float z[kCorners];
    Second second;
  };

  bool is_packed() const { return (first.corners[0] & kPacked) != 0; }
  /// Of plain blocks: the corners along an axis.
  OKTETT_INLINE float* row(int axis) { return reinterpret_cast<float*>(this) + row_offset(axis); }
  OKTETT_INLINE const float* row(int axis) const {
    return reinterpret_cast<const float*>(this) + row_offset(axis);
  }
  /// Where the row of an axis begins, in floats.
  static OKTETT_INLINE constexpr int row_offset(int axis) { return axis == 0 ? 0 : kCorners * (axis + 1); }
};
static_assert(sizeof(TriangleBlock) == 256 &&
              offsetof(TriangleBlock, y) == 4 * TriangleBlock::row_offset(1) &&
              offsetof(TriangleBlock, z) == 4 * TriangleBlock::row_offset(2));
static_assert(offsetof(TriangleBlock, second) + offsetof(TriangleBlock::Second, lists) ==
              offsetof(TriangleBlock, first) + sizeof(TriangleBlock) / TriangleBlock::kLeaves);

/// The distances of corner `n` of a packed block along each axis.
OKTETT_INLINE std::uint32_t packed_distance(std::uint32_t low, std::uint32_t high, std::uint32_t top,
                                            int axis) {
  return axis == 0   ? low & 0xffffffu
         : axis == 1 ? high & 0xffffffu
                     : low >> 24 | (high >> 16 & 0xff00u) | top << 16;
}
OKTETT_INLINE float packed_float(std::int32_t base, std::uint32_t distance) {
  return float_of_number(static_cast<std::int32_t>(static_cast<std::uint32_t>(base) + distance));
}

/// The corners of a packed block as floats, in the rows that a plain block has.
template <class A>
OKTETT_INLINE void unpack_corners(const TriangleBlock& b, TriangleBlock& out) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa>) {
    const __m512i low = _mm512_load_si512(b.low), high = _mm512_load_si512(b.high);
    const __m512i top = _mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(b.top)));
    const __m512i mask = _mm512_set1_epi32(0xffffff), second = _mm512_set1_epi32(0xff00);
    constexpr int kOrAnd = 0xf8, kXorAnd = 0x78;  // a | (b & c) and a ^ (b & c)
    const __m512i z = _mm512_or_si512(
        _mm512_ternarylogic_epi32(_mm512_srli_epi32(low, 24), _mm512_srli_epi32(high, 16), second, kOrAnd),
        _mm512_slli_epi32(top, 16));
    const auto store = [&](int axis, __m512i distance) {
      const __m512i number = _mm512_add_epi32(distance, _mm512_set1_epi32(b.second.base[axis]));
      _mm512_store_si512(out.row(axis), _mm512_ternarylogic_epi32(number, _mm512_srai_epi32(number, 31),
                                                                  _mm512_set1_epi32(0x7fffffff), kXorAnd));
    };
    store(0, _mm512_and_si512(low, mask)), store(1, _mm512_and_si512(high, mask)), store(2, z);
    return;
  }
#endif
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < TriangleBlock::kCorners; ++n)
      out.row(axis)[n] =
          packed_float(b.second.base[axis], packed_distance(b.low[n], b.high[n], b.top[n], axis));
}

// ---- Leaves.

/// A leaf of a block. Leaf 2 n is the first of block n, leaf 2 n + 1 the second.
class TriangleLeaf {
 public:
  TriangleLeaf() = default;
  OKTETT_INLINE TriangleLeaf(const TriangleBlock* blocks, std::uint32_t number)
      : block_(blocks + number / TriangleBlock::kLeaves),
        lists_(reinterpret_cast<const TriangleBlock::Lists*>(
            reinterpret_cast<const std::byte*>(blocks) + offsetof(TriangleBlock, first) +
            std::size_t{number} * (sizeof(TriangleBlock) / TriangleBlock::kLeaves))) {}

  OKTETT_INLINE const TriangleBlock& block() const { return *block_; }
  OKTETT_INLINE bool is_packed() const { return (lists_->corners[0] & TriangleBlock::kPacked) != 0; }
  /// TriangleBlock::Lists::corners and items of this leaf.
  OKTETT_INLINE const std::uint16_t* corners() const { return lists_->corners; }
  OKTETT_INLINE const std::uint32_t* items() const { return lists_->item; }
  OKTETT_INLINE std::uint32_t item(std::uint32_t lane) const { return lists_->item[lane]; }
  OKTETT_INLINE std::uint32_t item(int lane) const { return lists_->item[lane]; }

  /// The number of corner `k` of triangle `lane`.
  OKTETT_INLINE int corner(int k, int lane) const { return lists_->corners[lane] >> 4 * k & 15; }
  OKTETT_INLINE float coordinate(int axis, int n) const {
    if (OKTETT_LIKELY(!is_packed())) return block_->row(axis)[n];
    return packed_float(block_->second.base[axis],
                        packed_distance(block_->low[n], block_->high[n], block_->top[n], axis));
  }
  OKTETT_INLINE Vec3f vertex(int k, int lane) const {
    const int n = corner(k, lane);
    return {coordinate(0, n), coordinate(1, n), coordinate(2, n)};
  }

 private:
  const TriangleBlock* block_ = nullptr;
  const TriangleBlock::Lists* lists_ = nullptr;
};

/// The corners of a leaf as floats in rows, [axis].
template <class A>
class CornerRows {
 public:
  OKTETT_INLINE explicit CornerRows(const TriangleLeaf& leaf) : block_(&leaf.block()) {
    if (OKTETT_UNLIKELY(leaf.is_packed())) {
      unpack_corners<A>(leaf.block(), own_);
      block_ = &own_;
    }
  }
  CornerRows(const CornerRows&) = delete;
  CornerRows& operator=(const CornerRows&) = delete;
  OKTETT_INLINE const float* operator[](int axis) const { return block_->row(axis); }

 private:
  const TriangleBlock* block_;
  TriangleBlock own_;  ///< not initialised
};

/// Triangle `lane` in all lanes of F, its axes permuted so that `z_axis` comes last (2 = as they are).
template <class F>
OKTETT_INLINE TriangleLanes<F> broadcast_triangle(const TriangleLeaf& leaf, int lane, int z_axis = 2) {
  const auto corner = [&](int k) {
    const int n = leaf.corner(k, lane);
    return Vec3<F>{F(leaf.coordinate((z_axis + 1) % 3, n)), F(leaf.coordinate((z_axis + 2) % 3, n)),
                   F(leaf.coordinate(z_axis, n))};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Triangles `first`, `first` + 1, ... in the lanes of F.
template <class F>
OKTETT_INLINE TriangleLanes<F> load_triangles(const TriangleLeaf& leaf, int first = 0, int z_axis = 2) {
  const CornerRows<typename F::Isa> rows(leaf);
  const PackedIndices<F::kWidth, typename F::Isa> corners(leaf.corners() + first);
  const auto corner = [&](int k) {
    const auto axis = [&](int a) { return corners.look_up(k, rows[a]); };
    return Vec3<F>{axis((z_axis + 1) % 3), axis((z_axis + 2) % 3), axis(z_axis)};
  };
  return {corner(0), corner(1), corner(2)};
}

/// (b - a) x (c - a).
OKTETT_INLINE Vec3f triangle_normal(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return cross(b - a, c - a);
}

}  // namespace oktett
