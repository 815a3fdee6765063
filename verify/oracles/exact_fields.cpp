/// \file Metaballs and blob trees.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "verify/oracles/exact_families.h"

namespace oktett {

// ---- Metaballs.

namespace {

ExactOracle oracle_of(const BlobTreeShape& shape);

/// What bounds of distances are widened by.
constexpr double kFieldRoom = 1e-12;

/// Balls by the cells of a grid that they reach into, so that a thousand can be added up.
class BallGrid {
 public:
  BallGrid(const MetaballsShape& shape, const Vec3d& lo, const Vec3d& hi)
      : shape_(shape), lo_(lo), step_((hi - lo) / kCells) {
    for (std::uint32_t i = 0; i < shape.balls.size(); ++i) {
      const MetaBall& b = shape.balls[i];
      int from[3], to[3];
      for (int k = 0; k < 3; ++k)
        from[k] = cell(k, b.center[k] - b.radius * 1.001L), to[k] = cell(k, b.center[k] + b.radius * 1.001L);
      for (int x = from[0]; x <= to[0]; ++x)
        for (int y = from[1]; y <= to[1]; ++y)
          for (int z = from[2]; z <= to[2]; ++z) lists_[(x * kCells + y) * kCells + z].push_back(i);
    }
  }
  Real operator()(const Vec3l& p) const {
    Real f = shape_.iso;
    for (const std::uint32_t i : lists_[(cell(0, p.x) * kCells + cell(1, p.y)) * kCells + cell(2, p.z)]) {
      const MetaBall& b = shape_.balls[i];
      const Vec3l d = p - Vec3l(b.center);
      const Real q = 1 - dot(d, d) / (static_cast<Real>(b.radius) * b.radius);
      if (q > 0) f -= b.strength * q * q;
    }
    return f;
  }

 private:
  static constexpr int kCells = 12;
  int cell(int axis, Real x) const {
    return static_cast<int>(std::clamp(std::floor((x - lo_[axis]) / step_[axis]), 0.0L, kCells - 1.0L));
  }
  MetaballsShape shape_;
  Vec3d lo_, step_;
  std::vector<std::uint32_t> lists_[kCells * kCells * kCells];
};

/// The same sum as a blob tree.
BlobTreeShape as_tree(const MetaballsShape& shape) {
  BlobTreeShape tree{shape.iso, shape.elements, {}};
  for (const MetaBall& b : shape.balls)
    tree.elements.push_back({PointSkeleton{b.center}, {PotentialKind::wyvill, b.radius, 0, b.strength}});
  const auto count = static_cast<std::uint32_t>(tree.elements.size());
  for (std::uint32_t i = 0; i < count; ++i) tree.blends.push_back({Blend::Op::element, i, 0});
  tree.blends.push_back({Blend::Op::sum, 0, count});
  return tree;
}

/// Balls that `change`, which is also told those before, has changed.
template <class F>
ExactOracle draw_balls(CaseRandom& random, double iso, int count, const F& change) {
  MetaballsShape shape{iso, {}};
  for (int i = 0; i < count; ++i) {
    MetaBall ball{random.vector(), 0.3 + random.unit(), 0.6 + random.unit()};
    change(ball, shape.balls);
    shape.balls.push_back(ball);
  }
  return oracle_of(shape);
}

/// From one ball to a dozen; some negative, some at the same place, some touching from outside.
ExactOracle metaballs(CaseRandom& random) {
  const double iso = 0.2 + 0.6 * random.unit();
  const int count = 1 + static_cast<int>(random.unit() * random.unit() * 12);
  return draw_balls(random, iso, count, [&](MetaBall& ball, const std::vector<MetaBall>& others) {
    if (others.empty()) return;
    const auto& other = others[static_cast<std::size_t>(random.unit() * static_cast<double>(others.size()))];
    const double dice = random.unit();
    if (dice < 0.1) ball.center = other.center;
    if (dice < 0.05) ball.radius = other.radius;
    if (dice > 0.9) ball.center = other.center + normalize(random.vector()) * (other.radius + ball.radius);
    if (random.unit() < 0.25) ball.strength = -ball.strength;
  });
}

ExactOracle thousand_metaballs(CaseRandom& random) {
  return draw_balls(random, MetaballsShape{}.iso, 1000, [&](MetaBall& ball, const auto&) {
    ball.radius *= 0.3;
    if (random.unit() < 0.2) ball.strength = -ball.strength;
  });
}

/// So many at one place that no division parts them.
ExactOracle coincident_metaballs(CaseRandom& random) {
  return draw_balls(random, MetaballsShape{}.iso, 40, [&](MetaBall& ball, const auto& others) {
    if (!others.empty()) ball.center = others[0].center;
    ball.strength *= 0.1;
  });
}

}  // namespace

ExactOracle oracle_of(const MetaballsShape& shape) {
  if (!shape.elements.empty()) {
    ExactOracle sum = oracle_of(as_tree(shape));
    sum.shape = {shape};
    return sum;
  }
  ExactOracle oracle{{shape}, {}};
  for (const MetaBall& b : shape.balls)
    if (b.strength > 0) oracle.grow(b.center, b.radius);
  const auto grid = std::make_shared<BallGrid>(shape, oracle.lo, oracle.hi);
  oracle.f = [grid](const Vec3l& p) { return (*grid)(p); };
  // Bounds of many balls at one place add up to more than samples take.
  constexpr std::size_t kFew = 16;
  if (shape.balls.size() <= kFew) oracle.clear = oracle_of(as_tree(shape)).clear;
  return oracle;
}

std::vector<ExactCase> metaball_cases() {
  return {{"metaballs", metaballs},
          {"metaballs_1000", thousand_metaballs},
          {"metaballs_coincident", coincident_metaballs}};
}

// ---- Blob trees, from the potentials and blends as they are written down.

namespace {

template <class R>
R square(const Vec3<R>& v) {
  return dot(v, v);
}

template <class R>
R segment_square(const Vec3<R>& a, const Vec3<R>& b, const Vec3<R>& p) {
  const Vec3<R> e = b - a;
  const R h = square(e) > 0 ? std::clamp(dot(p - a, e) / square(e), R{0}, R{1}) : R{0};
  return square(p - a - e * h);
}

/// A skeleton with what does not depend on the place.
struct Body {
  /// Of an ellipsoid, or two in a polygon's plane and its normal.
  Vec3l axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

Body body_of(const decltype(FieldElement::skeleton)& skeleton) {
  Body body;
  if (const auto* ellipsoid = std::get_if<EllipsoidSkeleton>(&skeleton)) {
    // Turned about x, y and z in that order.
    for (int k = 0; k < 3; ++k) {
      const Real angle = ellipsoid->rotation[k] * std::numbers::pi_v<Real> / 180, c = std::cos(angle),
                 d = std::sin(angle);
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      for (Vec3l& v : body.axis) {
        const Real x = v[i], y = v[j];
        v[i] = c * x - d * y, v[j] = d * x + c * y;
      }
    }
  } else if (const auto* polygon = std::get_if<PolygonSkeleton>(&skeleton)) {
    Vec3l n{0, 0, 0};
    const Vec3l first = Vec3l(polygon->vertices[0]);
    for (std::size_t i = 1; i + 1 < polygon->vertices.size(); ++i)
      n += cross(Vec3l(polygon->vertices[i]) - first, Vec3l(polygon->vertices[i + 1]) - first);
    const Vec3l along = Vec3l(polygon->vertices[1]) - first;
    body.axis[2] = n / std::sqrt(square(n));
    body.axis[0] = along / std::sqrt(square(along));
    body.axis[1] = cross(body.axis[2], body.axis[0]);
  }
  return body;
}

template <class R>
R skeleton_square(const PointSkeleton& s, const Body&, const Vec3<R>& p) {
  return square(p - Vec3<R>(s.center));
}

template <class R>
R skeleton_square(const SegmentSkeleton& s, const Body&, const Vec3<R>& p) {
  return segment_square(Vec3<R>(s.from), Vec3<R>(s.to), p);
}

/// The border winds about the foot of p if that is inside: it passes the half-line from there to the right,
/// up or down, with the foot to its left or right.
template <class R>
R skeleton_square(const PolygonSkeleton& s, const Body& body, const Vec3<R>& p) {
  R edge = HUGE_VALL;
  int winding = 0;
  const Vec3<R> right(body.axis[0]), up(body.axis[1]), normal(body.axis[2]);
  const std::size_t count = s.vertices.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3<R> a(s.vertices[i]), b(s.vertices[(i + 1) % count]);
    edge = std::min(edge, segment_square(a, b, p));
    const R ax = dot(a - p, right), ay = dot(a - p, up), bx = dot(b - p, right), by = dot(b - p, up);
    const R side = ax * by - ay * bx;
    if (ay <= 0 && by > 0 && side > 0) ++winding;
    if (by <= 0 && ay > 0 && side < 0) --winding;
  }
  const R height = dot(p - Vec3<R>(s.vertices[0]), normal);
  return winding != 0 ? height * height : edge;
}

template <class R>
Vec3<R> in_ellipsoid(const EllipsoidSkeleton& s, const Body& body, const Vec3<R>& q) {
  return {dot(q, Vec3<R>(body.axis[0])) / s.radii.x, dot(q, Vec3<R>(body.axis[1])) / s.radii.y,
          dot(q, Vec3<R>(body.axis[2])) / s.radii.z};
}

template <class R>
R skeleton_square(const EllipsoidSkeleton& s, const Body& body, const Vec3<R>& p) {
  return square(in_ellipsoid(s, body, p - Vec3<R>(s.center)));
}

/// How much the root of such a square changes along `way` at most.
double change_along(const EllipsoidSkeleton& s, const Body& body, const Vec3d& way) {
  return length(in_ellipsoid(s, body, way));
}
template <class Skeleton>
double change_along(const Skeleton&, const Body&, const Vec3d& way) {
  return length(way);
}

/// It never rises with the distance.
template <class R>
R potential(const Potential& p, R r2) {
  const R s2 = static_cast<R>(p.scale) * p.scale, r = std::sqrt(r2), q2 = r2 / s2;
  switch (p.kind) {
    case PotentialKind::inverse_square:
      return s2 / r2;
    case PotentialKind::gaussian:
      return std::exp(-p.scale * r2);
    case PotentialKind::quadratic:
      if (r > p.scale) return 0;
      return r <= p.scale / R{3} ? 1 - 3 * r2 / s2 : R{1.5} * (1 - r / p.scale) * (1 - r / p.scale);
    case PotentialKind::rational:
      return q2 > 1 ? 0 : (q2 * q2 - 2 * q2 + 1) / (1 + p.d * q2);
    default:
      return q2 > 1 ? 0 : (1 - q2) * (1 - q2);
  }
}

/// A blob tree with what does not depend on the place.
struct Field {
  explicit Field(BlobTreeShape tree) : shape(std::move(tree)) {
    for (const FieldElement& e : shape.elements) bodies.push_back(body_of(e.skeleton));
  }
  BlobTreeShape shape;
  std::vector<Body> bodies;
};

/// An element's value at a point.
Real value_of(const FieldElement& e, const Body& body, const Vec3l& p) {
  const Real r2 = std::visit([&](const auto& s) { return skeleton_square(s, body, p); }, e.skeleton);
  return e.potential.weight * potential(e.potential, r2);
}

struct Way {
  Vec3d from, to;
};
/// Its values along a way.
Enclosure value_of(const FieldElement& e, const Body& body, const Way& way) {
  return std::visit(
      [&](const auto& s) -> Enclosure {
        const double away = std::sqrt(skeleton_square(s, body, (way.from + way.to) * 0.5)),
                     room = change_along(s, body, (way.to - way.from) * 0.5) + kFieldRoom * (1 + away),
                     least = std::max(away - room, 0.0), most = away + room;
        const double hi = potential(e.potential, least * least), lo = potential(e.potential, most * most);
        return e.potential.weight * Enclosure::between(lo, hi).with_room(kFieldRoom * (1 + std::abs(lo)));
      },
      e.skeleton);
}

/// The value of the blend that ends before `at`, at a point or along a way; moves `at` to where it begins.
template <class T, class Place>
T blend(const Field& field, std::size_t& at, const Place& place) {
  using std::max, std::min;
  const BlobTreeShape& s = field.shape;
  const Blend& b = s.blends[--at];
  if (b.op == Blend::Op::element) return value_of(s.elements[b.element], field.bodies[b.element], place);
  std::vector<T> v(b.count);
  for (std::size_t k = b.count; k-- > 0;) v[k] = blend<T>(field, at, place);
  T all = v[0];
  for (std::size_t k = 1; k < v.size(); ++k)
    all = b.op == Blend::Op::sum   ? all + v[k]
          : b.op == Blend::Op::max ? max(all, v[k])
          : b.op == Blend::Op::min ? min(all, v[k])
                                   : min(all, 2 * static_cast<T>(s.iso) - v[k]);
  return all;
}

/// Within this of a positive element is all that is inside.
double reach_of(const Potential& p, double share) {
  if (p.kind == PotentialKind::inverse_square) return p.scale * std::sqrt(p.weight / share);
  if (p.kind == PotentialKind::gaussian)
    return std::sqrt(std::max(std::log(p.weight / share), 0.0) / p.scale);
  return p.scale;
}

ExactOracle oracle_of(const BlobTreeShape& shape) {
  ExactOracle o{{shape}, {}};
  const double share = shape.iso / static_cast<double>(shape.elements.size());
  for (const FieldElement& e : shape.elements) {
    if (e.potential.weight <= 0) continue;
    const double r = reach_of(e.potential, share);
    if (const auto* s = std::get_if<PointSkeleton>(&e.skeleton)) o.grow(s->center, r);
    if (const auto* s = std::get_if<SegmentSkeleton>(&e.skeleton)) o.grow(s->from, r), o.grow(s->to, r);
    if (const auto* s = std::get_if<PolygonSkeleton>(&e.skeleton))
      for (const Vec3d& v : s->vertices) o.grow(v, r);
    if (const auto* s = std::get_if<EllipsoidSkeleton>(&e.skeleton))
      o.grow(s->center, r * std::max({s->radii.x, s->radii.y, s->radii.z}));
  }
  const auto data = std::make_shared<const Field>(shape);
  o.f = [data](const Vec3l& p) {
    std::size_t at = data->shape.blends.size();
    return data->shape.iso - blend<Real>(*data, at, p);
  };
  o.clear = [data](const Vec3d& a, const Vec3d& b) {
    std::size_t at = data->shape.blends.size();
    const Enclosure f = data->shape.iso - blend<Enclosure>(*data, at, Way{a, b});
    return f.positive() || f.negative();
  };
  return o;
}

/// Plane and simple: a star about its middle, in any plane or one of the axes'.
PolygonSkeleton random_polygon(CaseRandom& random) {
  const bool level = random.unit() < 0.5;
  const Affine place = level ? Affine{} : Affine::rotation(random.vector() * 180.0);
  const Vec3d middle = random.vector() * 0.7;
  const int count = 3 + static_cast<int>(random.unit() * 5);
  PolygonSkeleton s;
  for (int i = 0; i < count; ++i) {
    const double angle = (i + 0.8 * random.unit()) * 2 * std::numbers::pi / count,
                 r = 0.15 + 0.8 * random.unit();
    s.vertices.push_back(middle + place.vector({r * std::cos(angle), r * std::sin(angle), 0}));
  }
  return s;
}

FieldElement random_element(CaseRandom& random) {
  FieldElement e;
  const double dice = random.unit();
  if (dice < 0.3)
    e.skeleton = PointSkeleton{random.vector()};
  else if (dice < 0.6)
    e.skeleton = SegmentSkeleton{random.vector(), random.unit() < 0.1 ? Vec3d{0, 0, 1} : random.vector()};
  else if (dice < 0.8)
    e.skeleton = random_polygon(random);
  else
    e.skeleton = EllipsoidSkeleton{random.vector(),
                                   {0.4 + random.unit(), 0.4 + random.unit(), 0.4 + random.unit()},
                                   random.vector() * 180.0};
  Potential& p = e.potential;
  p.kind = static_cast<PotentialKind>(static_cast<int>(random.unit() * 5));
  p.weight = 0.5 + random.unit();
  p.scale = 0.3 + 0.5 * random.unit();
  if (p.kind == PotentialKind::gaussian) p.scale = 2 + 8 * random.unit();
  if (p.kind == PotentialKind::inverse_square) p.scale *= 0.3;
  if (p.kind == PotentialKind::rational) p.d = random.unit() < 0.5 ? 0 : random.magnitude(-1, 3);
  return e;
}

std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

/// All kinds of elements in one sum.
ExactOracle skeletons(CaseRandom& random) {
  BlobTreeShape s;
  s.iso = 0.2 + 0.4 * random.unit();
  const int count = 1 + static_cast<int>(random.unit() * 6);
  for (int i = 0; i < count; ++i) {
    s.elements.push_back(random_element(random));
    if (i > 0 && random.unit() < 0.25) s.elements.back().potential.weight *= -1;
    s.blends.push_back({Blend::Op::element, index(static_cast<std::size_t>(i)), 0});
  }
  s.blends.push_back({Blend::Op::sum, 0, index(s.elements.size())});
  return oracle_of(s);
}

void random_blend(CaseRandom& random, int level, BlobTreeShape& s) {
  if (level > 0 && (level == 3 || random.unit() < 0.5)) {
    s.elements.push_back(random_element(random));
    if (random.unit() < 0.1) s.elements.back().potential.weight *= -1;
    s.blends.push_back({Blend::Op::element, index(s.elements.size() - 1), 0});
    return;
  }
  const int count = 1 + static_cast<int>(random.unit() * 3);
  for (int i = 0; i < count; ++i) random_blend(random, level + 1, s);
  constexpr Blend::Op kOps[] = {Blend::Op::sum, Blend::Op::max, Blend::Op::min, Blend::Op::difference};
  s.blends.push_back({kOps[static_cast<int>(random.unit() * 4)], 0, index(static_cast<std::size_t>(count))});
}

ExactOracle tree(CaseRandom& random) {
  BlobTreeShape s;
  s.iso = 0.2 + 0.4 * random.unit();
  s.elements.push_back({PointSkeleton{{0, 0, 0}}, {PotentialKind::wyvill, 1, 0, 1}});
  s.blends.push_back({Blend::Op::element, 0, 0});
  random_blend(random, 0, s);
  s.blends.push_back({random.unit() < 0.5 ? Blend::Op::max : Blend::Op::difference, 0, 2});
  return oracle_of(s);
}

/// Capsules and ellipsoids of either sign, some without length, some that touch, some thin; and balls.
ExactOracle capsules(CaseRandom& random) {
  MetaballsShape s{0.2 + 0.6 * random.unit(), {}, {}};
  const int count = 1 + static_cast<int>(random.unit() * 7);
  for (int i = 0; i < count; ++i) {
    FieldElement e;
    e.potential = {PotentialKind::wyvill, 0.2 + random.unit(), 0, 0.6 + random.unit()};
    const double dice = random.unit();
    if (i > 0 && random.unit() < 0.25) e.potential.weight = -e.potential.weight;
    if (dice < 0.2) {
      s.balls.push_back({random.vector(), e.potential.scale, e.potential.weight});
      continue;
    }
    if (dice < 0.7) {
      SegmentSkeleton bone{random.vector(), random.vector()};
      if (random.unit() < 0.1) bone.to = bone.from;
      if (random.unit() < 0.1) bone.to = bone.from + Vec3d{0, 0, random.magnitude(-9, 0)};
      if (random.unit() < 0.2 && !s.elements.empty())
        if (const auto* const other = std::get_if<SegmentSkeleton>(&s.elements[0].skeleton))
          bone.from = other->to;
      e.skeleton = bone;
    } else {
      const double flat = random.unit() < 0.2 ? 0.02 : 1;
      e.skeleton = EllipsoidSkeleton{random.vector(),
                                     {0.4 + random.unit(), 0.4 + random.unit(), flat * (0.4 + random.unit())},
                                     random.vector() * 180.0};
    }
    s.elements.push_back(e);
  }
  const bool any =
      std::ranges::any_of(s.elements, [](const FieldElement& e) { return e.potential.weight > 0; });
  if (!any) s.elements.push_back({SegmentSkeleton{}, {PotentialKind::wyvill, 0.5, 0, 1}});
  return oracle_of(s);
}

}  // namespace

std::vector<ExactCase> blobtree_cases() { return {{"metaballs_skeletons", skeletons}, {"blobtree", tree}}; }

std::vector<ExactCase> capsule_cases() { return {{"metaballs_capsules", capsules}}; }

}  // namespace oktett
