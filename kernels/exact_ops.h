#pragma once
/// \file What every exact surface can do, called without its type: one table of functions for each line
/// of kernels/exact/surfaces.def.

#include <memory>

#include "core/box.h"
#include "kernels/closed/surface_points.h"
#include "kernels/exact/exact.h"
#include "kernels/exact_form.h"
#include "kernels/kinds.h"

namespace oktett {

/// Pools that are passed here must come from `make_pool` of the same table.
struct ExactOps {
  const char* name;    ///< as in surfaces.def
  int most_crossings;  ///< S::kMaxCrossings
  bool one_cell;       ///< S::kOneCell
  bool sheets;         ///< S::kSheets

  std::unique_ptr<ExactPoolBase> (*make_pool)();
  /// Appends the element that `shape`, which must be of this surface, describes, and its cells; nothing if
  /// the shape is degenerate.
  void (*add)(ExactPoolBase& pool, const ExactShape& shape, const Affine& to_world, std::uint32_t item);
  /// Bounds of a cell in the world; empty if it is not bounded.
  Box (*cell_bounds)(const ExactPoolBase& pool, const ExactCell& cell);
  /// Whether p, in the element's own space, is inside.
  bool (*inside)(const ExactPoolBase& pool, std::size_t element, const Vec3d& p);
  /// Sets all but the names of the interaction of a hit that `ray` had with the element.
  void (*interaction)(const ExactPoolBase& pool, std::size_t element, const Ray& ray, const Hit& hit,
                      SurfaceInteraction& s);
  /// The same; uv and tangents may be missing.
  void (*interaction_without_uv)(const ExactPoolBase& pool, std::size_t element, const Ray& ray,
                                 const Hit& hit, SurfaceInteraction& s);
  /// Texture coordinates at `own`, a point on the surface in the element's own space, as `interaction` has
  /// them; null if the surface has none. `part` is Hit::u.
  Vec2f (*uv)(const ExactPoolBase& pool, std::size_t element, int part, const Vec3d& own);
  std::size_t (*bytes)(const ExactPoolBase& pool);
  /// The point of the surface nearest to p. `to_world` takes the element's own space to that of p; is_kept_by
  /// must be true for it. Null if the surface does not tell.
  SurfaceNearest (*closest)(const ExactPoolBase& pool, std::size_t element, const Affine& to_world,
                            const Vec3d& p);
  /// Whether the surface keeps its form, up to its size, under the map from an element's own space.
  bool (*is_kept_by)(const Affine& to_world);

  /// Whether a cell lists all of its crossings, at most four, at once.
  bool lists_at_once() const { return one_cell && most_crossings <= 4; }
};

/// The table of an exact kind.
const ExactOps& exact_ops(Kind kind);
Kind kind_of(const ExactForm& form);

/// The image of a cell of an element in `frame`, rounded outwards; empty if the cell is not bounded.
Box cell_bounds(const ExactFrame& frame, const ExactCell& cell);
/// Bounds of `shape`; empty if it is degenerate or not bounded.
Box exact_bounds(const ExactShape& shape, const Affine& to_world);
bool is_unbounded(const ExactShape& shape, const Affine& to_world);

}  // namespace oktett
