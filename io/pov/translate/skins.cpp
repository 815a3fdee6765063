#include "io/pov/translate/skins.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "io/pov/translate/extent.h"

namespace oktett::pov {
namespace {

/// The boxes around those shapes of a solid that have flat faces, in the space that it stands in. Not of more
/// blocks than can be a matter of faces: objects of objects can double at each declaration.
std::vector<Extent> flat_shapes(Context& context, const Block& block, int& most_blocks) {
  constexpr std::array<std::string_view, 3> kFlat{"box", "cylinder", "cone"};
  if (--most_blocks < 0) return {};
  if (std::ranges::find(kFlat, block.keyword) != kFlat.end()) {
    const Extent extent = extent_of(context, block);
    return extent.is_finite() && !has_word(block, "open") ? std::vector{extent} : std::vector<Extent>{};
  }
  std::vector<Extent> all;
  for (const std::shared_ptr<const Block>& inner : objects_in(block))
    std::ranges::copy(flat_shapes(context, *inner, most_blocks), std::back_inserter(all));
  if (all.empty()) return all;
  const Affine map = moves_in(context, block).all;
  for (Extent& extent : all) extent = extent.moved(map);
  return all;
}
std::vector<Extent> flat_shapes(Context& context, const Block& block) {
  int most_blocks = 256;
  return flat_shapes(context, block, most_blocks);
}

/// How far the sides of a box are moved outwards.
struct Growth {
  Vec3d lo{0, 0, 0}, hi{0, 0, 0};

  /// The transform that moves them; empty if none is.
  Moves moves(const Extent& box, const Place& where) const {
    Moves moves;
    Vec3d scale{1, 1, 1}, shift{0, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const double width = box.hi[k] - box.lo[k];
      if ((lo[k] == 0 && hi[k] == 0) || !(width > -lo[k] - hi[k])) continue;
      scale[k] = 1 + (lo[k] + hi[k]) / width, shift[k] = box.lo[k] - lo[k] - scale[k] * box.lo[k];
    }
    if (scale == Vec3d{1, 1, 1}) return moves;
    moves.add({Move::Kind::scale, scale, {}, where});
    moves.add({Move::Kind::translate, shift, {}, where});
    return moves;
  }
};

double size_of(const Extent& box) {
  return std::max({max_component(abs(box.lo)), max_component(abs(box.hi)), max_component(box.hi - box.lo)});
}

}  // namespace

std::vector<Moves> room_for_skins(Context& context, const std::vector<std::shared_ptr<const Block>>& solids,
                                  const std::vector<bool>& counts) {
  const std::vector<Extent> shapes = flat_shapes(context, *solids[0]);
  const Extent whole = extent_of(context, *solids[0]);
  if (shapes.empty() || !whole.is_finite()) return {};
  constexpr double kSame = 1e-9;
  const double size = size_of(whole), skin = 4e-6 * size;
  const auto same = [&](double a, double b) { return std::abs(a - b) <= kSame * size; };
  std::vector<Moves> moves(solids.size());
  Growth first;
  for (std::size_t i = 1; i < solids.size(); ++i) {
    const Extent box = extent_of(context, *solids[i]);
    if (!counts[i] || !box.is_finite() || flat_shapes(context, *solids[i]).empty()) continue;
    // Where it is the outermost face, the skin lies outside, so that what is subtracted ends at its place.
    Growth own;
    for (int k = 0; k < 3; ++k) {
      const auto any = [&](auto&& meets) { return std::ranges::any_of(shapes, meets); };
      if (same(box.lo[k], whole.lo[k]))
        first.lo[k] = skin;
      else if (any([&](const Extent& shape) { return same(box.lo[k], shape.lo[k]); }))
        own.lo[k] = -skin;
      if (same(box.hi[k], whole.hi[k]))
        first.hi[k] = skin;
      else if (any([&](const Extent& shape) { return same(box.hi[k], shape.hi[k]); }))
        own.hi[k] = -skin;
    }
    moves[i] = own.moves(box, solids[i]->where);
  }
  moves[0] = first.moves(whole, solids[0]->where);
  return moves;
}

}  // namespace oktett::pov
