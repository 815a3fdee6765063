#include "verify/oracles/known_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/random.h"
#include "verify/oracles/exact_families.h"
#include "verify/oracles/mesh.h"

namespace oktett {

namespace {

KnownShape sphere(CaseRandom& random) {
  const SphereShape s{random.vector() * 0.5, random.magnitude(-1, 0.2)};
  KnownShape known{s, {}};
  known.truth.f = [s](const Vec3l& p) {
    const Vec3l d = p - Vec3l(s.center);
    return dot(d, d) - static_cast<Real>(s.radius) * s.radius;
  };
  known.truth.grow(s.center, s.radius);
  return known;
}

/// Each sphere is seen, also inside of others, so the function changes its sign at each.
KnownShape spheres(CaseRandom& random) {
  SpheresShape s;
  KnownShape known;
  const int count = 1 + static_cast<int>(random.magnitude(0, 1.5));
  for (int i = 0; i < count; ++i) {
    s.spheres.push_back({random.vector(), random.magnitude(-2, -0.3)});
    known.truth.grow(s.spheres.back().center, s.spheres.back().radius);
  }
  known.shape = s;
  known.truth.f = [s](const Vec3l& p) {
    Real product = 1;
    for (const SphereShape& one : s.spheres) {
      const Vec3l d = p - Vec3l(one.center);
      product *= std::sqrt(dot(d, d)) - one.radius;
    }
    return product;
  };
  // They have no common inside.
  known.truth.where = [](const Vec3l&) { return Real(-1); };
  return known;
}

KnownShape plane(CaseRandom& random) {
  const Vec3d normal = random.vector();
  const PlaneShape s{normal * random.magnitude(-3, 3), random.sign()};
  KnownShape known{s, {}};
  known.truth.f = [s](const Vec3l& p) {
    const Vec3l n(s.normal);
    return dot(n, p) / std::sqrt(dot(n, n)) - s.offset;
  };
  known.truth.lo = {-4, -4, -4}, known.truth.hi = {4, 4, 4};
  return known;
}

KnownShape disk(CaseRandom& random) {
  DiskShape s{random.vector() * 0.5, random.vector(), random.magnitude(-1, 0.2)};
  if (random.unit() < 0.4) s.inner_radius = s.radius * random.unit();
  KnownShape known{s, {}};
  known.truth.f = [s](const Vec3l& p) {
    const Vec3l n(s.normal);
    return dot(n, p - Vec3l(s.center)) / std::sqrt(dot(n, n));
  };
  known.truth.where = [s](const Vec3l& p) {
    const Vec3l d = p - Vec3l(s.center);
    const Real away = std::sqrt(dot(d, d));
    return std::max(away - s.radius, s.inner_radius - (s.inner_radius > 0 ? away : 0));
  };
  known.truth.grow(s.center, s.radius);
  return known;
}

KnownShape box(CaseRandom& random) {
  BoxShape s{random.vector(), {}};
  for (int k = 0; k < 3; ++k) s.max[k] = s.min[k] + random.magnitude(-1.5, 0.3);
  KnownShape known{s, {}};
  known.truth.f = [s](const Vec3l& p) { return outside(s.min, s.max, p); };
  known.truth.lo = s.min, known.truth.hi = s.max;
  return known;
}

/// How far p is outside of the polygon in its plane, negative inside: the distance from the nearest edge. Its
/// sign is that of the angle by which the edges turn about p.
Real outside_ring(const std::vector<Vec3d>& vertices, const Vec3l& normal, const Vec3l& p) {
  Real nearest = HUGE_VALL, angle = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3l a = Vec3l(vertices[i]) - p, b = Vec3l(vertices[(i + 1) % vertices.size()]) - p, e = b - a;
    const Real t = std::clamp(-dot(a, e) / dot(e, e), Real(0), Real(1));
    const Vec3l q = a + e * t;
    nearest = std::min(nearest, std::sqrt(dot(q, q)));
    angle += std::atan2(dot(normal, cross(a, b)), dot(a, b));
  }
  return std::abs(angle) > std::numbers::pi_v<Real> ? -nearest : nearest;
}

Real outside_polygon(const PolygonShape& s, const Vec3l& normal, const Vec3l& p) {
  Real away = outside_ring(s.vertices, normal, p);
  for (const PolygonHole& hole : s.holes) away = std::max(away, -outside_ring(hole.vertices, normal, p));
  return away;
}

/// A star of points at random distances in a plane, perhaps with a triangular hole.
KnownShape polygon(CaseRandom& random) {
  PolygonShape s;
  const Affine shift = Affine::translation(random.vector() * 0.5);
  const Affine turn = shift * Affine::rotation(random.vector() * 180.0);
  const int count = 3 + static_cast<int>(random.magnitude(0, 1.6)) - 1;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.8 * random.unit()) / count;
    const double radius = count == 3 ? 1 : 0.2 + random.unit();
    s.vertices.push_back(turn.point({radius * std::cos(angle), radius * std::sin(angle), 0}));
  }
  if (random.unit() < 0.4 && count > 3) {
    // Within the least distance of an edge from the middle.
    double least = 1;
    for (std::size_t i = 0; i < s.vertices.size(); ++i) {
      const Vec3d a = s.vertices[i], b = s.vertices[(i + 1) % s.vertices.size()], m = turn.point({0, 0, 0});
      const double t = std::clamp(dot(m - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
      least = std::min(least, length(a + (b - a) * t - m));
    }
    s.holes.resize(1);
    for (int i = 0; i < 3; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.5 * random.unit()) / 3, radius = 0.9 * least;
      s.holes[0].vertices.push_back(turn.point({radius * std::cos(angle), radius * std::sin(angle), 0}));
    }
  }
  KnownShape known{s, {}};
  const Vec3d at = turn.point({0, 0, 0});
  const Vec3l normal(turn.vector({0, 0, 1}));
  const auto height = [at, normal](const Vec3l& p) { return dot(normal, p - Vec3l(at)); };
  known.truth.f = height;
  known.truth.where = [s, normal, height](const Vec3l& p) {
    return outside_polygon(s, normal, p - normal * height(p));
  };
  known.truth.grow(at, 1.2);
  return known;
}

KnownShape triangle(CaseRandom& random) {
  TriangleShape s;
  for (Vec3d& v : s.v) v = random.vector();
  if (random.unit() < 0.2) s.v[1] = s.v[0] + (s.v[1] - s.v[0]) * random.magnitude(-4, -1);
  return {s, {}};
}

KnownShape closed_mesh(CaseRandom& random) {
  static const std::vector<std::shared_ptr<const TriangleMesh>> meshes = [] {
    std::vector<std::shared_ptr<const TriangleMesh>> all;
    for (const OracleMesh& m : {make_cube(), make_icosphere(1), make_icosphere(3), make_torus(24, 12),
                                make_globe(30, 10), make_needles(40)})
      all.push_back(std::make_shared<TriangleMesh>(m.mesh));
    return all;
  }();
  MeshShape s;
  s.mesh = meshes[random.bits() % meshes.size()];
  if (random.unit() < 0.2) s.test = static_cast<TriangleTest>(random.bits() % 4);
  return {s, {}};
}

/// Triangles that cross each other, of many sizes, some of them slivers, and some with equal corners.
KnownShape triangle_soup(CaseRandom& random) {
  const auto mesh = std::make_shared<TriangleMesh>();
  const int count = static_cast<int>(random.magnitude(0, 2.5));
  for (int i = 0; i < count; ++i) {
    const Vec3d at = random.vector();
    const double size = random.magnitude(-3, 0.3), thin = random.unit() < 0.2 ? random.magnitude(-5, 0) : 1;
    const Vec3d a = random.vector() * size, b = random.vector() * (size * thin);
    for (const Vec3d& p : {at, at + a, at + a * random.unit() + b}) {
      const bool again = random.unit() < 0.1 && !mesh->positions.empty();
      if (!again) mesh->positions.push_back(Vec3f(p));
      const std::size_t last = mesh->positions.size() - 1;
      mesh->indices.push_back(static_cast<std::uint32_t>(again ? random.bits() % (last + 1) : last));
    }
  }
  MeshShape s;
  s.mesh = mesh;
  return {s, {}};
}

struct Kind {
  const char* name;
  KnownShape (*draw)(CaseRandom&);
};
constexpr Kind kOtherKinds[] = {{"sphere", sphere},
                                {"spheres", spheres},
                                {"plane", plane},
                                {"disk", disk},
                                {"box", box},
                                {"polygon", polygon},
                                {"triangle", triangle},
                                {"closed_mesh", closed_mesh},
                                {"triangle_soup", triangle_soup}};

}  // namespace

const std::vector<std::string>& known_kinds() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> names = exact_oracle_names();
    for (const Kind& kind : kOtherKinds) names.emplace_back(kind.name);
    return names;
  }();
  return kinds;
}

KnownShape draw_known_shape(std::size_t kind, std::uint64_t number) {
  CaseRandom random(exact_key(kind, number));
  const std::size_t exact = known_kinds().size() - std::size(kOtherKinds);
  if (kind >= exact) return kOtherKinds[kind - exact].draw(random);
  ExactOracle oracle = draw_exact_oracle(kind, random);
  // Any of the root finders whose answers are proved, or replaced by such as are.
  constexpr roots::Method kFinders[] = {roots::Method::automatic, roots::Method::closed,
                                        roots::Method::bernstein, roots::Method::sturm};
  const roots::Method finder = kFinders[random.bits() % std::size(kFinders)];
  std::visit(
      [&](auto& form) {
        if constexpr (requires { form.root_finder; }) form.root_finder = finder;
      },
      oracle.shape.form);
  return {oracle.shape, std::move(oracle)};
}

std::string known_name(std::size_t kind, std::uint64_t number) {
  return fmt::format("{}.{}", known_kinds()[kind], number);
}

std::optional<KnownShape> known_shape(const std::string& name) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) return std::nullopt;
  const auto& kinds = known_kinds();
  const auto kind = std::ranges::find(kinds, std::string_view(name).substr(0, dot));
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + dot + 1, name.data() + name.size(), number);
  if (kind == kinds.end() || error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return draw_known_shape(static_cast<std::size_t>(kind - kinds.begin()), number);
}

// ---- Random scenes of shapes of all kinds.

namespace {

class SceneMaker {
 public:
  explicit SceneMaker(std::uint64_t number) : random_(mix_bits(number + kGoldenBits)) {}

  Scene make() {
    const double kind = random_.unit();
    if (kind < 0.15) around_ = Affine::translation({148376, 1234, -223423});
    if (kind > 0.7) {
      const double size = random_.magnitude(-9, 9);
      around_ = Affine::scaling({size, size, size});
    }
    const int prototypes = static_cast<int>(random_.unit() * 4);
    for (int i = 0; i < prototypes; ++i) add_prototype();
    const int count = 1 + static_cast<int>(random_.magnitude(0, 1.1));
    while (std::ssize(scene_.objects) < count) add_object();
    return std::move(scene_);
  }

 private:
  int pick(std::size_t n) { return static_cast<int>(random_.unit() * static_cast<double>(n)); }

  Affine place(double size) {
    const double s = size * random_.magnitude(-0.7, 0.3);
    return Affine::translation(random_.vector() * size) * Affine::scaling({s, s, s}) * random_turn(random_);
  }

  /// Any shape, or one with an inside.
  Object shape(bool solid) {
    Object object;
    for (;;) {
      const auto kind = static_cast<std::size_t>(pick(known_kinds().size()));
      const std::uint64_t number = random_.bits() >> 24;
      KnownShape known = draw_known_shape(kind, number);
      if (solid && !known.is_solid() && known_kinds()[kind] != "closed_mesh") continue;
      object.shape = std::move(known.shape);
      object.name = known_name(kind, number);
      return object;
    }
  }

  Object combination(int depth) {
    auto operands = std::make_shared<std::vector<Object>>();
    const int count = 2 + pick(2);
    for (int i = 0; i < count; ++i) {
      operands->push_back(depth < 2 && random_.unit() < 0.3 ? combination(depth + 1) : shape(true));
      operands->back().transform = place(0.5);
    }
    constexpr CsgOp kOps[] = {CsgOp::unite, CsgOp::intersect, CsgOp::subtract};
    Object object;
    object.shape = CsgShape{kOps[pick(3)], std::move(operands)};
    return object;
  }

  Object instance() {
    Object object;
    object.shape = InstanceShape{static_cast<std::uint32_t>(pick(scene_.prototypes.size()))};
    return object;
  }

  Object any() {
    const double kind = random_.unit();
    if (kind < 0.2 && !scene_.prototypes.empty()) return instance();
    return kind < 0.3 ? combination(0) : shape(false);
  }

  void add_prototype() {
    Prototype prototype{fmt::format("prototype {}", scene_.prototypes.size() + 1), {}};
    const int count = 1 + pick(3);
    for (int i = 0; i < count; ++i) {
      prototype.objects.push_back(any());
      prototype.objects.back().transform = place(1);
    }
    scene_.prototypes.push_back(std::move(prototype));
  }

  void add_object() {
    if (!scene_.prototypes.empty() && random_.unit() < 0.05) {
      // So many in a row become a list of instances.
      for (int i = 0; i < 70; ++i) {
        scene_.objects.push_back(instance());
        scene_.objects.back().transform = around_ * place(2);
      }
    }
    scene_.objects.push_back(any());
    scene_.objects.back().transform = around_ * place(1.5);
  }

  CaseRandom random_;
  Affine around_;
  Scene scene_;
};

}  // namespace

Scene draw_scene(std::uint64_t number) { return SceneMaker(number).make(); }

}  // namespace oktett
