#include "io/mesh/weld.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

namespace oktett {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::size_t kBuckets = 64;
using BucketCounts = std::array<std::uint32_t, kBuckets>;

/// Of equal positions the same.
std::uint32_t hash_of(const Vec3f& p) {
  std::uint64_t hash = 0;
  for (const float x : {p.x, p.y, p.z}) {
    // -0 + 0 is 0.
    hash = (hash ^ std::bit_cast<std::uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return static_cast<std::uint32_t>(hash);
}

std::size_t bucket_of(std::uint32_t hash) { return hash % kBuckets; }

class Weld {
 public:
  explicit Weld(TriangleMesh& mesh)
      : mesh_(mesh), count_(mesh.positions.size()), blocks_((count_ + kBlock - 1) / kBlock) {}

  void run() {
    sort_into_buckets();
    oneapi::tbb::parallel_for(std::size_t{0}, kBuckets, [this](std::size_t b) { find_equal(b); });
    keep_first_ones();
    for_each_block(mesh_.indices.size(), [this](std::size_t, std::size_t i) {
      std::uint32_t& index = mesh_.indices[i];
      index = kept_[first_[index]];
    });
  }

 private:
  /// Calls f(block, i) for all i below `count`.
  template <class F>
  static void for_each_block(std::size_t count, const F& f) {
    oneapi::tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) f(block, i);
    });
  }

  /// Lists the vertices of each bucket in their order.
  void sort_into_buckets() {
    hashes_.resize_uninitialized(count_);
    std::vector<BucketCounts> places(blocks_, BucketCounts{});
    for_each_block(count_, [&](std::size_t block, std::size_t i) {
      hashes_[i] = hash_of(mesh_.positions[i]);
      ++places[block][bucket_of(hashes_[i])];
    });
    std::uint32_t next = 0;
    for (std::size_t b = 0; b < kBuckets; ++b) {
      starts_[b] = next;
      for (BucketCounts& place : places) next += std::exchange(place[b], next);
    }
    starts_[kBuckets] = next;
    members_.resize_uninitialized(count_);
    for_each_block(count_, [&](std::size_t block, std::size_t i) {
      members_[places[block][bucket_of(hashes_[i])]++] = static_cast<std::uint32_t>(i);
    });
  }

  /// Sets first_ of all vertices in a bucket.
  void find_equal(std::size_t bucket) {
    const std::size_t size = starts_[bucket + 1] - starts_[bucket];
    const std::size_t slots = std::bit_ceil(2 * size + 1);
    std::vector<std::uint32_t> table(slots, kNoId);
    for (std::size_t m = starts_[bucket]; m < starts_[bucket + 1]; ++m) {
      const std::uint32_t i = members_[m];
      std::size_t slot = (hashes_[i] / kBuckets) & (slots - 1);
      while (table[slot] != kNoId && !(mesh_.positions[table[slot]] == mesh_.positions[i]))
        slot = (slot + 1) & (slots - 1);
      if (table[slot] == kNoId) table[slot] = i;
      first_[i] = table[slot];
    }
  }

  /// Moves the first of each place together and notes where they are now.
  void keep_first_ones() {
    std::vector<std::uint32_t> before(blocks_ + 1, 0);
    for_each_block(count_, [&](std::size_t block, std::size_t i) { before[block + 1] += first_[i] == i; });
    for (std::size_t block = 0; block < blocks_; ++block) before[block + 1] += before[block];
    Column<Vec3f> positions(before[blocks_]);
    for_each_block(count_, [&](std::size_t block, std::size_t i) {
      if (first_[i] != i) return;
      positions[before[block]] = mesh_.positions[i];
      kept_[i] = before[block]++;
    });
    mesh_.positions = std::move(positions);
  }

  TriangleMesh& mesh_;
  const std::size_t count_, blocks_;
  Column<std::uint32_t> hashes_, members_;  ///< members_: vertices by bucket
  std::array<std::uint32_t, kBuckets + 1> starts_{};
  Column<std::uint32_t> first_{count_};  ///< the first vertex at the same place
  Column<std::uint32_t> kept_{count_};   ///< where a first vertex is kept
};

}  // namespace

void weld_positions(TriangleMesh& mesh) { Weld(mesh).run(); }

}  // namespace oktett
