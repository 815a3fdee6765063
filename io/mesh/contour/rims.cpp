#include "io/mesh/contour/rims.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace oktett {
namespace {

/// Bisections of the width of a cell.
constexpr int kSteps = 16;
/// Rays along an edge follow a curve whose normal has at least this component along the edge.
constexpr float kSteepest = 0.15f;
/// Searches that a task takes.
constexpr std::size_t kSearchesOfTask = 256;

/// The search from one slot.
struct RimSearch {
  SlotNumber slot;
  int axis, towards;  ///< of the edge, and across it in the face
  double from, to;    ///< coordinates along `towards`; the curve is at `from` and not at `to`
  double lo, hi;      ///< the ends of the edge
  Vec3d at;           ///< the last place of the curve
  Vec3f normal;
  double tip_side;  ///< direction of the search, 1 or -1
  bool turns;       ///< the curve comes back to the edge
};

/// The direction across the edge of a slot: the axis, and 1 or -1.
std::pair<int, int> direction_of(SlotNumber slot, int axis) {
  const std::uint32_t s = slot % kSlots;
  return {(axis + (s < 2 ? 2 : 1)) % 3, s % 2 == 0 ? 1 : -1};
}

void step(const Accel& accel, std::vector<RimSearch>& searches) {
  RayBatch rays;
  for (const RimSearch& search : searches) {
    Vec3d origin = search.at;
    origin[search.axis] = search.lo, origin[search.towards] = (search.from + search.to) / 2;
    Vec3f direction;
    direction[search.axis] = 1;
    rays.push_back({Vec3f(origin), 0, direction, static_cast<float>(search.hi - search.lo)});
  }
  struct Found {
    double off;
    ContourSample sample;
  };
  std::vector<Found> found(searches.size(), {HUGE_VAL, {}});
  for (const ContourSample& sample : sample_rays(accel, rays)) {
    const RimSearch& search = searches[sample.ray];
    const double across = (search.to - search.from) / 2;
    // Where the tangent meets the ray.
    const auto n = [&](int axis) { return static_cast<double>(search.normal[axis]); };
    const double along = -n(search.towards) / n(search.axis) * across;
    const double off = std::abs(sample.position[search.axis] - (search.at[search.axis] + along));
    const bool same = dot(sample.normal, search.normal) > 0.3f;
    const double allowed =
        search.turns ? search.hi - search.lo : 1.5 * std::abs(across) + 0.5 * std::abs(along);
    if (same && off <= allowed && off < found[sample.ray].off) found[sample.ray] = {off, sample};
  }
  for (std::size_t i = 0; i < searches.size(); ++i) {
    RimSearch& search = searches[i];
    const double middle = (search.from + search.to) / 2;
    if (found[i].off == HUGE_VAL) {
      search.to = middle;
      continue;
    }
    search.from = middle, search.at = found[i].sample.position;
    if (std::abs(found[i].sample.normal[search.axis]) >= kSteepest) search.normal = found[i].sample.normal;
  }
}

}  // namespace

std::vector<RimPoint> find_rims(const Accel& accel, const ContourGrid& grid,
                                const ContourCrossings& crossings, const std::vector<SlotNumber>& links) {
  std::vector<RimSearch> all;
  for (SlotNumber slot = 0; slot < links.size(); ++slot) {
    const ContourCrossing& crossing = crossings.all[slot / kSlots];
    const int axis = crossing.axis;
    bool turns = false;
    if (links[slot] != kNoId) {
      const ContourCrossing& other = crossings.all[links[slot] / kSlots];
      turns = other.axis == crossing.axis && other.place == crossing.place;
      if (!turns || links[slot] < slot) continue;
    }
    if (std::abs(crossing.normal[axis]) < kSteepest) continue;
    const auto [towards, side] = direction_of(slot, axis);
    RimSearch search;
    search.slot = slot, search.axis = axis, search.towards = towards, search.turns = turns;
    search.tip_side = side;
    const std::int32_t begin = crossing.place[static_cast<std::size_t>(towards)];
    search.from = grid.node(towards, begin), search.to = grid.node(towards, begin + side);
    const std::int32_t lower = crossing.place[static_cast<std::size_t>(axis)];
    search.lo = grid.node(axis, lower), search.hi = grid.node(axis, lower + 1);
    search.at = crossings.position(grid, slot / kSlots), search.normal = crossing.normal;
    all.push_back(search);
  }
  std::vector<RimPoint> rims(all.size());
  Chunks(all.size(), kSearchesOfTask).each(true, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<RimSearch> searches(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                    all.begin() + static_cast<std::ptrdiff_t>(end));
    for (int k = 0; k < kSteps; ++k) step(accel, searches);
    for (std::size_t i = begin; i < end; ++i) {
      const RimSearch& search = searches[i - begin];
      rims[i] = {search.slot, search.at, search.normal};
      if (!search.turns || std::abs(search.normal[search.axis]) < 0.5f) continue;
      // The edge of a plate, between whose sides no ray along them was: it faces the way of the search.
      rims[i].normal = {};
      rims[i].normal[search.towards] = static_cast<float>(search.tip_side);
    }
  });
  return rims;
}

const RimPoint* find_rim(const std::vector<RimPoint>& rims, SlotNumber slot) {
  const auto found = std::ranges::lower_bound(rims, slot, {}, &RimPoint::slot);
  return found != rims.end() && found->slot == slot ? &*found : nullptr;
}

}  // namespace oktett
