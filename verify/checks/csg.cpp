#include "verify/checks/csg.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <memory>

#include "accel/accel.h"
#include "accel/point_query.h"
#include "core/random.h"
#include "kernels/exact_ops.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/compare_mode.h"
#include "verify/checks/kernels.h"
#include "verify/checks/run_cases.h"
#include "verify/oracles/exact.h"
#include "verify/oracles/mesh.h"

namespace oktett {

namespace {

using Inside = std::function<bool(const Vec3l&)>;

constexpr int kSamples = 256;
constexpr int kMaxOperands = 64, kMaxDepth = 12;
constexpr TraceMode kCsgModes[] = {TraceMode::automatic, TraceMode::interleaved, TraceMode::packet8,
                                   TraceMode::packet16, TraceMode::beam};

/// A convex mesh is the intersection of the half-spaces of its triangles.
Inside inside_convex(const TriangleMesh& mesh, const Affine& to_world) {
  struct Face {
    Vec3l normal, point;
  };
  auto faces = std::make_shared<std::vector<Face>>();
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    // Corners are rounded to float in their final place, as the tracer does it.
    Vec3l v[3];
    for (std::size_t k = 0; k < 3; ++k)
      v[k] = Vec3l(Vec3f(to_world.point(Vec3d(mesh.positions[mesh.indices[i + k]]))));
    const Vec3l n = cross(v[1] - v[0], v[2] - v[0]);
    faces->push_back({to_world.determinant() < 0 ? -n : n, v[0]});
  }
  return [faces](const Vec3l& p) {
    for (const Face& f : *faces)
      if (dot(f.normal, p - f.point) >= 0) return false;
    return true;
  };
}

/// A random expression and what it should be.
class TreeMaker {
 public:
  explicit TreeMaker(CaseRandom& random)
      : random_(random), coarse_(random.unit() < 0.5), solids_(draw_solids(random.unit())) {
    static const OracleMesh ball = make_icosphere(2), cube = make_cube();
    ball_ = &ball.mesh, cube_ = &cube.mesh;
  }

  Inside make(CsgExpression& e, int operands, int depth) {
    if (operands == 1 || depth == kMaxDepth) return solid(e);
    const double kind = random_.unit();
    e.op = kind < 0.4 ? CsgOp::unite : kind < 0.7 ? CsgOp::intersect : CsgOp::subtract;
    const int parts = std::min(operands, 2 + static_cast<int>(random_.unit() * 3));
    std::vector<Inside> inside;
    for (int i = 0; i < parts; ++i) {
      const int share =
          i + 1 == parts ? operands : 1 + static_cast<int>(random_.unit() * (operands - (parts - 1 - i)));
      operands -= share;
      inside.push_back(make(e.children.emplace_back(), share, depth + 1));
    }
    const CsgOp op = e.op;
    return [op, inside](const Vec3l& p) {
      if (op == CsgOp::subtract && !inside[0](p)) return false;
      for (std::size_t i = op == CsgOp::subtract ? 1 : 0; i < inside.size(); ++i)
        if (inside[i](p) != (op == CsgOp::intersect)) return op == CsgOp::unite;
      return op != CsgOp::unite;
    };
  }

 private:
  /// What the solids of a tree are. Several rays at once go through trees of primitives, and are solved at
  /// once and swept one by one in trees of shapes; with meshes each ray goes alone.
  enum class Solids { primitives, shapes, all };
  static Solids draw_solids(double dice) {
    return dice < 0.4 ? Solids::primitives : dice < 0.7 ? Solids::shapes : Solids::all;
  }

  /// On a coarse grid many faces coincide.
  double coordinate() { return coarse_ ? std::floor(random_.unit() * 9 - 4) / 4 : random_.sign(); }
  Vec3d place() { return {coordinate(), coordinate(), coordinate()}; }
  double size() { return coarse_ ? 0.25 + 0.25 * std::floor(random_.unit() * 4) : 0.2 + random_.unit(); }

  Affine turned_to(const Vec3d& c) {
    return Affine::translation(c) * Affine::rotation(random_.vector() * 180.0);
  }

  template <class S>
  static void add(CsgExpression& e, S shape, const Affine& to_world) {
    Geometry& g = e.solids.emplace_back();
    g.shape = std::move(shape), g.transform = to_world;
  }

  Inside solid(CsgExpression& e) {
    const Vec3d c = place();
    const double r = size(), kind = random_.unit() * (solids_ == Solids::all ? 1.0 : 0.7);
    if (solids_ == Solids::shapes && random_.unit() < 0.4) return exact(e, c);
    if (kind < 0.25) {
      add(e, SpheresShape{{{c, r}}}, {});
      return [c, r](const Vec3l& p) {
        const Vec3l d = p - Vec3l(c);
        return dot(d, d) < static_cast<long double>(r) * r;
      };
    }
    if (kind < 0.5) {
      const Vec3d half{r, size(), size()};
      add(e, BoxShape{c - half, c + half}, {});
      return [c, half](const Vec3l& p) {
        const Vec3l d = p - Vec3l(c);
        return std::abs(d.x) < half.x && std::abs(d.y) < half.y && std::abs(d.z) < half.z;
      };
    }
    if (kind < 0.55) return placed(e, oracle_of(TorusShape{r, 0.5 * r}), turned_to(c));
    if (kind < 0.6) return exact(e, c);
    if (kind < 0.7) {
      const Vec3d n = coarse_ ? Vec3d{0, random_.sign() < 0 ? -1.0 : 1.0, 0} : random_.vector();
      const double offset = coordinate();
      add(e, PlaneShape{n, offset}, {});
      const Vec3d unit = normalize(n);
      return [unit, offset](const Vec3l& p) { return dot(Vec3l(unit), p) < offset; };
    }
    const TriangleMesh& mesh = coarse_ || kind < 0.85 ? *cube_ : *ball_;
    Affine m = Affine::translation(c) * Affine::scaling({random_.unit() < 0.3 ? -r : r, r, r});
    if (!coarse_) m = m * Affine::rotation(random_.vector() * 180.0);
    add(e, MeshGeometry{&mesh, false}, m);
    if (random_.unit() < 0.3) {
      // The same through an instance.
      Geometry inner;
      inner.shape = MeshGeometry{&mesh, false};
      e.solids.back().shape = InstanceGeometry{build_accel({inner}, {BuildQuality::balanced, false})};
      // Inside, the corners are not rounded in the world.
      return [inverse = m.inverse(), inside = inside_convex(mesh, {})](const Vec3l& p) {
        return inside(mapped(inverse, p));
      };
    }
    return inside_convex(mesh, m);
  }

  /// Any of the surfaces that have an inside, some of them without bounds.
  Inside exact(CsgExpression& e, const Vec3d& c) {
    static const std::size_t forms = exact_oracle_names().size();
    ExactOracle oracle;
    do
      oracle =
          draw_exact_oracle(static_cast<std::size_t>(random_.unit() * static_cast<double>(forms)), random_);
    while (oracle.where ||
           (solids_ == Solids::primitives && !exact_ops(kind_of(oracle.shape.form)).lists_at_once()));
    return placed(e, oracle, turned_to(c));
  }

  static Inside placed(CsgExpression& e, const ExactOracle& oracle, const Affine& to_world) {
    add(e, oracle.shape, to_world);
    return [inverse = to_world.inverse(), f = oracle.f](const Vec3l& p) { return f(mapped(inverse, p)) < 0; };
  }

  CaseRandom& random_;
  const bool coarse_;
  const Solids solids_;
  const TriangleMesh *ball_, *cube_;
};

/// A solid that rays have to run through to meet a combination.
class Window {
 public:
  explicit Window(CaseRandom& random)
      : is_ball_(random.unit() < 0.5), center_(random.vector() * 0.8), size_(0.3 + random.unit()) {}

  Geometry geometry() const {
    Geometry g;
    const Vec3d edge{size_, size_, size_};
    if (is_ball_)
      g.shape = SpheresShape{{{center_, size_}}};
    else
      g.shape = BoxShape{center_ - edge, center_ + edge};
    return g;
  }

  /// Whether a ray meets what is `more` larger.
  bool is_met_by(const Ray& ray, long double more) const {
    const Vec3l o = Vec3l(ray.origin) - Vec3l(center_), d(ray.direction);
    const long double size = size_ + more;
    if (is_ball_) {
      const Vec3l nearest = o + d * std::max(0.0L, -dot(o, d) / dot(d, d));
      return dot(nearest, nearest) <= size * size;
    }
    long double begin = 0, end = std::numeric_limits<long double>::infinity();
    for (int k = 0; k < 3; ++k) {
      if (d[k] == 0) {
        if (std::abs(o[k]) > size) return false;
        continue;
      }
      const long double a = (-size - o[k]) / d[k], b = (size - o[k]) / d[k];
      begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
    }
    return begin <= end;
  }

 private:
  bool is_ball_;
  Vec3d center_;
  double size_;
};

class CsgChecker {
 public:
  CsgChecker(std::uint64_t tree, const std::vector<Isa>& isas, CsgTally& tally)
      : random_(mix_bits(tree + 77)), isas_(isas), tally_(tally) {
    auto expression = std::make_shared<CsgExpression>();
    const int operands = 1 + static_cast<int>(std::pow(kMaxOperands, random_.unit()));
    inside_ = TreeMaker(random_).make(*expression, std::min(operands, kMaxOperands), 0);
    // A fifth of the trees are seen through windows.
    CaseRandom random(mix_bits(tree + 78));
    for (int i = 0; i < 2 && random.unit() < 0.2 * (1 + 2 * i); ++i) {
      windows_.emplace_back(random);
      expression->windows.push_back(windows_.back().geometry());
    }
    Geometry whole;
    whole.shape = CsgGeometry{expression};
    accel_ = build_accel({whole}, {BuildQuality::balanced, false});
  }

  void run() {
    RayBatch rays;
    const bool camera = random_.unit() < 0.5;
    const Vec3d eye = normalize(random_.vector()) * 4.0;
    while (rays.size() < kRaysPerTree) {
      const Vec3d at = random_.vector() * 1.5;
      Vec3d from = camera                 ? eye
                   : random_.unit() < 0.2 ? random_.vector() * 1.2
                                          : normalize(random_.vector()) * 4.0;
      Vec3d d = at - from;
      if (!camera && random_.unit() < 0.15) {
        const int axis = static_cast<int>(random_.unit() * 3);
        const double side = random_.sign() < 0 ? -4 : 4;
        from = at, from[axis] = side, d = {0, 0, 0}, d[axis] = -side;
      }
      rays.push_back({Vec3f(from), 0, Vec3f(d)});
    }
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    closest_hit(*accel_, rays.span(), hits.span(), isas_.front(), TraceMode::single);
    compare_modes(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) check(rays[i], hits[i]);
    check_inside();
  }

 private:
  void fail(std::uint64_t& count, const Ray& ray, const std::string& what) {
    ++count;
    if (tally_.failure.empty()) tally_.failure = what + "; ray " + exact_text(ray);
  }

  void compare_modes(const RayBatch& rays, const HitBatch& reference) {
    for (const Isa isa : isas_)
      for (const TraceMode mode : kCsgModes)
        compare_mode(*accel_, rays, reference, isa, mode, [&](std::size_t i, bool, bool) {
          fail(tally_.differing, rays[i], fmt::format("{} differs", to_string(isa)));
        });
  }

  void check(const Ray& ray, const Hit& first) {
    ++tally_.rays;
    all_hits(*accel_, ray, list_, isas_.front());
    tally_.crossings += list_.size();
    if (first.valid() ? list_.empty() || !(list_.front() == first) : !list_.empty())
      fail(tally_.wrong_first, ray, "closest_hit is not the first of all_hits");
    constexpr long double kGraze = 1e-5L;
    const auto is_met = [&](long double more) {
      return std::ranges::all_of(windows_, [&](const Window& w) { return w.is_met_by(ray, more); });
    };
    if (!is_met(-kGraze)) {
      if (!list_.empty() && !is_met(kGraze)) fail(tally_.wrong_first, ray, "it misses a window, but hits");
      return;
    }
    const Vec3l o(ray.origin), d(ray.direction);
    // Coordinates are below 8; crossings are in float and coincide within 2^-21.
    const auto at = [&](long double t) { return inside_(o + d * t); };
    const long double speed = std::sqrt(dot(d, d)), slack = 8 / speed * 0x1p-19L;
    // Whether the ray begins inside is only known to the oracle.
    bool inside = at(0);
    const long double end = 8 / speed;
    std::size_t next = 0;
    for (int i = 0; i < kSamples; ++i) {
      const long double t = end * (i + random_.unit()) / kSamples;
      for (; next < list_.size() && list_[next].t < t; ++next) inside = !inside;
      ++tally_.samples;
      if (at(t) == inside) continue;
      if (at(t - slack) != at(t) || at(t + slack) != at(t)) continue;
      // The beginning itself may lie on a boundary.
      if (at(slack) != at(0)) continue;
      fail(tally_.wrong_spans, ray,
           fmt::format("at {} the oracle is {}, {} crossings", static_cast<double>(t),
                       at(t) ? "inside" : "outside", list_.size()));
      break;
    }
    if (first.valid()) check_normal(ray, first);
  }

  /// As many points as there are rays.
  void check_inside() {
    std::vector<Vec3f> points;
    while (points.size() < kRaysPerTree) points.push_back(Vec3f(random_.vector() * 1.8));
    std::vector<std::uint8_t> answers(points.size()), others(points.size());
    inside(*accel_, points, answers, isas_.front());
    for (const Isa isa : isas_) {
      inside(*accel_, points, others, isa);
      if (others != answers)
        fail(tally_.differing, {points[0], 0, {}}, fmt::format("inside differs on {}", to_string(isa)));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3l p(points[i]);
      const bool expected = inside_(p);
      if ((answers[i] != 0) == expected) continue;
      bool near = false;
      for (int k = 0; k < 3; ++k)
        for (const long double step : {-0x1p-16L, 0x1p-16L}) {
          Vec3l q = p;
          q[k] += step;
          near |= inside_(q) != expected;
        }
      if (!near)
        fail(tally_.wrong_inside, {points[i], 0, {}},
             expected ? "the point is inside" : "the point is outside");
    }
  }

  void check_normal(const Ray& ray, const Hit& hit) {
    const SurfaceInteraction s = surface_interaction(*accel_, ray, hit);
    const Vec3f n = s.geometric_normal;
    // A wrong normal has the solid above the surface and not below it, on both scales. Near an edge or a
    // sliver this happens with a right normal, but on one scale only.
    const Vec3l p(s.position), m(n);
    const auto points_inside = [&](long double step) {
      return inside_(p + m * step) && !inside_(p - m * step);
    };
    if (points_inside(1e-4L) && points_inside(1e-5L))
      fail(tally_.wrong_normal, ray, fmt::format("the normal at {} points inside", hit.t));
  }

  CaseRandom random_;
  const std::vector<Isa>& isas_;
  CsgTally& tally_;
  Inside inside_;
  std::vector<Window> windows_;
  std::shared_ptr<const Accel> accel_;
  std::vector<Hit> list_;
};

void add(CsgTally& sum, const CsgTally& t) {
  sum.rays += t.rays, sum.crossings += t.crossings, sum.samples += t.samples;
  sum.wrong_spans += t.wrong_spans, sum.wrong_first += t.wrong_first, sum.wrong_normal += t.wrong_normal;
  sum.wrong_inside += t.wrong_inside;
  sum.differing += t.differing;
  if (sum.failure.empty()) sum.failure = t.failure, sum.tree = t.tree;
}

}  // namespace

CsgTally verify_csg(std::uint64_t rays, const std::vector<Isa>& isas, std::uint64_t first) {
  const std::size_t trees = (rays + kRaysPerTree - 1) / kRaysPerTree;
  return run_cases(
      trees, first, &CsgTally::tree, "tree",
      [&](CsgTally& tally) { CsgChecker(tally.tree, isas, tally).run(); }, add);
}

}  // namespace oktett
