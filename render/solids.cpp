#include "render/solids.h"

#include <algorithm>

#include "core/mesh_geometry.h"

namespace oktett {

namespace {

struct IsSolid {
  const std::vector<Prototype>& prototypes;

  bool operator()(const MeshShape& shape) const {
    return shape.mesh != nullptr && (shape.by_winding || find_open_edges(*shape.mesh).count == 0);
  }
  bool operator()(const ExactShape& shape) const { return !is_open(shape); }
  bool operator()(const InstanceShape& shape) const {
    if (shape.prototype >= prototypes.size()) return false;
    const std::vector<Object>& objects = prototypes[shape.prototype].objects;
    return std::ranges::all_of(objects, [&](const Object& o) { return std::visit(*this, o.shape); });
  }
  template <class T>
  bool operator()(const T&) const {
    return !kIsFlat<T>;
  }
};

}  // namespace

bool is_solid(const Shape& shape, const std::vector<Prototype>& prototypes) {
  return std::visit(IsSolid{prototypes}, shape);
}

}  // namespace oktett
