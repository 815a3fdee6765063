#include "kernels/functions/function_tape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "kernels/functions/expression.h"

namespace oktett {

// ---- A function as a list of values, each computed once from values before it: the form in which a tape is
// made and cut down.

namespace {

bool is_wave(TapeOp op) { return op == TapeOp::sin || op == TapeOp::cos; }

/// Writes the steps for the values that count, and gives registers back after their last use.
class Writer {
 public:
  Writer(std::span<const TapeValue> list, std::uint32_t root) : list_(list) {
    uses_.assign(list_.size(), 0);
    uses_[root] = 1;
    for (std::uint32_t v = static_cast<std::uint32_t>(list_.size()); v-- > 3;) {
      if (uses_[v] == 0) continue;
      if (list_[v].a != kNoId) ++uses_[list_[v].a];
      if (list_[v].b != kNoId) ++uses_[list_[v].b];
      if (list_[v].third != kNoId) ++uses_[list_[v].third];
      if (is_wave(list_[v].op)) waves_[{list_[v].op, list_[v].a}] = v;
    }
    registers_.resize(list_.size());
    for (std::uint32_t k = 0; k < 3; ++k) registers_[k] = static_cast<std::uint8_t>(k);
    written_.assign(list_.size(), false);
    for (std::uint32_t v = 3; v < list_.size(); ++v)
      if (uses_[v] > 0 && !written_[v]) write(v);
    tape_.result = registers_[root];
    tape_.varies = root < 3 || list_[root].op != TapeOp::constant;
  }
  FunctionTape take() { return std::move(tape_); }

 private:
  [[noreturn]] static void fail(const std::string& what) { throw Error(Location{"", 0, 1}, what); }

  /// The cosine of what `v` is the sine of, or the other way round, if it counts; else kNoId.
  std::uint32_t partner(std::uint32_t v) const {
    const TapeValue& value = list_[v];
    if (!is_wave(value.op)) return kNoId;
    const auto found = waves_.find({value.op == TapeOp::sin ? TapeOp::cos : TapeOp::sin, value.a});
    return found == waves_.end() ? kNoId : found->second;
  }

  void write(std::uint32_t v) {
    const TapeValue& value = list_[v];
    if (tape_.steps.size() == kMaxTapeSteps)
      fail("the function takes more than " + std::to_string(kMaxTapeSteps) + " steps");
    TapeStep step{value.op, 0, 0, 0, value.n, value.c};
    if (value.a != kNoId) step.a = registers_[value.a];
    if (value.b != kNoId) step.b = registers_[value.b];
    if (value.third != kNoId) step.n = registers_[value.third];
    const std::uint32_t other = partner(v);
    if (other != kNoId) {
      // The angle is used by both; neither result may overwrite it before the other is there.
      registers_[v] = acquire(), registers_[other] = acquire();
      written_[other] = true;
      release(value.a), release(value.a);
      step.op = TapeOp::sin_cos;
      step.out = registers_[value.op == TapeOp::sin ? v : other];
      step.b = registers_[value.op == TapeOp::sin ? other : v];
    } else {
      // What a result overwrites is read before.
      if (value.a != kNoId) release(value.a);
      if (value.b != kNoId) release(value.b);
      if (value.third != kNoId) release(value.third);
      step.out = registers_[v] = acquire();
    }
    written_[v] = true;
    tape_.steps.push_back(step);
  }
  void release(std::uint32_t v) {
    if (--uses_[v] == 0 && v > 2) free_.push_back(registers_[v]);
  }
  std::uint8_t acquire() {
    if (free_.empty()) {
      if (tape_.registers == 3 + kMaxTapeRegisters)
        fail("the function needs more than " + std::to_string(kMaxTapeRegisters) + " values at a time");
      return static_cast<std::uint8_t>(tape_.registers++);
    }
    const std::uint8_t r = free_.back();
    free_.pop_back();
    return r;
  }

  std::span<const TapeValue> list_;
  std::map<std::pair<TapeOp, std::uint32_t>, std::uint32_t> waves_;  ///< the sines and cosines that count
  std::vector<std::uint32_t> uses_;
  std::vector<std::uint8_t> registers_, free_;
  std::vector<bool> written_;
  FunctionTape tape_;
};

bool has_second(TapeOp op) {
  switch (op) {
    case TapeOp::add:
    case TapeOp::subtract:
    case TapeOp::multiply:
    case TapeOp::divide:
    case TapeOp::atan2:
    case TapeOp::min:
    case TapeOp::max:
    case TapeOp::noise:
    case TapeOp::povray_noise:
      return true;
    default:
      return false;
  }
}

}  // namespace

FunctionTape write_tape(std::span<const TapeValue> values, std::uint32_t root) {
  return Writer(values, root).take();
}

TapeValues values_of(const FunctionTape& tape) {
  TapeValues values;
  values.list.resize(3);
  std::vector<std::uint32_t> in(static_cast<std::size_t>(tape.registers));
  for (std::uint32_t k = 0; k < 3; ++k) in[k] = k;
  for (const TapeStep& s : tape.steps) {
    TapeValue value{s.op, kNoId, kNoId, s.n, s.c};
    if (s.op != TapeOp::constant) value.a = in[s.a];
    if (has_second(s.op)) value.b = in[s.b];
    if (has_third(s.op)) value.third = in[static_cast<std::size_t>(s.n)], value.n = 0;
    const auto add = [&](TapeOp op, std::uint8_t out) {
      value.op = op, in[out] = static_cast<std::uint32_t>(values.list.size());
      values.list.push_back(value);
    };
    if (s.op == TapeOp::sin_cos) {
      add(TapeOp::sin, s.out), add(TapeOp::cos, s.b);
    } else {
      add(s.op, s.out);
    }
  }
  values.root = in[tape.result];
  return values;
}

namespace {

using Number = Simd<double, 1, ScalarIsa>;

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

  std::uint32_t translate(const ExpressionNode& node, std::size_t place, std::uint32_t a, std::uint32_t b,
                          std::uint32_t c) {
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
      case ExpressionOp::noise:
      case ExpressionOp::povray_noise: {
        const TapeValue value{
            node.op == ExpressionOp::noise ? TapeOp::noise : TapeOp::povray_noise, a, b, 0, 0, c};
        return is_constant(a) && is_constant(b) && is_constant(c) ? fold(value, place) : find(value);
      }
      default:
        return make(simple(node.op), place, a, b);
    }
  }

  const std::vector<TapeValue>& list() const { return list_; }
  bool is_constant(std::uint32_t v) const { return v > 2 && list_[v].op == TapeOp::constant; }

 private:
  using Key = std::tuple<TapeOp, std::uint32_t, std::uint32_t, int, std::uint64_t, std::uint32_t>;
  static Key key(const TapeValue& v) {
    return {v.op, v.a, v.b, v.n, std::bit_cast<std::uint64_t>(v.c), v.third};
  }

  std::uint32_t find(TapeValue v) {
    const bool commutes =
        v.op == TapeOp::add || v.op == TapeOp::multiply || v.op == TapeOp::min || v.op == TapeOp::max;
    if (commutes && v.b < v.a) std::swap(v.a, v.b);
    const auto [at, is_new] = index_.try_emplace(key(v), static_cast<std::uint32_t>(list_.size()));
    if (is_new) list_.push_back(v);
    return at->second;
  }

  std::uint32_t fold(const TapeValue& v, std::size_t place) {
    Gradient<Number> r[4];
    tape::set(r[0], list_[v.a].c);
    tape::set(r[1], v.b == kNoId ? 0 : list_[v.b].c);
    tape::set(r[2], 0);
    tape::set(r[3], v.third == kNoId ? 0 : list_[v.third].c);
    if (v.op == TapeOp::divide && list_[v.b].c == 0) fail(place, "division by zero");
    tape::run_step({v.op, 2, 0, 1, v.third == kNoId ? v.n : 3, v.c}, r);
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

FunctionTape compile_function(std::string_view text, std::span<const std::string_view> variables) {
  const Expression parsed = parse_expression(text, variables);
  Values values;
  std::vector<std::uint32_t> made;
  for (std::size_t i = 0; i < parsed.nodes.size(); ++i) {
    const ExpressionNode& node = parsed.nodes[i];
    const int operands = operand_count(node.op);
    made.push_back(values.translate(node, parsed.places[i], operands > 0 ? made[node.a] : kNoId,
                                    operands > 1 ? made[node.b] : kNoId,
                                    operands > 2 ? made[node.c] : kNoId));
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
