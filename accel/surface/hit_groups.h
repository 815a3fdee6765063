#pragma once
/// \file Sorts the hits of a block into groups whose surfaces are found together.

#include <bit>
#include <cstdint>
#include <cstring>

#include "accel/accel_data.h"
#include "accel/interaction_block.h"

namespace oktett {

/// Calls what(k) for each bit k of `entries`, lowest first.
template <class What>
OKTETT_INLINE void for_each_entry(std::uint64_t entries, const What& what) {
  for (; entries != 0; entries &= entries - 1) what(static_cast<std::size_t>(std::countr_zero(entries)));
}

/// Hits of one closed-form kind, of one element of an exact kind, or of one mesh.
struct HitGroup {
  const Accel* accel;
  Kind kind;
  std::uint32_t part;     ///< element of an exact kind, geometry of a mesh, else 0
  std::uint64_t entries;  ///< bit k: entry k of the block
};

/// The groups in the order in which their first hits came.
class HitGroups {
 public:
  HitGroups() { clear(); }
  void clear() {
    count_ = 0;
    std::memset(slots_, 0xff, sizeof(slots_));
  }
  const HitGroup* begin() const { return groups_; }
  const HitGroup* end() const { return groups_ + count_; }

  void add(const Accel& accel, Kind kind, std::uint32_t part, std::uint64_t entries) {
    find(accel, kind, part).entries |= entries;
  }

 private:
  static constexpr std::size_t kMost = InteractionBlock::kMost;
  static_assert(kMost == 64, "an entry is a bit of HitGroup::entries");
  static constexpr std::uint16_t kNone = 0xffff;
  static constexpr std::size_t kSlots = 2 * kMost;

  /// The group of these hits. If it is new, it has no entries.
  HitGroup& find(const Accel& accel, Kind kind, std::uint32_t part) {
    const auto is = [&](const HitGroup& g) { return g.accel == &accel && g.kind == kind && g.part == part; };
    if (count_ > 0 && is(groups_[latest_])) return groups_[latest_];
    const auto name = reinterpret_cast<std::uintptr_t>(&accel) / alignof(Accel) +
                      31 * static_cast<std::uintptr_t>(kind) + std::uintptr_t{part};
    for (std::size_t slot = (name * 0x9e3779b97f4a7c15u) >> 32;; ++slot) {
      std::uint16_t& group = slots_[slot % kSlots];
      if (group == kNone) {
        group = static_cast<std::uint16_t>(count_);
        groups_[count_++] = {&accel, kind, part, 0};
      } else if (!is(groups_[group])) {
        continue;
      }
      latest_ = group;
      return groups_[group];
    }
  }

  std::size_t count_ = 0, latest_ = 0;
  HitGroup groups_[kMost];
  std::uint16_t slots_[kSlots];
};

}  // namespace oktett
