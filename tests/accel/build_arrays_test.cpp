#include "accel/build/build_arrays.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>

#include "accel/build/wide_tree.h"

namespace oktett::build_arrays_test {
namespace {

/// Writes `value` to all bytes of an array, or expects it there.
template <class T>
void fill(T* array, std::size_t count, int value) {
  if (count == 0) return;
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array) % kAlignment, 0u);
  std::memset(static_cast<void*>(array), value, count * sizeof(T));
}
template <class T>
void expect_filled(const T* array, std::size_t count, int value) {
  const auto* const bytes = reinterpret_cast<const unsigned char*>(array);
  for (std::size_t i = 0; i < count * sizeof(T); ++i) ASSERT_EQ(bytes[i], value) << i;
}

template <class Each>
void each_array(const BuildArrays& a, std::size_t cells, std::size_t more, const Each& each) {
  each(a.refs, a.room, 1), each(a.more_refs, more, 2);
  each(a.keys, cells, 3), each(a.more_keys, cells, 4), each(a.cells, cells, 5);
  each(a.items, a.room, 6), each(a.corners, a.room, 7), each(a.nodes, a.node_room, 8);
}

TEST(BuildArrays, DoNotOverlap) {
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best})
    for (const std::size_t count : {1, 9, 256, 257, 5000, 60000}) {
      const Effort effort = effort_of(quality);
      const BuildArrays arrays(count, effort);
      EXPECT_GE(arrays.room, count);
      EXPECT_GE(arrays.node_room, 2 * arrays.room);
      const std::size_t cells = effort.cells ? count : 0, more = count > effort.sweep ? arrays.room : 0;
      for (const bool parallel : {false, true}) {
        arrays.populate(arrays.refs, arrays.room, parallel);
        arrays.populate(arrays.nodes, arrays.node_room, parallel);
      }
      each_array(arrays, cells, more, [](auto* array, std::size_t n, int value) { fill(array, n, value); });
      arrays.discard_references();
      each_array(arrays, cells, more, [](auto* array, std::size_t n, int value) {
        // The first arrays may have been discarded.
        if (value >= 6) expect_filled(array, n, value);
      });
      fill(arrays.refs, arrays.room, 9);
      expect_filled(arrays.items, arrays.room, 6);
    }
}

TEST(BuildArrays, ReferencesOfLargeBuildsAreGivenBack) {
  const BuildArrays arrays(800000, effort_of(BuildQuality::balanced));
  arrays.refs[1000].item = 5, arrays.items[1000] = 6;
  arrays.discard_references();
  EXPECT_EQ(arrays.refs[1000].item, 0u);
  EXPECT_EQ(arrays.items[1000], 6u);
}

}  // namespace
}  // namespace oktett::build_arrays_test
