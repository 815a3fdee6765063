#pragma once
/// \file Random numbers of type T, one after the other.

#include "core/random.h"
#include "core/vec3.h"

namespace oktett {

template <class T>
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : key_(pixel_key(seed, 0)) {}
  /// In [0, 1).
  T operator()() { return random_float(key_, count_++, 0); }
  T range(T lo, T hi) { return lo + (hi - lo) * (*this)(); }
  Vec3<T> vec(T size) { return {range(-size, size), range(-size, size), range(-size, size)}; }
  int below(int n) { return static_cast<int>((*this)() * static_cast<T>(n)); }

 private:
  std::uint64_t key_;
  std::uint32_t count_ = 0;
};

}  // namespace oktett
