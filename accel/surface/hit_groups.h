#pragma once
/// \file Sorts the hits of a block into groups whose surfaces are found together.

#include <cstdint>
#include <cstring>

#include "accel/hit_place.h"
#include "accel/interaction_block.h"

namespace oktett {

/// Hits of one closed-form kind, of one element of an exact kind, or of one mesh.
struct HitGroup {
  const Accel* accel;
  Kind kind;
  std::uint32_t part;  ///< element of an exact kind, geometry of a mesh, else 0
  std::uint16_t first, last;
};

/// The groups in the order of their first hits. Within a group, hits keep the order in which they came.
class HitGroups {
 public:
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  HitGroups() { clear(); }
  void clear() {
    count_ = 0;
    std::memset(slots_, 0xff, sizeof(slots_));
  }
  const HitGroup* begin() const { return groups_; }
  const HitGroup* end() const { return groups_ + count_; }
  /// Index in its pool of the shape at an entry of the block; the triangle of a mesh.
  std::uint32_t element(std::size_t entry) const { return element_[entry]; }
  /// Calls what(entry) for each of the group's entries.
  template <class What>
  void for_each(const HitGroup& group, const What& what) const {
    for (std::uint16_t entry = group.first;; entry = next_[entry]) {
      what(entry);
      if (entry == group.last) return;
    }
  }

  void add(const Accel& accel, const HitNames& names, std::size_t at) {
    const auto entry = static_cast<std::uint16_t>(at);
    std::uint32_t part = 0;
    if (names.kind == Kind::triangle) {
      element_[entry] = names.primitive;
      part = names.geometry;
    } else {
      element_[entry] = accel.pool_index[accel.first_pool_index[names.geometry] + names.primitive];
      if (is_exact(names.kind)) part = element_[entry];
    }
    HitGroup& group = find(accel, names.kind, part);
    if (group.first == kNone)
      group.first = entry;
    else
      next_[group.last] = entry;
    group.last = entry;
  }

 private:
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
        groups_[count_++] = {&accel, kind, part, kNone, kNone};
      } else if (!is(groups_[group])) {
        continue;
      }
      latest_ = group;
      return groups_[group];
    }
  }

  std::size_t count_ = 0, latest_ = 0;
  HitGroup groups_[kMost];
  std::uint16_t slots_[kSlots], next_[kMost];
  std::uint32_t element_[kMost];
};

}  // namespace oktett
