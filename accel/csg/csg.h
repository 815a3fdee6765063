#pragma once
/// \file Boolean combinations of solids (Zachmann 2010: intervals along the ray, combined up the tree). The
/// solids of one combination stand in a structure of their own. A ray's crossings with all of them are
/// gathered, sorted, and swept once from near to far.
///
/// Departs from Zachmann 2010: no intervals are built. Each crossing changes the state of one operand, and
/// the change is followed up the expression only as far as states change, so k crossings take about k log k
/// steps however many operands there are.

#include <cstdint>
#include <vector>

#include "accel/accel.h"
#include "accel/accel_data.h"
#include "accel/hit_sink.h"
#include "core/box.h"

namespace oktett {

/// The expression with all its solids moved.
CsgExpression moved(CsgExpression e, const Affine& m);

/// The combination's nodes, and the structure over its solids.
CsgItem build_csg(const CsgExpression& expression, const BuildOptions& options);

/// A box that holds the solid: intersections and differences are smaller than their operands. Empty if there
/// is nothing, infinite if it is unbounded.
Box csg_bounds(const CsgItem& csg);

/// Whether a ray that does not cross the boundary of `geometry`, which is unbounded, runs inside it from
/// ray.tmin on.
bool runs_inside(const Accel& accel, std::uint32_t geometry, const Ray& ray);

/// Whether a ray, taken from tmin to infinity, runs through all windows of the combination.
bool runs_through_windows(const CsgItem& csg, const Ray& ray);

/// The distance within which crossings from `t` on count as coincident: it covers the rounding of t to float
/// and the errors of the surfaces.
inline float coincidence(float t, float slack) { return t * 0x1p-21f + slack; }

/// The slack for a ray: a few roundings of the coordinates in `accel`, in units of t.
float coincidence_slack(const Accel& accel, const Ray& ray);

/// The steps that evaluate an expression whose operands are empty but for the `count` nodes `operands`; each
/// of these is replaced by the index of its step. The root comes first. Valid until the next call on this
/// thread.
std::vector<CsgStep>& csg_steps(const CsgItem& csg, std::uint32_t* operands, int count);

/// One ray through a combination. Crossings that coincide are applied together, so that spans without length
/// vanish. If they change whether the ray is inside the combination, the hit is one of them: the nearest that
/// enters or leaves its solid as the ray does the combination, at equal distance the one with the lowest
/// (instance, item). Surfaces of CsgOp::surfaces change nothing; they are seen as they would be just before
/// or just behind what coincides with them.
class CsgSweep {
 public:
  CsgSweep();
  ~CsgSweep();
  CsgSweep(const CsgSweep&) = delete;
  CsgSweep& operator=(const CsgSweep&) = delete;

  /// The caller appends here all crossings of the ray with csg.solids, from tmin to infinity, in any order.
  HitList& solids() { return list_; }
  /// The first crossing of the combination, or false if there is none. Its path says which surface is hit,
  /// and whether its normal is turned round (csg_path()).
  bool first(const CsgItem& csg, const Ray& ray, Crossing& found);
  /// Appends all crossings within the ray's range.
  void all(const CsgItem& csg, const Ray& ray, HitList& out);

 private:
  HitList list_;
};

}  // namespace oktett
