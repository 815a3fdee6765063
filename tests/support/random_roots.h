#pragma once
/// \file Zeros for tests of what finds zeros.

#include <algorithm>
#include <random>
#include <vector>

namespace oktett::test {

/// Up to five numbers in ascending order, from 0 to 1 or up to 0.001 beyond, some of them close together.
inline std::vector<double> random_roots(std::mt19937& random) {
  std::vector<double> roots;
  const auto unit = [&] { return (random() + 0.5) / 4294967296.0; };
  for (int n = static_cast<int>(random() % 6); n > 0; --n)
    roots.push_back(random() % 3 == 0 && !roots.empty() ? roots.back() + 1e-3 * unit() : unit());
  std::sort(roots.begin(), roots.end());
  return roots;
}

/// The least difference of two of them; 1 if there are fewer than two.
inline double least_gap(const std::vector<double>& roots) {
  double least = 1;
  for (std::size_t i = 1; i < roots.size(); ++i) least = std::min(least, roots[i] - roots[i - 1]);
  return least;
}

}  // namespace oktett::test
