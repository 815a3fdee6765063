#include "kernels/functions/function_tape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "kernels/functions/expression.h"
#include "kernels/functions/tape_values.h"

namespace oktett {
namespace {

using Number = Simd<double, 1, ScalarIsa>;
constexpr std::string_view kVariables[] = {"x", "y", "z"};

[[noreturn]] void fail(std::size_t place, const std::string& what) {
  throw Error(Location{"", 0, static_cast<int>(place) + 1}, what);
}

/// Translates nodes to values, each only once.
class Values {
 public:
  Values() {
    for (std::uint32_t k = 0; k < 3; ++k) list_.push_back({});
  }

  std::uint32_t constant(double c) { return find({TapeOp::constant, kNoId, kNoId, 0, c}); }

  /// `place` is where to say what is wrong.
  std::uint32_t make(TapeOp op, std::size_t place, std::uint32_t a, std::uint32_t b = kNoId, int n = 0,
                     double c = 0) {
    if (is_constant(a) && (b == kNoId || is_constant(b))) return fold({op, a, b, n, c}, place);
    return find({op, a, b, n, c});
  }

  std::uint32_t translate(const ExpressionNode& node, std::size_t place, std::uint32_t a, std::uint32_t b) {
    switch (node.op) {
      case ExpressionOp::constant:
        return constant(node.value);
      case ExpressionOp::variable:
        return node.a;
      case ExpressionOp::negate:
        return make(TapeOp::negate, place, a);
      case ExpressionOp::add:
        return sum(place, a, b);
      case ExpressionOp::subtract:
        if (is_constant(b)) return sum(place, a, constant(-list_[b].c));
        if (is_constant(a)) return sum(place, make(TapeOp::negate, place, b), a);
        return make(TapeOp::subtract, place, a, b);
      case ExpressionOp::multiply:
        return product(place, a, b);
      case ExpressionOp::divide:
        return quotient(place, a, b);
      case ExpressionOp::power:
        return power(place, a, b);
      case ExpressionOp::log2:
        return product(place, make(TapeOp::log, place, a), constant(1 / std::numbers::ln2));
      case ExpressionOp::log10:
        return product(place, make(TapeOp::log, place, a), constant(1 / std::numbers::ln10));
      case ExpressionOp::hypot:
        return make(TapeOp::sqrt, place,
                    sum(place, make(TapeOp::square, place, a), make(TapeOp::square, place, b)));
      default:
        return make(simple(node.op), place, a, b);
    }
  }

  const std::vector<TapeValue>& list() const { return list_; }
  bool is_constant(std::uint32_t v) const { return v > 2 && list_[v].op == TapeOp::constant; }

 private:
  using Key = std::tuple<TapeOp, std::uint32_t, std::uint32_t, int, std::uint64_t>;
  static Key key(const TapeValue& v) { return {v.op, v.a, v.b, v.n, std::bit_cast<std::uint64_t>(v.c)}; }

  std::uint32_t find(TapeValue v) {
    const bool commutes =
        v.op == TapeOp::add || v.op == TapeOp::multiply || v.op == TapeOp::min || v.op == TapeOp::max;
    if (commutes && v.b < v.a) std::swap(v.a, v.b);
    const auto [at, is_new] = index_.try_emplace(key(v), static_cast<std::uint32_t>(list_.size()));
    if (is_new) list_.push_back(v);
    return at->second;
  }

  std::uint32_t fold(const TapeValue& v, std::size_t place) {
    Gradient<Number> r[3];
    tape::set(r[0], list_[v.a].c);
    tape::set(r[1], v.b == kNoId ? 0 : list_[v.b].c);
    tape::set(r[2], 0);
    if (v.op == TapeOp::divide && list_[v.b].c == 0) fail(place, "division by zero");
    tape::run_step({v.op, 2, 0, 1, v.n, v.c}, r);
    const double result = r[2].v.part[0].v;
    if (!std::isfinite(result)) fail(place, "the value is not a finite number");
    return constant(result);
  }

  std::uint32_t sum(std::size_t place, std::uint32_t a, std::uint32_t b) {
    if (is_constant(a) == is_constant(b)) return make(TapeOp::add, place, a, b);
    if (is_constant(a)) std::swap(a, b);
    return list_[b].c == 0 ? a : make(TapeOp::add_constant, place, a, kNoId, 0, list_[b].c);
  }
  std::uint32_t product(std::size_t place, std::uint32_t a, std::uint32_t b) {
    if (a == b) return make(TapeOp::square, place, a);
    if (is_constant(a) == is_constant(b)) return make(TapeOp::multiply, place, a, b);
    if (is_constant(a)) std::swap(a, b);
    const double c = list_[b].c;
    if (c == 1) return a;
    return c == -1 ? make(TapeOp::negate, place, a) : make(TapeOp::multiply_constant, place, a, kNoId, 0, c);
  }
  std::uint32_t quotient(std::size_t place, std::uint32_t a, std::uint32_t b) {
    if (!is_constant(b) || is_constant(a)) return make(TapeOp::divide, place, a, b);
    const double c = list_[b].c, inverse = 1 / c;
    if (c == 0) fail(place, "division by zero");
    return std::isnormal(inverse) ? product(place, a, constant(inverse)) : make(TapeOp::divide, place, a, b);
  }
  std::uint32_t power(std::size_t place, std::uint32_t a, std::uint32_t b) {
    if (!is_constant(b)) {
      if (is_constant(a) && !(list_[a].c > 0))
        fail(place, "only a positive number may have an exponent with x, y or z in it");
      return make(TapeOp::exp, place, product(place, b, make(TapeOp::log, place, a)));
    }
    const double y = list_[b].c;
    const bool whole = y == std::nearbyint(y) && std::abs(y) <= kMaxTapePower;
    if (y == 1) return a;
    if (y == 2) return make(TapeOp::square, place, a);
    if (y == 0.5) return make(TapeOp::sqrt, place, a);
    if (whole) return make(TapeOp::whole_power, place, a, kNoId, static_cast<int>(y));
    return make(TapeOp::real_power, place, a, kNoId, 0, y);
  }

  /// The operation of the same name.
  static TapeOp simple(ExpressionOp op) {
    static constexpr std::pair<ExpressionOp, TapeOp> kSame[] = {
        {ExpressionOp::sqrt, TapeOp::sqrt},   {ExpressionOp::abs, TapeOp::abs},
        {ExpressionOp::sin, TapeOp::sin},     {ExpressionOp::cos, TapeOp::cos},
        {ExpressionOp::tan, TapeOp::tan},     {ExpressionOp::asin, TapeOp::asin},
        {ExpressionOp::acos, TapeOp::acos},   {ExpressionOp::atan, TapeOp::atan},
        {ExpressionOp::atan2, TapeOp::atan2}, {ExpressionOp::exp, TapeOp::exp},
        {ExpressionOp::log, TapeOp::log},     {ExpressionOp::min, TapeOp::min},
        {ExpressionOp::max, TapeOp::max},     {ExpressionOp::floor, TapeOp::floor},
        {ExpressionOp::ceil, TapeOp::ceil},   {ExpressionOp::round, TapeOp::round},
        {ExpressionOp::sign, TapeOp::sign}};
    return std::find_if(std::begin(kSame), std::end(kSame), [op](const auto& s) { return s.first == op; })
        ->second;
  }

  std::vector<TapeValue> list_;  ///< x, y and z first
  std::map<Key, std::uint32_t> index_;
};

}  // namespace

FunctionTape compile_function(std::string_view text) {
  const Expression parsed = parse_expression(text, kVariables);
  Values values;
  std::vector<std::uint32_t> made;
  for (std::size_t i = 0; i < parsed.nodes.size(); ++i) {
    const ExpressionNode& node = parsed.nodes[i];
    const int operands = operand_count(node.op);
    made.push_back(values.translate(node, parsed.places[i], operands > 0 ? made[node.a] : kNoId,
                                    operands > 1 ? made[node.b] : kNoId));
  }
  const std::uint32_t root = made.back();
  return write_tape(values.list(), root);
}

double value_at(const FunctionTape& tape, double x, double y, double z) {
  using D = Simd<double, 1, ScalarIsa>;
  const auto constant = [&](double c) { return Gradient<D>{D(c), gradient::zero<Vec3<D>>()}; };
  return only_lane(run_tape(tape, constant(x), constant(y), constant(z)).v);
}

}  // namespace oktett
