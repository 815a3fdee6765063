#include "kernels/exact/implicit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace oktett {

namespace {

bool is_same(const ImplicitElement& a, const ImplicitElement& b) {
  const auto same = [](const TapeStep& s, const TapeStep& t) {
    return s.op == t.op && s.out == t.out && s.a == t.a && s.b == t.b && s.n == t.n && s.c == t.c;
  };
  return a.size == b.size && a.open == b.open && a.lo == b.lo && a.hi == b.hi &&
         a.function.result == b.function.result &&
         std::ranges::equal(a.function.steps, b.function.steps, same);
}

/// Appends the cells of the element before `element` once more, for that one.
void repeat_cells(std::vector<ExactCell>& cells, std::uint32_t element) {
  const std::size_t end = cells.size();
  std::size_t begin = end;
  while (begin > 0 && cells[begin - 1].element + 1 == element) --begin;
  for (std::size_t k = begin; k < end; ++k) {
    cells.push_back(cells[k]);
    cells.back().element = element;
  }
}

}  // namespace

std::size_t ImplicitPool::bytes() const {
  std::size_t sum = ExactPool::bytes();
  const VariationGrid* last_grid = nullptr;
  const FunctionCells* last_cells = nullptr;
  for (const ImplicitElement& e : elements) {
    sum += e.function.steps.size() * sizeof(TapeStep);
    if (e.grid != nullptr && e.grid.get() != last_grid)
      sum += sizeof(VariationGrid) + e.grid->cells.size() * sizeof(ImplicitGridCell);
    if (e.cells != nullptr && e.cells.get() != last_cells) sum += e.cells->bytes();
    last_grid = e.grid.get(), last_cells = e.cells.get();
  }
  return sum;
}

void Implicit::add(Pool& pool, const ImplicitShape& s, const ExactPlace& place) {
  const Vec3d half = (s.hi - s.lo) * 0.5;
  if (!(half.x > 0 && half.y > 0 && half.z > 0) || !s.function.varies) return;
  for (int k = 0; k < 3; ++k)
    if (!(std::isfinite(s.lo[k]) && std::isfinite(s.hi[k]))) return;
  int shift = 0;
  std::frexp(std::max({half.x, half.y, half.z}), &shift);
  const double size = std::ldexp(1.0, shift), per_size = std::ldexp(1.0, -shift);
  ImplicitElement e{s.function, size, s.open, s.lo * per_size, s.hi * per_size, nullptr, nullptr};
  const auto element = static_cast<std::uint32_t>(pool.elements.size());
  const ImplicitElement* const last = pool.elements.empty() ? nullptr : &pool.elements.back();
  if (last != nullptr && is_same(*last, e)) {
    e.grid = last->grid, e.cells = last->cells;
    repeat_cells(pool.cells, element);
  } else {
    e.cells = divide_function(s.function, {e.lo, e.hi, size, s.open}, element, pool.cells);
    if (e.cells == nullptr) {
      e.grid = std::make_shared<const VariationGrid>(make_variation_grid(s.function, s.lo, s.hi));
      pool.cells.push_back({e.lo, e.hi, element});
    }
  }
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
}

}  // namespace oktett
