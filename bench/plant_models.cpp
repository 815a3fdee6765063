#include "bench/plant_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"

namespace oktett::bench {

namespace {

/// How one kind grows. Lengths of branches are fractions of the one that they grow from, angles in radians.
struct Habit {
  int stems;                 ///< from the ground
  double height, thickness;  ///< of a stem
  double lean;               ///< of stems from the vertical, at most
  int levels;                ///< of branches above the stems
  int branches;              ///< of each stem or branch
  double first;              ///< where along it they begin, as a fraction
  double length, angle;
  double bend;  ///< towards the ground, per segment
  double leaf_length, leaf_width;
  double leaves_from;    ///< how far along a branch leaves begin
  double blossom_share;  ///< of the triangles that are not wood
};

Habit habit_of(PlantKind kind) {
  switch (kind) {
    case PlantKind::grass:
      return {24, 0.35, 0.002, 0.5, 0, 0, 0, 0, 0, 0.10, 0.3, 0.012, 0.0, 0};
    case PlantKind::flower:
      return {7, 0.5, 0.006, 0.35, 0, 0, 0, 0, 0, 0.03, 0.09, 0.04, 0.1, 0.45};
    case PlantKind::fern:
      return {12, 0.8, 0.006, 0.9, 0, 0, 0, 0, 0, 0.16, 0.13, 0.03, 0.1, 0};
    case PlantKind::bush:
      return {9, 1.1, 0.02, 0.6, 1, 7, 0.25, 0.45, 0.8, 0.03, 0.09, 0.05, 0.3, 0.04};
    case PlantKind::conifer:
      return {1, 6.5, 0.14, 0.03, 2, 26, 0.12, 0.36, 1.35, 0.02, 0.16, 0.016, 0.1, 0};
    case PlantKind::tree:
      return {1, 4.2, 0.2, 0.08, 2, 11, 0.35, 0.6, 0.85, -0.03, 0.17, 0.1, 0.3, 0};
  }
  return {};
}

/// A stem or branch as a line of points.
struct Branch {
  std::vector<Vec3d> points;
  double radius = 0;  ///< at its foot; it ends in a point
  bool last = false;  ///< bears leaves, not branches

  double length() const {
    double l = 0;
    for (std::size_t i = 1; i < points.size(); ++i) l += oktett::length(points[i] - points[i - 1]);
    return l;
  }
  Vec3d at(double u) const {
    const double x = u * static_cast<double>(points.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(x), points.size() - 2);
    return points[i] + (points[i + 1] - points[i]) * (x - static_cast<double>(i));
  }
  Vec3d direction(double u) const {
    const auto i =
        std::min(static_cast<std::size_t>(u * static_cast<double>(points.size() - 1)), points.size() - 2);
    return normalize(points[i + 1] - points[i]);
  }
};

/// The unit vector at `angle` around `along`.
Vec3d around_axis(const Vec3d& along, double angle) {
  Vec3d side, other;
  make_basis(along, side, other);
  return side * std::cos(angle) + other * std::sin(angle);
}

class Grower {
 public:
  Grower(PlantKind kind, std::size_t triangles, std::uint32_t seed)
      : kind_(kind), habit_(habit_of(kind)), triangles_(triangles), key_(mix_bits(seed)) {}

  PlantModel grow() {
    grow_branches();
    make_wood();
    make_leaves();
    return std::move(model_);
  }

 private:
  double random() { return random_float(key_, 0, count_++); }
  double signed_random() { return 2 * random() - 1; }

  void grow_branches() {
    const double size = 0.8 + 0.4 * random();
    for (int i = 0; i < habit_.stems; ++i) {
      const double around = 2 * std::numbers::pi * (i + 0.6 * random()) / habit_.stems;
      const double lean = habit_.lean * (habit_.stems == 1 ? random() : 0.25 + 0.75 * random());
      const Vec3d out{std::cos(around), 0, std::sin(around)};
      const Vec3d foot = out * (habit_.stems == 1 ? 0.0 : habit_.height * 0.05 * random());
      grow_branch(foot, normalize(Vec3d{0, std::cos(lean), 0} + out * std::sin(lean)),
                  habit_.height * size * (0.75 + 0.35 * random()), habit_.thickness * size, 0);
    }
  }

  void grow_branch(const Vec3d& from, Vec3d direction, double length, double radius, int level) {
    constexpr int kSegments = 6;
    Branch branch;
    branch.radius = radius;
    branch.last = level == habit_.levels;
    branch.points.push_back(from);
    for (int i = 0; i < kSegments; ++i) {
      direction.y -= habit_.bend * (level > 0 || habit_.stems > 1 ? 1 : 0);
      direction = normalize(direction + Vec3d{signed_random(), signed_random(), signed_random()} * 0.05);
      branch.points.push_back(branch.points.back() + direction * (length / kSegments));
    }
    branches_.push_back(branch);
    if (branch.last) return;
    const int children = level == 0 ? habit_.branches : std::max(3, habit_.branches / 3);
    double around = 2 * std::numbers::pi * random();
    for (int i = 0; i < children; ++i) {
      const double u = habit_.first + (1 - habit_.first) * (i + random()) / children;
      const Vec3d along = branch.direction(u);
      // The golden angle keeps branches from standing above each other.
      around += 2.39996;
      const Vec3d out = around_axis(along, around);
      const double angle = habit_.angle * (0.8 + 0.4 * random());
      // A conifer's branches grow shorter towards its top.
      const double taper = kind_ == PlantKind::conifer ? 1.05 - u : 1.1 - 0.5 * u;
      grow_branch(branch.at(u), along * std::cos(angle) + out * std::sin(angle),
                  length * habit_.length * taper * (0.85 + 0.3 * random()), radius * (1 - 0.8 * u) * 0.5,
                  level + 1);
    }
  }

  std::uint32_t vertex(const Vec3d& p) {
    model_.vertices.push_back(Vec3f(p));
    return static_cast<std::uint32_t>(model_.vertices.size() - 1);
  }
  void face(PlantPart part, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    model_.faces[static_cast<int>(part)].push_back({a, b, c});
  }

  /// Tubes, as round as two fifths of the triangles allow. If these are too few, only the thickest.
  void make_wood() {
    std::stable_sort(branches_.begin(), branches_.end(),
                     [](const Branch& a, const Branch& b) { return a.radius > b.radius; });
    const std::size_t most = triangles_ * 2 / 5;
    int sides = 8;
    while (sides > 3 && wood_triangles(sides) > most) --sides;
    std::size_t used = 0;
    for (const Branch& branch : branches_) {
      used += tube_triangles(branch, sides);
      if (used > most) return;
      tube(branch, sides);
    }
  }
  std::size_t wood_triangles(int sides) const {
    std::size_t count = 0;
    for (const Branch& branch : branches_) count += tube_triangles(branch, sides);
    return count;
  }
  static std::size_t tube_triangles(const Branch& branch, int sides) {
    return 2 * static_cast<std::size_t>(sides) * (branch.points.size() - 1);
  }
  void tube(const Branch& branch, int sides) {
    const std::size_t rings = branch.points.size();
    const auto first = static_cast<std::uint32_t>(model_.vertices.size());
    for (std::size_t i = 0; i < rings; ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(rings - 1);
      for (int k = 0; k < sides; ++k)
        vertex(branch.points[i] + around_axis(branch.direction(u), 2 * std::numbers::pi * k / sides) *
                                      (branch.radius * (1 - 0.9 * u)));
    }
    const auto n = static_cast<std::uint32_t>(sides);
    for (std::uint32_t i = 0; i + 1 < rings; ++i)
      for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t a = first + i * n + k, b = first + i * n + (k + 1) % n;
        face(PlantPart::wood, a, b, a + n), face(PlantPart::wood, b, b + n, a + n);
      }
  }

  void make_leaves() {
    std::vector<const Branch*> bearing;
    double total = 0;
    for (const Branch& branch : branches_)
      if (branch.last) bearing.push_back(&branch), total += branch.length();
    const std::size_t left = (triangles_ - model_.triangles()) / 2;
    const auto blossoms = static_cast<std::size_t>(habit_.blossom_share * static_cast<double>(left));
    // Along all bearing branches at even distances, whatever their lengths.
    std::size_t branch = 0;
    double begin = 0;
    for (std::size_t i = 0; i < left - blossoms; ++i) {
      const double place = total * (static_cast<double>(i) + random()) / static_cast<double>(left - blossoms);
      while (branch + 1 < bearing.size() && place > begin + bearing[branch]->length())
        begin += bearing[branch++]->length();
      leaf(*bearing[branch], std::min(1.0, (place - begin) / bearing[branch]->length()));
    }
    for (std::size_t i = 0; i < blossoms; ++i) petal(*bearing[i % bearing.size()], i / bearing.size());
  }

  /// Two triangles with a fold along the middle.
  void diamond(PlantPart part, const Vec3d& foot, const Vec3d& along, const Vec3d& across, double length,
               double width) {
    const Vec3d up = cross(across, along);
    const Vec3d middle = foot + along * (0.45 * length) + up * (0.25 * width);
    const std::uint32_t a = vertex(foot), b = vertex(middle + across * (0.5 * width)),
                        c = vertex(foot + along * length), d = vertex(middle - across * (0.5 * width));
    face(part, a, b, c), face(part, a, c, d);
  }

  void leaf(const Branch& branch, double place) {
    const double u = habit_.leaves_from + (1 - habit_.leaves_from) * place;
    const Vec3d along = branch.direction(u);
    Vec3d side, other;
    make_basis(along, side, other);
    double a = 2 * std::numbers::pi * random(), open = 0.7 + 0.5 * random();
    if (kind_ == PlantKind::fern) {
      // Leaflets stand to both sides of a frond, in its plane.
      side = normalize(cross(along, Vec3d{0, 1, 0.01}));
      a = (count_ & 1) != 0 ? 0 : std::numbers::pi, open = 1.2;
      other = cross(along, side);
    }
    if (kind_ == PlantKind::grass) open = 0.15;
    const Vec3d out = side * std::cos(a) + other * std::sin(a);
    const Vec3d blade =
        normalize(along * std::cos(open) + out * std::sin(open) + Vec3d{0, 0.2 * signed_random(), 0});
    const Vec3d across = normalize(cross(blade, Vec3d{0.1 * signed_random(), 1, 0.1 * signed_random()}));
    const double size = (0.7 + 0.6 * random()) * (kind_ == PlantKind::fern ? 1.2 - u : 1);
    diamond(PlantPart::leaf, branch.at(u), blade, across, habit_.leaf_length * size,
            habit_.leaf_width * size);
  }

  /// Petals stand around the tip of a branch, ring after ring.
  void petal(const Branch& branch, std::size_t index) {
    const Vec3d along = branch.direction(1);
    const auto rank = static_cast<double>(index);
    const double open = 1.3 / (1 + 0.03 * rank);
    const Vec3d out = around_axis(along, 2.39996 * rank);
    const Vec3d blade = along * std::cos(open) + out * std::sin(open);
    diamond(PlantPart::blossom, branch.points.back(), blade, normalize(cross(blade, along)), 0.07, 0.03);
  }

  const PlantKind kind_;
  const Habit habit_;
  const std::size_t triangles_;
  const std::uint64_t key_;
  std::uint32_t count_ = 0;
  std::vector<Branch> branches_;
  PlantModel model_;
};

}  // namespace

PlantModel make_plant(PlantKind kind, std::size_t triangles, std::uint32_t seed) {
  return Grower(kind, triangles, seed).grow();
}

}  // namespace oktett::bench
