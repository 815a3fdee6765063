#pragma once
/// \file Colours in columns, one for each component, so that lanes load and store them as they are.

#include <algorithm>
#include <cstddef>

#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

struct ColorColumn {
  Column<float> part[3];  ///< red, green, blue

  std::size_t size() const { return part[0].size(); }
  bool empty() const { return part[0].empty(); }
  /// Colours that are new hold no defined value.
  void resize_uninitialized(std::size_t n) {
    for (Column<float>& p : part) p.resize_uninitialized(n);
  }
  /// Sets the first `count` colours.
  void fill(std::size_t count, const Color& color) {
    for (int k = 0; k < 3; ++k) std::fill_n(part[k].data(), count, color[k]);
  }
  Color operator[](std::size_t i) const { return {part[0][i], part[1][i], part[2][i]}; }
  void set(std::size_t i, const Color& color) {
    for (int k = 0; k < 3; ++k) part[k][i] = color[k];
  }
  void add(std::size_t i, const Color& color) {
    for (int k = 0; k < 3; ++k) part[k][i] += color[k];
  }
  void push_back(const Color& color) {
    for (int k = 0; k < 3; ++k) part[k].push_back(color[k]);
  }
};

}  // namespace oktett
