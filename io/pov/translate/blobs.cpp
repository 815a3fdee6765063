#include "io/pov/translate/blobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "io/pov/translate/blob_textures.h"

namespace oktett::pov {
namespace {

/// What a linear map makes of the unit ball: its half axes are `radii` along the axes that are turned by
/// `rotation`, degrees about x, then y, then z.
struct Ellipsoid {
  Vec3d radii, rotation;
};

/// By Jacobi's rotations of M M^T, whose eigenvectors are the directions of the half axes.
Ellipsoid ellipsoid_of(const Affine& map) {
  double a[3][3], turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      a[i][j] = map.m[i][0] * map.m[j][0] + map.m[i][1] * map.m[j][1] + map.m[i][2] * map.m[j][2];
  constexpr int kSweeps = 20, kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (const auto& [p, q] : kPairs) {
      if (a[p][q] == 0) continue;
      const double angle = 0.5 * std::atan2(2 * a[p][q], a[p][p] - a[q][q]);
      const double c = std::cos(angle), s = std::sin(angle);
      const auto rotate = [&](double& x, double& y) {
        const double old = x;
        x = c * old + s * y, y = c * y - s * old;
      };
      for (auto& row : a) rotate(row[p], row[q]);
      for (int k = 0; k < 3; ++k) rotate(a[p][k], a[q][k]);
      for (auto& row : turn) rotate(row[p], row[q]);
      a[p][q] = a[q][p] = 0;
    }
  Ellipsoid e;
  for (int k = 0; k < 3; ++k) e.radii[k] = std::sqrt(std::max(a[k][k], 0.0));
  const double det = turn[0][0] * (turn[1][1] * turn[2][2] - turn[1][2] * turn[2][1]) -
                     turn[0][1] * (turn[1][0] * turn[2][2] - turn[1][2] * turn[2][0]) +
                     turn[0][2] * (turn[1][0] * turn[2][1] - turn[1][1] * turn[2][0]);
  if (det < 0)
    for (auto& row : turn) row[2] = -row[2];
  // The angles of Rz Ry Rx.
  const double sine = std::clamp(-turn[2][0], -1.0, 1.0);
  const bool upright = std::abs(sine) > 1 - 1e-12;
  e.rotation = {upright ? 0 : std::atan2(turn[2][1], turn[2][2]), std::asin(sine),
                upright ? std::atan2(-turn[0][1], turn[1][1]) : std::atan2(turn[1][0], turn[0][0])};
  // Not -0.
  e.rotation = e.rotation * (180 / std::numbers::pi) + Vec3d{0, 0, 0};
  return e;
}

class BlobMaker {
 public:
  BlobMaker(Context& context, Arguments& a) : context_(context), tree_(context.tree), a_(a) {}

  std::optional<Shapes> make() {
    const Place& where = a_.block().where;
    double threshold = 1;
    const Node keys = tree_.map(where), elements = tree_.list(where);
    while (!a_.at_end()) {
      if (a_.take_word("threshold")) {
        threshold = a_.number("a threshold");
      } else if (const Block* const block = a_.peek_block(); block != nullptr && is_component(*block)) {
        a_.take();
        add_component(*block, elements);
      } else if (a_.take_word("component")) {
        // The order of old scenes.
        const double strength = a_.number("a strength"), radius = std::abs(a_.number("a radius"));
        const Vec3d at = a_.vector("a point");
        add(where, elements, "point", tree_.vector(where, at), strength, radius);
        parts_.push_back({{strength, radius, at, at, {}}, nullptr});
      } else {
        break;
      }
    }
    if (!any_positive_) return left_out("the blob has no component of positive strength");
    if (!(threshold > 0)) return left_out("the threshold of the blob is not above 0");
    tree_.put(keys, "iso", tree_.number(where, threshold)), tree_.put(keys, "elements", elements);
    Shapes shapes;
    shapes.parts.push_back({"metaballs", keys, blended_texture(context_, a_.block(), parts_), {}});
    return shapes;
  }

 private:
  std::optional<Shapes> left_out(const std::string& why) {
    context_.warn(a_.block().where, fmt::format("{}; the object is left out", why));
    return std::nullopt;
  }

  static bool is_component(const Block& block) {
    return block.keyword == "sphere" || block.keyword == "cylinder";
  }

  void add(const Place& where, Node elements, std::string_view key, Node skeleton, double strength,
           double radius) {
    const Node element = tree_.map(where, key, skeleton);
    tree_.put(element, "weight", tree_.number(where, strength));
    tree_.put(element, "radius", tree_.number(where, radius));
    Tree::push(elements, element);
    any_positive_ |= strength > 0;
  }

  void add_component(const Block& block, Node elements) {
    Arguments a(context_, block);
    const bool is_segment = block.keyword == "cylinder";
    Vec3d from, to;
    from = a.vector("a point");
    if (is_segment) to = a.vector("a point");
    const double radius = std::abs(a.number("a radius"));
    a.take_word("strength");
    const double strength = a.number("a strength");
    Moves moves;
    while (!a.at_end())
      if (!take_moves(context_, a, moves)) a.take();
    if (moves.all.is_invertible())
      parts_.push_back({{strength, radius, from, is_segment ? to : from, moves.all.inverse()},
                        has_own_texture(block) ? texture_of_component(block) : nullptr});
    const Place& w = block.where;
    const Node at = tree_.vector(w, moves.all.point(from));
    const Ellipsoid e = ellipsoid_of(moves.all);
    const double greatest = max_component(e.radii);
    const bool even = greatest - std::min({e.radii.x, e.radii.y, e.radii.z}) < 1e-9 * greatest;
    if (is_segment) {
      if (!even)
        context_.tell("blob scale", w,
                      "cylinders of blobs that are stretched along one axis are scaled evenly");
      const Node ends = tree_.map(w, "from", at);
      tree_.put(ends, "to", tree_.vector(w, moves.all.point(to)));
      add(w, elements, "segment", ends, strength, radius * std::cbrt(e.radii.x * e.radii.y * e.radii.z));
    } else if (even) {
      add(w, elements, "point", at, strength, radius * e.radii.x);
    } else {
      const Node egg = tree_.map(w, "center", at);
      tree_.put(egg, "radii", tree_.vector(w, e.radii)),
          tree_.put(egg, "rotate", tree_.vector(w, e.rotation));
      add(w, elements, "ellipsoid", egg, strength, radius);
    }
  }

  Context& context_;
  Tree& tree_;
  Arguments& a_;
  bool any_positive_ = false;
  std::vector<BlobPart> parts_;
};

}  // namespace

std::optional<Shapes> make_blob(Context& context, Arguments& arguments) {
  return BlobMaker(context, arguments).make();
}

}  // namespace oktett::pov
