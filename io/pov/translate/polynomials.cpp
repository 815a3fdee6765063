#include "io/pov/translate/polynomials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/roots/root_method.h"

namespace oktett::pov {
namespace {

/// Half the edge of the box in which a polynomial surface is seen that nothing else bounds.
constexpr double kReach = 1000;
constexpr Extent kAll{{-kReach, -kReach, -kReach}, {kReach, kReach, kReach}};

struct Term {
  double factor;
  int power[3];
};

struct ValueRange {
  double lo, hi;
};

/// The powers of an interval from the first up to `degree`, by products.
struct PowerRanges {
  ValueRange of[roots::kMaxDegree + 1];
  PowerRanges(double lo, double hi, int degree) {
    double a = 1, b = 1;
    for (int n = 1; n <= degree; ++n) {
      a *= lo, b *= hi;
      of[n] =
          n % 2 == 1 ? ValueRange{a, b} : ValueRange{lo < 0 && 0 < hi ? 0 : std::min(a, b), std::max(a, b)};
    }
  }
};

/// Encloses a polynomial of at most `degree` in a box (R. E. Moore: Interval Analysis, 1966).
ValueRange range_in(const std::vector<Term>& terms, int degree, const Extent& box) {
  const PowerRanges powers[3] = {
      {box.lo.x, box.hi.x, degree}, {box.lo.y, box.hi.y, degree}, {box.lo.z, box.hi.z, degree}};
  ValueRange sum{0, 0};
  double size = 0;
  for (const Term& t : terms) {
    ValueRange r{t.factor, t.factor};
    for (int k = 0; k < 3; ++k) {
      if (t.power[k] == 0) continue;
      const ValueRange& p = powers[k].of[t.power[k]];
      const double ends[4] = {r.lo * p.lo, r.lo * p.hi, r.hi * p.lo, r.hi * p.hi};
      r = {*std::min_element(ends, ends + 4), *std::max_element(ends, ends + 4)};
    }
    sum.lo += r.lo, sum.hi += r.hi;
    size += std::max(std::abs(r.lo), std::abs(r.hi));
  }
  const double error = 1e-12 * size;
  return {sum.lo - error, sum.hi + error};
}

/// Looks for a box that holds all zeros of a polynomial, and all that is negative if `solid`.
class ZeroBox {
 public:
  ZeroBox(const std::vector<Term>& terms, int degree, bool solid, int levels)
      : terms_(terms), degree_(degree), solid_(solid) {
    grow(kAll, levels);
  }
  /// Whether the search came to its end and found something.
  bool found() const { return work_ >= 0 && found_.lo.x <= found_.hi.x; }
  const Extent& box() const { return found_; }

 private:
  void grow(const Extent& box, int levels) {
    if (--work_ < 0) return;
    bool known = true;
    for (int k = 0; k < 3; ++k) known &= found_.lo[k] <= box.lo[k] && box.hi[k] <= found_.hi[k];
    if (known) return;
    const ValueRange f = range_in(terms_, degree_, box);
    if (f.lo > 0 || (f.hi < 0 && !solid_)) return;
    if (levels == 0) {
      found_ = {min(found_.lo, box.lo), max(found_.hi, box.hi)};
      return;
    }
    const Vec3d middle = (box.lo + box.hi) * 0.5;
    for (int part = 0; part < 8; ++part) {
      Extent half = box;
      for (int k = 0; k < 3; ++k) ((part >> k & 1) != 0 ? half.lo : half.hi)[k] = middle[k];
      grow(half, levels - 1);
    }
  }

  const std::vector<Term>& terms_;
  const int degree_;
  const bool solid_;
  int work_ = 20000;
  Extent found_{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
};

/// All that is looked at if none is found.
Extent bounds_of(const std::vector<Term>& terms, int degree, bool solid) {
  for (const int levels : {15, 9, 5})
    if (const ZeroBox zeros(terms, degree, solid, levels); zeros.found()) return zeros.box();
  return kAll;
}

/// Whether the surface may go on where the search for its bounds ended.
bool reaches_end(const Extent& zeros) {
  bool reaches = false;
  for (int k = 0; k < 3; ++k) reaches |= zeros.lo[k] <= -kReach || zeros.hi[k] >= kReach;
  return reaches;
}

std::string equation(const std::vector<Term>& terms) {
  std::string text;
  for (const Term& t : terms) {
    const char* const sign = text.empty() ? (t.factor < 0 ? "-" : "") : t.factor < 0 ? " - " : " + ";
    text += fmt::format("{}{}", sign, std::abs(t.factor));
    for (int k = 0; k < 3; ++k)
      if (t.power[k] > 0)
        text += t.power[k] == 1 ? fmt::format("*{}", "xyz"[k]) : fmt::format("*{}^{}", "xyz"[k], t.power[k]);
  }
  return text;
}

}  // namespace

std::optional<Shapes> make_polynomial(Context& context, Arguments& a, int degree, const ShapeLimits& limits,
                                      bool operand) {
  const Place& where = a.block().where;
  const auto left_out = [&](const char* why) {
    context.warn(where, fmt::format("{}; the object is left out", why));
    return std::nullopt;
  };
  if (degree == 0) degree = static_cast<int>(a.number("the order"));
  const std::vector<double> c = a.all_numbers();
  const auto n = static_cast<std::size_t>(degree);
  if (degree < 2 || degree > 35 || c.size() != (n + 1) * (n + 2) * (n + 3) / 6)
    context.fail(where, fmt::format("a polynomial of order {} has {} coefficients, found {}", degree,
                                    (n + 1) * (n + 2) * (n + 3) / 6, c.size()));
  if (degree > roots::kMaxDegree) return left_out("polynomials here have at most degree 32");
  std::vector<Term> terms;
  std::size_t i = 0;
  for (int x = degree; x >= 0; --x)
    for (int y = degree - x; y >= 0; --y)
      for (int z = degree - x - y; z >= 0; --z)
        if (const double value = c[i++]; value != 0) terms.push_back({value, {x, y, z}});
  const auto varies = [](const Term& t) { return t.power[0] + t.power[1] + t.power[2] > 0; };
  if (std::ranges::none_of(terms, varies)) return left_out("the polynomial is constant");
  Tree& tree = context.tree;
  const Node keys = tree.map(where);
  tree.put(keys, "equation", tree.text(where, equation(terms)));
  const auto box_node = [&](const Extent& e) {
    const Node box = tree.map(where, "min", tree.vector(where, e.lo));
    tree.put(box, "max", tree.vector(where, e.hi));
    return box;
  };
  const Extent within = limits.within.meet(limits.bounded);
  Extent box = within;
  Shapes shapes;
  const bool has_windows = within.is_finite() && !limits.within.is_finite() && limits.are_windows && !operand;
  if (has_windows || !within.is_finite()) {
    const Extent zeros = bounds_of(terms, degree, operand);
    shapes.beyond_bounds = has_windows && reaches_end(zeros);
    if (shapes.beyond_bounds || !within.is_finite()) box = zeros;
  }
  // The faces of the bounds lie outside of what bounds it.
  const Vec3d room = (box.hi - box.lo) * 0.01 + Vec3d{1e-6, 1e-6, 1e-6};
  const Extent cut = box.meet(kAll);
  box = {box.lo - room, box.hi + room};
  if (!within.is_finite()) box = box.meet(kAll);
  tree.put(keys, "bounds", box_node(box));
  shapes.solid = operand || shapes.beyond_bounds;
  if (!shapes.solid) tree.put(keys, "open", tree.flag(where, true));
  shapes.parts.push_back({"polynomial", keys, nullptr, {}});
  if (shapes.beyond_bounds) {
    shapes.parts.push_back({"box", box_node(cut), nullptr, {}, true});
    shapes.meet = true;
  }
  return shapes;
}

}  // namespace oktett::pov
