#include "kernels/exact/implicit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace oktett {

namespace {

bool is_same(const FunctionTape& a, const FunctionTape& b) {
  const auto same = [](const TapeStep& s, const TapeStep& t) {
    return s.op == t.op && s.out == t.out && s.a == t.a && s.b == t.b && s.n == t.n && s.c == t.c;
  };
  return a.result == b.result && std::ranges::equal(a.steps, b.steps, same);
}

}  // namespace

std::size_t ImplicitPool::bytes() const {
  std::size_t sum = ExactPool::bytes();
  const VariationGrid* last = nullptr;
  for (const ImplicitElement& e : elements) {
    sum += e.function.steps.size() * sizeof(TapeStep);
    if (e.grid.get() != last) sum += sizeof(VariationGrid) + e.grid->cells.size() * sizeof(GridCell);
    last = e.grid.get();
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
  const ImplicitElement* const last = pool.elements.empty() ? nullptr : &pool.elements.back();
  const bool same = last != nullptr && is_same(last->function, s.function) && last->size == size &&
                    last->lo == s.lo * per_size && last->hi == s.hi * per_size;
  auto grid =
      same ? last->grid : std::make_shared<const VariationGrid>(make_variation_grid(s.function, s.lo, s.hi));
  const ImplicitElement e{s.function, size, s.open, s.lo * per_size, s.hi * per_size, std::move(grid)};
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
  add_cell(pool, e.lo, e.hi);
}

}  // namespace oktett
