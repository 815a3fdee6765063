#include "kernels/exact/implicit_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/math.h"
#include "kernels/functions/function_tape.h"
#include "kernels/functions/variation.h"

namespace oktett {

namespace {

using Lane = Simd<double, 1, ScalarIsa>;
constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr ImplicitGridCell kUnknown{{kNoLimit, kNoLimit}, kNoLimit, 0};

/// Rounded up; bounds are computed with relative errors far below 2^-20.
float upward(double x) { return static_cast<float>(x * (1 + 0x1p-20) + 0x1p-140); }

ImplicitGridCell cell_of(const Variation<Lane>& f) {
  const auto number = [](const Lane& x) { return only_lane(x); };
  const double error = number(f.error), lo = number(f.v.lo), hi = number(f.v.hi);
  double h[6];
  for (int k = 0; k < 6; ++k) h[k] = number(f.h[k]);
  // By Gershgorin's theorem no eigenvalue is larger than the greatest sum of a row.
  const double bend = std::max({h[0] + h[3] + h[4], h[3] + h[1] + h[5], h[4] + h[5] + h[2]});
  const double slope = length(only_lane(f.g));
  ImplicitGridCell c{
      {upward(bend + number(f.falls)), upward(bend + number(f.rises))}, upward(slope), upward(error)};
  const bool known = std::isfinite(lo) && std::isfinite(hi) && number(f.doubt) == 0 && std::isfinite(bend) &&
                     std::isfinite(c.slope) && std::isfinite(c.error) &&
                     number(f.slope_error) <= slope * (kSlopeError / 2);
  if (!known) return kUnknown;
  if (lo > 256 * error || hi < -256 * error) c.bend[0] = c.bend[1] = c.slope = 0;
  return c;
}

/// What is known of cell (x, y, z) of a grid.
ImplicitGridCell known_of(const FunctionTape& function, const VariationGrid& grid, const Vec3d& hi,
                          const int (&at)[3]) {
  Variation<Lane> axis[3];
  for (int k = 0; k < 3; ++k) {
    Variation<Lane>& x = axis[k] = variation::constant(Lane(0.0));
    x.v = {Lane(grid.lo[k] + (at[k] - kGridMargin) / grid.per_unit[k]),
           Lane(grid.lo[k] + (at[k] + 1 + kGridMargin) / grid.per_unit[k])};
    x.error = Lane(std::max(max_component(abs(grid.lo)), max_component(abs(hi))) * 0x1p-47);
    (k == 0 ? x.g.x : k == 1 ? x.g.y : x.g.z) = Lane(1.0);
  }
  return cell_of(run_tape(function, axis[0], axis[1], axis[2]));
}

/// Calls f(x, y, z) for cells of a grid: for all, or for eight of them that represent them.
template <class F>
void each_cell(int side, bool all, const F& f) {
  const int count = all ? side * side * side : 8;
  for (int k = 0; k < count; ++k) {
    if (all)
      f({k % side, k / side % side, k / side / side});
    else
      f({k * side / 8, (3 * k + 1) % 8 * side / 8, (5 * k + 2) % 8 * side / 8});
  }
}

/// Some cells of a grid of `side`^3, of edges of at most `edge`.
struct Cells {
  int side;
  double edge;
  std::vector<ImplicitGridCell> list;

  double unknown() const {
    const auto count =
        std::ranges::count_if(list, [](const ImplicitGridCell& c) { return !std::isfinite(c.slope); });
    return static_cast<double>(count) / static_cast<double>(list.size());
  }
  /// The size of the function where its zeros may be, roughly; infinite if they are in no cell.
  double scale() const {
    double least = kInfinity;
    for (const ImplicitGridCell& c : list)
      if (c.slope > 0) least = std::min(least, c.slope * edge / 4);
    return least;
  }
  /// About how many steps a ray takes through the grid: one or more per cell, less where there are no zeros.
  double steps(double scale) const {
    constexpr double kQuiet = 0.3, kKinked = 9;
    double sum = 0;
    for (const ImplicitGridCell& c : list) {
      const double bend = std::min(c.bend[0], c.bend[1]);
      if (c.slope == 0)
        sum += kQuiet;
      else if (std::isfinite(bend))
        sum += 1 + edge * std::sqrt(bend / (2 * scale));
      else if (std::isfinite(c.slope))
        sum += kKinked + edge * c.slope / scale;
    }
    return side * sum / static_cast<double>(list.size());
  }
  /// Whether rays should try at all: intervals take about ten steps, each of which costs several of these. In
  /// small cells the number of steps is overestimated, as the scale is that of the flattest.
  bool pays() const { return unknown() <= 0.2 && steps(scale()) <= (side == kMostGridSide ? 50 : 20); }
};

/// Smaller cells have to save more than what passing their borders costs.
bool is_worth(const Cells& fine, const Cells& coarse) {
  if (fine.unknown() != coarse.unknown()) return fine.unknown() < coarse.unknown();
  const double scale = fine.scale();
  return !std::isfinite(scale) || fine.steps(scale) < 0.8 * coarse.steps(scale);
}

}  // namespace

VariationGrid make_variation_grid(const FunctionTape& function, const Vec3d& lo, const Vec3d& hi,
                                  int most_side) {
  const auto empty_grid = [&](int side) {
    VariationGrid grid{side, lo, {}, {}};
    for (int k = 0; k < 3; ++k) grid.per_unit[k] = side / (hi[k] - lo[k]);
    return grid;
  };
  VariationGrid grid;
  bool pays = false;
  for (const int side : {1, 4, 8}) {
    if (side > most_side || (side == kMostGridSide && function.steps.size() > 128)) break;
    VariationGrid next = empty_grid(side);
    if (!std::isfinite(max_component(next.per_unit))) break;
    const auto find = [&](bool all) {
      std::vector<ImplicitGridCell> cells;
      each_cell(side, all, [&](const int(&at)[3]) { cells.push_back(known_of(function, next, hi, at)); });
      return cells;
    };
    const double edge = max_component(hi - lo) / side;
    if (side > 1 && !is_worth({side, edge, find(false)}, {grid.side, edge * side / grid.side, grid.cells}))
      break;
    next.cells = find(true);
    grid = std::move(next);
    pays = Cells{side, edge, grid.cells}.pays();
  }
  if (!pays) grid.cells.clear();
  return grid;
}

// ---- The box of a function, divided into cells that the surface passes through.

namespace {

using Lane = Simd<double, 1, ScalarIsa>;
using Bounds = Interval<Lane>;

/// x, y, z, two values for each step, and -1, 0 and 1.
constexpr std::size_t kMostValues = 3 + 2 * kMaxTapeSteps + 3;
/// Cells are divided down to this in the own space: as a trial, which shows at little cost where cells do not
/// pay, and then in earnest. Cells without branches are left larger.
constexpr double kTrialSize = 0x1p-4, kLeastSize = 0x1p-6, kLeastPlainSize = 0x1p-3;
/// Times relative to that of a node of the tree: a cell, and each of its steps.
constexpr double kCellCost = 20, kStepCost = 6;

/// The values that matter in a box, as numbers: first that of the result, then three for each value in the
/// order of computation, its number in the whole list, the numbers of its operands, and that of a third one.
using Part = std::vector<std::uint32_t>;
using PartView = std::span<const std::uint32_t>;

constexpr std::uint32_t pack(std::uint32_t a, std::uint32_t b) { return (a & 0xffff) | b << 16; }
constexpr std::uint32_t unpack(std::uint32_t packed) {
  return (packed & 0xffff) == 0xffff ? kNoId : packed & 0xffff;
}

bool is_branch(TapeOp op) { return op == TapeOp::min || op == TapeOp::max; }
bool is_bounded(const Bounds& x) { return any(x.is_bounded()); }
bool is_below(const Bounds& a, const Bounds& b) { return is_bounded(a) && is_bounded(b) && any(a.hi < b.lo); }

/// Encloses the function in boxes, and leaves out the branches that are never taken there.
class FunctionRule : public CellRule {
 public:
  FunctionRule(const TapeValues& values, const FunctionBox& box, double least_size)
      : box_(box), least_size_(least_size), list_(kFirst) {
    for (std::uint32_t k = 0; k < 3; ++k) list_[kUnits + k].c = static_cast<double>(k) - 1;
    const auto place = [](std::uint32_t v) { return v == kNoId || v < 3 ? v : v - 3 + kFirst; };
    for (std::size_t v = 3; v < values.list.size(); ++v) {
      TapeValue value = values.list[v];
      value.a = place(value.a), value.b = place(value.b), value.third = place(value.third);
      list_.push_back(value);
    }
    root_ = place(values.root);
  }

  Part whole() const {
    Part part{root_};
    for (std::uint32_t v = kFirst; v < list_.size(); ++v)
      part.push_back(v), part.push_back(pack(list_[v].a, list_[v].b)), part.push_back(list_[v].third);
    return part;
  }

  CellRange narrow(const CellBox& box, PartView part, Part& out) const override {
    Bounds value[kMostValues];
    std::uint32_t same[kMostValues];  // the value that each is equal to here
    for (std::uint32_t v = kUnits; v < kFirst; ++v) value[v] = Bounds(Lane(list_[v].c)), same[v] = v;
    for (std::uint32_t k = 0; k < 3; ++k) {
      // Exact, as the size is a power of two.
      value[k] = Bounds(Lane(box.lo[k] * box_.size), Lane(box.hi[k] * box_.size));
      same[k] = k;
    }
    for (std::size_t k = 1; k < part.size(); k += 3) {
      const std::uint32_t third = part[k + 2];
      const std::uint32_t v = part[k], a = unpack(part[k + 1]), b = unpack(part[k + 1] >> 16);
      const TapeValue& step = list_[v];
      Bounds r[4];
      if (a != kNoId) r[0] = value[same[a]];
      if (b != kNoId) r[1] = value[same[b]];
      if (third != kNoId) r[3] = value[same[third]];
      same[v] = equal_value(step, a == kNoId ? a : same[a], b == kNoId ? b : same[b], r);
      if (same[v] != kNoId) continue;
      same[v] = v;
      tape::run_step({step.op, 2, 0, 1, third == kNoId ? step.n : 3, step.c}, r);
      value[v] = r[2];
    }
    const std::uint32_t root = same[part[0]];
    const CellRange range = range_of(value[root]);
    if (!box_.open && range.hi < 0 && is_at_face(box)) {
      out = {unit(-1)};
      return {-1, 1};
    }
    keep(part, root, same, out);
    return range;
  }

  double least_size(PartView part) const override {
    if (part[0] == unit(-1)) return kInfinity;
    for (std::size_t k = 1; k < part.size(); k += 3)
      if (is_branch(list_[part[k]].op)) return least_size_;
    return kLeastPlainSize;
  }

  double cost(PartView part) const override {
    return kCellCost + kStepCost * static_cast<double>((part.size() - 1) / 3);
  }

  /// The tape for a part of the values.
  FunctionTape tape_of(PartView part) const {
    std::vector<TapeValue> list = list_;
    for (std::size_t k = 1; k < part.size(); k += 3) {
      TapeValue& value = list[part[k]];
      value.a = unpack(part[k + 1]), value.b = unpack(part[k + 1] >> 16), value.third = part[k + 2];
    }
    return write_tape(list, part[0]);
  }

 private:
  /// The value that a step is sure to equal, or kNoId: a branch of `min` and `max`, a factor of 1, or what is
  /// left of a term that is 0. `a` and `b` are its operands, in r[0] and r[1].
  static std::uint32_t equal_value(const TapeValue& step, std::uint32_t a, std::uint32_t b,
                                   const Bounds (&r)[4]) {
    const int first = unit_of(a), second = unit_of(b);
    switch (step.op) {
      case TapeOp::min:
        return is_below(r[0], r[1]) ? a : is_below(r[1], r[0]) ? b : kNoId;
      case TapeOp::max:
        return is_below(r[0], r[1]) ? b : is_below(r[1], r[0]) ? a : kNoId;
      case TapeOp::constant:
        return unit(step.c);
      case TapeOp::add:
        if (first == 0) return b;
        return second == 0 ? a : first != kOther && second != kOther ? unit(first + second) : kNoId;
      case TapeOp::add_constant:
        return first != kOther ? unit(first + step.c) : kNoId;
      case TapeOp::subtract:
        if (second == 0) return a;
        return first != kOther && second != kOther ? unit(first - second) : kNoId;
      case TapeOp::negate:
        return first != kOther ? unit(-first) : kNoId;
      case TapeOp::multiply:
        if (first == 1 || (second == 0 && is_bounded(r[0]))) return b;
        return second == 1 || (first == 0 && is_bounded(r[1])) ? a : kNoId;
      case TapeOp::multiply_constant:
        return first == 0 ? a : kNoId;
      case TapeOp::square:
      case TapeOp::abs:
        return first != kOther ? unit(first * first) : kNoId;
      case TapeOp::sqrt:
        return first == 0 || first == 1 ? a : kNoId;
      case TapeOp::whole_power:
        return step.n > 0 && (first == 0 || first == 1) ? a : kNoId;
      default:
        return kNoId;
    }
  }

  /// In the list stand x, y and z, then -1, 0 and 1, then the values of the steps.
  static constexpr std::uint32_t kUnits = 3, kFirst = 6;
  static constexpr int kOther = 2;
  /// What value `v` is: -1, 0 or 1, else kOther.
  static int unit_of(std::uint32_t v) {
    return kUnits <= v && v < kFirst ? static_cast<int>(v - kUnits) - 1 : kOther;
  }
  /// The value that is c = -1, 0 or 1; kNoId for other numbers.
  static std::uint32_t unit(double c) {
    return c == -1 || c == 0 || c == 1 ? kUnits + static_cast<std::uint32_t>(c + 1) : kNoId;
  }

  static CellRange range_of(const Bounds& f) {
    // Where it is not defined is outside.
    if (any(f.is_void())) return {1, 1};
    return {only_lane(f.lo), only_lane(f.hi)};
  }

  /// Whether the box, which is wider than its cell, reaches a face of the function's.
  bool is_at_face(const CellBox& box) const {
    for (int k = 0; k < 3; ++k)
      if (box.lo[k] <= box_.lo[k] || box.hi[k] >= box_.hi[k]) return true;
    return false;
  }

  /// Writes the values of `part` that the result needs, with operands that are equal to theirs.
  static void keep(PartView part, std::uint32_t root, const std::uint32_t* same, Part& out) {
    bool needed[kMostValues] = {};
    needed[root] = true;
    std::size_t count = 0;
    const auto equal = [&](std::uint32_t v) { return v == kNoId ? kNoId : same[v]; };
    for (std::size_t end = part.size(); end > 1; end -= 3) {
      const std::size_t k = end - 3;
      if (!needed[part[k]]) continue;
      ++count;
      for (const std::uint32_t operand : {unpack(part[k + 1]), unpack(part[k + 1] >> 16), part[k + 2]})
        if (operand != kNoId) needed[same[operand]] = true;
    }
    out.reserve(1 + 3 * count);
    out.push_back(root);
    for (std::size_t k = 1; k < part.size(); k += 3)
      if (needed[part[k]]) {
        out.push_back(part[k]);
        out.push_back(pack(equal(unpack(part[k + 1])), equal(unpack(part[k + 1] >> 16))));
        out.push_back(equal(part[k + 2]));
      }
  }

  const FunctionBox& box_;
  double least_size_;
  std::vector<TapeValue> list_;
  std::uint32_t root_;
};

bool has_branches(const FunctionTape& function) {
  return std::ranges::any_of(function.steps, [](const TapeStep& s) { return is_branch(s.op); });
}

/// As divide_function, by a rule.
std::shared_ptr<const FunctionCells> divide(const FunctionRule& rule, const FunctionBox& box,
                                            std::uint32_t element, std::vector<ExactCell>& cells) {
  auto divided = std::make_shared<FunctionCells>();
  CellTree& tree = divided->tree;
  const std::size_t before = cells.size();
  divided->root = tree.divide(rule, {box.lo, box.hi}, rule.whole(), element, cells);
  if (tree.nodes[divided->root].kind == CellNode::Kind::leaf) {
    cells.resize(before);
    return nullptr;
  }

  std::map<Part, std::uint32_t> known;
  const auto number_of = [&](std::uint32_t begin, std::uint32_t count) {
    const auto list = tree.lists.begin() + begin;
    const auto [at, is_new] =
        known.try_emplace(Part(list, list + count), static_cast<std::uint32_t>(divided->tapes.size()));
    if (is_new) divided->tapes.push_back(rule.tape_of(at->first));
    return at->second;
  };
  for (CellNode& node : tree.nodes)
    if (node.kind == CellNode::Kind::leaf) node.first = number_of(node.first, node.second), node.second = 0;
  for (std::size_t k = before; k < cells.size(); ++k) {
    ExactCell& cell = cells[k];
    // Cells overlap, but do not reach beyond the box.
    cell.lo = max(cell.lo, box.lo), cell.hi = min(cell.hi, box.hi);
    cell.begin = number_of(cell.begin, cell.count);
    divided->grids.push_back(
        make_variation_grid(divided->tapes[cell.begin], cell.lo * box.size, cell.hi * box.size, 1));
    cell.count = static_cast<std::uint32_t>(divided->grids.size());
  }
  tree.lists.clear(), tree.lists.shrink_to_fit();
  return divided;
}

}  // namespace

std::size_t FunctionCells::bytes() const {
  std::size_t sum = sizeof(FunctionCells) + tree.bytes() + tapes.size() * sizeof(FunctionTape);
  for (const FunctionTape& t : tapes) sum += t.steps.size() * sizeof(TapeStep);
  for (const VariationGrid& g : grids)
    sum += sizeof(VariationGrid) + g.cells.size() * sizeof(ImplicitGridCell);
  return sum;
}

std::shared_ptr<const FunctionCells> divide_function(const FunctionTape& function, const FunctionBox& box,
                                                     std::uint32_t element, std::vector<ExactCell>& cells) {
  if (!has_branches(function)) return nullptr;
  const TapeValues values = values_of(function);
  std::vector<ExactCell> trial;
  return divide(FunctionRule(values, box, kTrialSize), box, element, trial) == nullptr
             ? nullptr
             : divide(FunctionRule(values, box, kLeastSize), box, element, cells);
}

}  // namespace oktett
