#include "accel/build/build_arrays.h"

namespace oktett {
namespace {

/// References of a smaller build stay in memory until its end.
constexpr std::size_t kMuch = std::size_t{64} << 20;

/// Hands out arrays one after the other. Without memory it only adds up their sizes.
class Layout {
 public:
  explicit Layout(std::byte* memory) : memory_(memory) {}
  template <class T>
  void place(std::size_t count, T*& array) {
    array = memory_ != nullptr && count > 0 ? reinterpret_cast<T*>(memory_ + bytes_) : nullptr;
    bytes_ += (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
  }
  std::size_t bytes() const { return bytes_; }

 private:
  std::byte* memory_;
  std::size_t bytes_ = 0;
};

}  // namespace

BuildArrays::BuildArrays(std::size_t most, const Effort& effort)
    : room(room_for(most, effort)),
      // A leaf has at least one item.
      node_room(2 * room + 2 * kMaxSweep) {
  const bool one_sweep = most <= effort.sweep;
  const auto place_all = [&](Layout layout) {
    layout.place(room, refs);
    layout.place(one_sweep ? 0 : room, more_refs);
    layout.place(effort.cells ? most : 0, keys);
    layout.place(effort.cells ? most : 0, more_keys);
    layout.place(effort.cells ? most : 0, cells);
    layout.place(room, items);
    layout.place(room, corners);
    // Most builds leave much of this untouched.
    layout.place(node_room, nodes);
    return layout.bytes();
  };
  memory_.resize_uninitialized(place_all(Layout(nullptr)));
  place_all(Layout(memory_.data()));
}

void BuildArrays::discard_references() const {
  const auto* const begin = reinterpret_cast<const std::byte*>(refs);
  const auto* const end = reinterpret_cast<const std::byte*>(items);
  if (memory_.size() >= kMuch) discard_pages(refs, static_cast<std::size_t>(end - begin));
}

}  // namespace oktett
