#pragma once
/// \file Boolean combinations of solids (slides: intervals along the ray, combined up the tree). The solids
/// of one combination stand in a structure of their own; a ray's crossings with all of them are gathered
/// there, sorted, and swept once.
///
/// Departs from the slides in that no intervals are built: each crossing turns the state of one operand, and
/// only the nodes above it whose state turns with it are looked at, so that k crossings among any number of
/// operands cost about k log k.

#include <cstdint>
#include <vector>

#include "accel/csg_item.h"
#include "accel/hit_list.h"
#include "core/box.h"

namespace oktett {

/// The expression with all its solids moved.
CsgExpression moved(CsgExpression e, const Affine& m);

/// The combination's nodes, and the structure over its solids.
CsgItem build_csg(const CsgExpression& expression, const BuildOptions& options);

/// A box that holds the solid: intersections and differences are smaller than their operands. Empty if there
/// is nothing, infinite if it is unbounded.
Box csg_bounds(const CsgItem& csg);

/// Distances by which crossings count as coincident: what rounding t to float, and the surfaces themselves,
/// leave open.
inline float coincidence(float t, float slack) { return t * 0x1p-21f + slack; }

/// The slack for a ray: a few roundings of the coordinates in `accel`, in units of t.
float coincidence_slack(const Accel& accel, const Ray& ray);

/// The steps for the operands `operands` (nodes, `count` of them) and all nodes above them; each operand is
/// replaced by its place among the steps. The root comes first. Valid until the next call on this thread.
std::vector<CsgStep>& csg_steps(const CsgItem& csg, std::uint32_t* operands, int count);

/// One ray's way through a combination. Crossings that coincide are applied together, so that spans without
/// length vanish; of those that turn the whole, the one of the same turn with the least item counts.
class CsgSweep {
 public:
  CsgSweep();
  ~CsgSweep();
  CsgSweep(const CsgSweep&) = delete;
  CsgSweep& operator=(const CsgSweep&) = delete;

  /// To be filled with the crossings of the ray, from its beginning to infinity, with csg.solids, in any
  /// order.
  HitList& solids() { return list_; }
  /// The first crossing of the combination; its path in `csg` says which surface is seen, and from what side.
  bool first(const CsgItem& csg, const Ray& ray, Crossing& found);
  /// Appends all crossings within the ray's range.
  void all(const CsgItem& csg, const Ray& ray, HitList& out);

 private:
  HitList list_;
};

}  // namespace oktett
