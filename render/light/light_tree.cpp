#include "render/light/light_tree.h"

#include "core/four.h"
#include "render/light/light_tree_lanes.h"

namespace oktett {

/// The point in four lanes.
static LightPointLanes<Four> point_lanes(const LightPoint& point) {
  const auto all = [](bool x) { return x ? Four(0.0f) < Four(1.0f) : Four(0.0f) < Four(0.0f); };
  const Vec3f &p = point.position, &n = point.normal;
  return {{p.x, p.y, p.z}, {n.x, n.y, n.z}, all(point.front_only), all(n != Vec3f{})};
}

static Four importances(const LightQuad& quad, const LightPointLanes<Four>& point) {
  const LightQuadLanes<Four> lanes([&](const auto& column) { return Four::load(column(quad)); });
  return light_importances(lanes, point);
}

std::optional<LightTree::Choice> LightTree::choose(const LightPoint& point, SquareSample& s) const {
  if (quads_.empty()) return std::nullopt;
  if (slots_.size() == 1) return Choice{0, 1};
  const LightPointLanes<Four> lanes = point_lanes(point);
  LightWalks<1> walk;
  walk.begin(0, s.x, s.y);
  do {
    const LightQuad& quad = quads_[LightQuad::number(walk.child[0])];
    walk.look_at(0, quad, LightWeights<Four>(quad, importances(quad, lanes)));
    choose_children<1, ScalarIsa>(walk, 0);
    walk.child[0] = quad.child[static_cast<int>(walk.chosen[0])];
  } while (!(walk.child[0] & LightQuad::kLeaf));
  s = {walk.u[0][0], walk.u[1][0]};
  return Choice{LightQuad::number(walk.child[0]), walk.probability[0]};
}

double LightTree::probability(const LightPoint& point, std::uint32_t index) const {
  if (slots_.size() == 1) return 1;
  // From the root, so that the product is the same bits as that of choose().
  std::uint32_t way[kDeepest], steps = 0;
  for (std::uint32_t slot = slots_[index]; slot != kRoot; slot = parents_[slot / 4]) way[steps++] = slot;
  const LightPointLanes<Four> lanes = point_lanes(point);
  double probability = 1;
  while (steps-- > 0) {
    const LightQuad& quad = quads_[way[steps] / 4];
    const LightWeights<Four> weights(quad, importances(quad, lanes));
    probability *= weights.lane[way[steps] % 4] / weights.sum();
  }
  return probability;
}

double LightTree::importance(const LightPoint& point) const {
  if (quads_.empty()) return 0;
  float lane[LightQuad::kLanes];
  importances(quads_[0], point_lanes(point)).store(lane);
  return (double{lane[0]} + double{lane[1]}) + (double{lane[2]} + double{lane[3]});
}

}  // namespace oktett
