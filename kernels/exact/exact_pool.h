#pragma once
/// \file The pool of an exact surface: its elements, and the cells in which they are looked for.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/platform.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "kernels/exact/normal_method.h"

namespace oktett {

/// Where one element is looked for: a box of its own space, possibly infinite.
struct ExactCell {
  Vec3d lo, hi;
  std::uint32_t element = 0;
  std::uint32_t begin = 0, count = 0;  ///< for the shape's own use, e.g. what matters in this cell
};

/// Where a shape stands in the world, and how its normals are computed.
struct ExactPlace {
  Affine to_world;
  std::uint32_t item = 0;
  NormalMethod normals = NormalMethod::gradient;
};

/// How an element lies in the world.
struct ExactFrame {
  Affine to_own, to_world;
  std::uint32_t item = 0;
  NormalMethod normals = NormalMethod::gradient;
};

/// What the pools of all surfaces have in common.
struct ExactPoolBase {
  virtual ~ExactPoolBase();

  std::vector<ExactFrame> frames;  ///< per element; their items ascend
  std::vector<ExactCell> cells;

  OKTETT_INLINE std::uint32_t item_of_cell(std::uint32_t cell) const {
    return frames[cells[cell].element].item;
  }
};

template <class E>
struct ExactPool : ExactPoolBase {
  using Element = E;
  std::vector<Element> elements;

  std::size_t bytes() const {
    return frames.size() * sizeof(ExactFrame) + elements.size() * sizeof(Element) +
           cells.size() * sizeof(ExactCell);
  }
};

/// Appends an element of the shape at `place`. `to_world` takes the element's own space to the world.
template <class Pool>
void add_element(Pool& pool, const typename Pool::Element& element, const Affine& to_world,
                 const ExactPlace& place) {
  pool.frames.push_back({to_world.inverse(), to_world, place.item, place.normals});
  pool.elements.push_back(element);
}

/// Appends a cell of the last element.
template <class Pool>
ExactCell& add_cell(Pool& pool, const Vec3d& lo, const Vec3d& hi) {
  return pool.cells.emplace_back(ExactCell{lo, hi, static_cast<std::uint32_t>(pool.elements.size() - 1)});
}

/// A bound on the length of `map`.vector(v) over that of v: the root of the sum of the squared coefficients
/// (the Frobenius norm), which is at most sqrt(3) times the greatest quotient.
inline double stretch(const Affine& map) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3d row{map.m[i][0], map.m[i][1], map.m[i][2]};
    sum += dot(row, row);
  }
  return std::sqrt(sum);
}

}  // namespace oktett
