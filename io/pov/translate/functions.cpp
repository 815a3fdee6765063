#include "io/pov/translate/functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

#include "io/pov/formula_text.h"
#include "io/pov/internal_functions.h"
#include "io/pov/noise_functions.h"
#include "io/pov/read_pov.h"
#include "io/pov/translate/pigment.h"
#include "kernels/functions/expression.h"

namespace oktett::pov {
namespace {

/// What a function is called that cannot be written.
struct Unwritable {
  std::string why;
};

std::string number_of(double value) {
  if (!std::isfinite(value)) throw Unwritable{"a number that is not finite"};
  return value < 0 ? fmt::format("({})", value) : fmt::format("{}", value);
}

/// How a function is written; {0}, {1}, ... are its operands.
struct Formula {
  std::string_view name;
  const char* text;
};
constexpr Formula kFormulas[] = {
    {"+", "({0} + {1})"},
    {"-", "({0} - {1})"},
    {"*", "({0} * {1})"},
    {"/", "({0} / {1})"},
    {"neg", "(-{0})"},
    {"!", "(1 - abs(sign({0})))"},
    {"<", "max(0, sign({1} - {0}))"},
    {">", "max(0, sign({0} - {1}))"},
    {"<=", "(1 - max(0, sign({0} - {1})))"},
    {">=", "(1 - max(0, sign({1} - {0})))"},
    {"=", "(1 - abs(sign({0} - {1})))"},
    {"!=", "abs(sign({0} - {1}))"},
    {"&", "abs(sign({0}) * sign({1}))"},
    {"|", "max(abs(sign({0})), abs(sign({1})))"},
    {"abs", "abs({0})"},
    {"sqrt", "sqrt({0})"},
    {"sqr", "({0})^2"},
    {"pow", "pow({0}, {1})"},
    {"sin", "sin({0})"},
    {"cos", "cos({0})"},
    {"tan", "tan({0})"},
    {"asin", "asin({0})"},
    {"acos", "acos({0})"},
    {"atan", "atan({0})"},
    {"atan2", "atan2({0}, {1})"},
    {"sinh", "((exp({0}) - exp(-({0}))) / 2)"},
    {"cosh", "((exp({0}) + exp(-({0}))) / 2)"},
    {"tanh", "(1 - 2 / (exp(2 * ({0})) + 1))"},
    {"asinh", "(sign({0}) * log(abs({0}) + sqrt(({0})^2 + 1)))"},
    {"acosh", "log({0} + sqrt(({0})^2 - 1))"},
    {"atanh", "(log((1 + {0}) / (1 - {0})) / 2)"},
    {"exp", "exp({0})"},
    {"ln", "log({0})"},
    {"log", "log10({0})"},
    {"floor", "floor({0})"},
    {"ceil", "ceil({0})"},
    {"int", "(sign({0}) * floor(abs({0})))"},
    {"mod", "({0} - {1} * sign({0} / {1}) * floor(abs({0} / {1})))"},
    {"div", "(sign({0} / {1}) * floor(abs({0} / {1})))"},
    {"degrees", "({0} * 180 / pi)"},
    {"radians", "({0} * pi / 180)"},
};

/// A sum over the octaves of a pattern of noise, each twice as fine and half as high as the one before.
/// `noise` is made of {0}, noise in its octave.
std::string octaves(const char* noise, int count, double scale, double weight,
                    const std::array<std::string, 3>& p, NoiseGenerator generator) {
  std::string sum;
  for (int k = 0; k < count; ++k, scale *= 2, weight *= 0.5) {
    const auto finer = [&](const std::string& x) { return filled("$0 * $1", {x, number_of(scale)}); };
    const std::string at = noise_formula(generator, finer(p[0]), finer(p[1]), finer(p[2]));
    sum += fmt::format("{}{} * {}", k == 0 ? "" : " + ", fmt::format(fmt::runtime(noise), at), weight);
  }
  return sum;
}

/// The values of a pattern at p where they are between 0 and 1 everywhere. Empty if it has no formula.
std::string bounded_formula(std::string_view word, const std::array<std::string, 3>& p,
                            NoiseGenerator generator) {
  const auto at = [&](const char* text) { return fmt::format(fmt::runtime(text), p[0], p[1], p[2]); };
  const bool is_first = generator == NoiseGenerator::povray_1;
  if (word == "bozo" || word == "bumps" || word == "spotted")
    return noise_formula(generator, p[0], p[1], p[2]);
  if (word == "dents") return noise_formula(generator, p[0], p[1], p[2]) + "^3";
  if (word == "granite")
    return "(" + octaves(is_first ? "abs(0.5 - {})" : "min(0.5, abs(1 - 2 * {}))", 6, 4, 1, p, generator) +
           ")";
  if (word == "wrinkles")
    return "(" + octaves(is_first ? "{}" : "max(0, min(1, 2 * {} - 0.5))", 10, 1, 0.5, p, generator) + ")";
  if (word == "leopard") return at("((sin({}) + sin({}) + sin({})) / 3)^2");
  if (word == "spherical") return at("max(0, 1 - sqrt(({})^2 + ({})^2 + ({})^2))");
  if (word == "cylindrical") return at("max(0, 1 - hypot({0}, {2}))");
  if (word == "planar") return at("max(0, 1 - abs({1}))");
  if (word == "boxed") return at("max(0, 1 - max(abs({}), abs({}), abs({})))");
  return "";
}

/// A pattern at a place before a wave brings its values into one period.
struct PatternFormula {
  std::string text;          ///< empty: there is none
  bool has_period = false;   ///< whether values beyond 0 and 1 occur
  bool is_triangle = false;  ///< whether its own wave goes back and forth
};

/// The values of a pattern at p, which are those of the pattern of this name in scene files.
PatternFormula pattern_formula(const PovPattern& pattern, const std::array<std::string, 3>& p,
                               NoiseGenerator of_scene) {
  const std::string_view word = pattern.word;
  const auto at = [&](const char* text) { return filled(text, {p[0], p[1], p[2]}); };
  if (word == "marble") return {p[0], true, true};
  if (word == "wood") return {at("hypot($0, $1)"), true, true};
  if (word == "radial") return {at("0.75 + atan2($0, $2) / (2 * pi)"), true};
  if (word == "onion") return {filled("$0 - floor($0)", {at("sqrt($0^2 + $1^2 + $2^2)")})};
  if (pattern.is_list) return {number_formula(word, p)};
  if (word == "gradient") {
    const Vec3d d = normalize(pattern.direction);
    const std::string along = filled("$0 * $3 + $1 * $4 + $2 * $5",
                                     {p[0], p[1], p[2], number_of(d.x), number_of(d.y), number_of(d.z)});
    return {filled("$0 - max(0, sign($0 - 1)) * floor($0)", {along}), true};
  }
  return {bounded_formula(word, p, pattern.noise_generator.value_or(of_scene))};
}

/// What the wave of a pattern makes of its values; the formulas are those of `waved` in render/warp.h.
std::string waved_formula(const PovPattern& p, const PatternFormula& f) {
  const bool triangle = p.wave == "triangle" || (p.wave.empty() && f.is_triangle);
  const bool is_plain = !f.has_period && p.frequency == 1 && p.phase == 0;
  if (is_plain && (p.wave.empty() || p.wave == "ramp")) return f.text;
  std::string x = f.text;
  if (p.frequency != 0) {
    if (p.frequency != 1 || p.phase != 0)
      x = filled("$0 * $1 + $2", {x, number_of(p.frequency), number_of(p.phase)});
    x = filled("$0 - 1.00001 * sign($0) * floor(abs($0) / 1.00001)", {x});
  }
  x = filled("min(1, $0 - min(0, floor($0)))", {x});
  if (triangle) return filled("1 - abs(2 * $0 - 1)", {x});
  if (p.wave == "sine") return filled("0.5 + 0.5 * sin(2 * pi * $0)", {x});
  if (p.wave == "scallop") return filled("abs(sin(pi * $0))", {x});
  if (p.wave == "cubic") return filled("$0^2 * (3 - 2 * $0)", {x});
  if (p.wave == "poly") return filled("pow($0, $1)", {x, number_of(p.exponent)});
  return x;
}

/// What lies between two places of a map or a spline: a polynomial of the part of the way from one to the
/// other.
struct Piece {
  double from, to;
  std::array<double, 4> c{};
};

/// The function of `at` that is `first` before all pieces, which follow each other, and constant behind them.
/// A piece without length is a jump just behind its place.
std::string pieces_text(const std::string& at, double first, const std::vector<Piece>& pieces) {
  std::string sum = number_of(first);
  double reached = first;
  for (const Piece& piece : pieces) {
    const auto& c = piece.c;
    if (c[0] != reached)
      sum +=
          fmt::format(" + {} * max(0, sign({} - {}))", number_of(c[0] - reached), at, number_of(piece.from));
    reached = c[0];
    if (!(piece.to > piece.from)) continue;
    reached = c[0] + c[1] + c[2] + c[3];
    const std::string u = filled("max(0, min(1, ($0 - $1) * $2))",
                                 {at, number_of(piece.from), number_of(1 / (piece.to - piece.from))});
    std::string text;
    for (std::size_t k = 3; k > 0; --k) {
      if (text.empty() && c[k] == 0) continue;
      text = text.empty() ? fmt::format("{} * {}", number_of(c[k]), u)
                          : fmt::format("({} + {}) * {}", number_of(c[k]), text, u);
    }
    if (!text.empty()) sum += " + " + text;
  }
  return "(" + sum + ")";
}

/// A component of a spline. Between two points it is a cubic through four of its values.
std::string spline_text(const Spline& spline, std::size_t component, const std::string& at) {
  if (spline.points.empty()) throw Unwritable{"a spline without points"};
  std::vector<Piece> pieces;
  const auto value = [&](double place) { return evaluate(spline, place)[component]; };
  for (std::size_t i = 0; i + 1 < spline.points.size(); ++i) {
    const double from = spline.points[i].at, to = spline.points[i + 1].at, step = (to - from) / 3;
    const double a = value(from), b = value(from + step), c = value(to - step), d = value(to);
    Piece piece{from,
                to,
                {a, -5.5 * a + 9 * b - 4.5 * c + d, 9 * a - 22.5 * b + 18 * c - 4.5 * d,
                 4.5 * (d - a) + 13.5 * (b - c)}};
    // What is rounding of these sums is none.
    const double size = std::abs(a) + std::abs(b) + std::abs(c) + std::abs(d);
    for (double& x : piece.c)
      if (std::abs(x) <= 1e-13 * size) x = 0;
    if (piece.c[2] == 0 && piece.c[3] == 0) piece.c[1] = d - a;
    // One piece begins where the one before ends.
    piece.c[0] = pieces.empty()
                     ? a
                     : pieces.back().c[0] + pieces.back().c[1] + pieces.back().c[2] + pieces.back().c[3];
    if (to > from) pieces.push_back(piece);
  }
  return pieces_text(at, value(spline.points.front().at), pieces);
}

class Writer {
 public:
  /// What stands for the place where colours are asked for, and for the channels of the colour there.
  static constexpr const char* kPlace[] = {"@x", "@y", "@z"};
  static constexpr const char* kChannels[] = {"x", "y", "z"};

  /// `pigment`: gets the one whose colour at the place the function uses; null: there may be none.
  Writer(const Function& function, std::vector<std::string> parameters, Context& context, int depth,
         std::shared_ptr<const Block>* pigment = nullptr)
      : function_(function),
        parameters_(std::move(parameters)),
        context_(context),
        depth_(depth),
        pigment_(pigment) {}

  std::string text() {
    if (function_.nodes.empty()) throw Unwritable{"an empty function"};
    if (depth_ > 100) throw Unwritable{"functions nested deeper than 100 levels"};
    for (const FunctionNode& node : function_.nodes) {
      texts_.push_back(write(node));
      if (texts_.back().size() > kMaxExpressionLength - 64)
        throw Unwritable{fmt::format("more than {} characters when it is written out", kMaxExpressionLength)};
    }
    return texts_.back();
  }

 private:
  std::string write(const FunctionNode& node) {
    using Op = FunctionNode::Op;
    std::vector<std::string> operands;
    for (const std::uint32_t i : node.operands) operands.push_back(texts_.at(i));
    switch (node.op) {
      case Op::constant:
        return number_of(node.number);
      case Op::parameter:
        return parameters_.at(node.index);
      case Op::call:
        return node.function != nullptr ? loop(node, operands) : call(node.name, operands);
      case Op::internal:
        return internal(node.index, operands);
      case Op::user:
        if (node.function == nullptr) throw Unwritable{"an unknown function"};
        operands.resize(std::max(operands.size(), node.function->parameters.size()), "0");
        return Writer(*node.function, operands, context_, depth_ + 1, pigment_).text();
      case Op::spline:
        return spline(node, operands);
      case Op::pattern:
        return pattern(node, operands);
      case Op::transform:
        return transformed(node, operands);
    }
    throw Unwritable{"an unknown step"};
  }

  std::string internal(std::uint32_t number, const std::vector<std::string>& operands) const {
    if (std::optional<std::string> text = internal_text(number, operands, context_.noise_generator))
      return *text;
    throw Unwritable{
        fmt::format("a function of functions.inc that has no formula here ({})",
                    function_.name.empty() ? fmt::format("internal({})", number) : function_.name)};
  }

  /// A component of a place that a transform has moved.
  std::string transformed(const FunctionNode& node, const std::vector<std::string>& operands) const {
    if (node.block == nullptr || operands.size() < 3 || node.index > 2)
      throw Unwritable{"an unknown transform"};
    const Matrix matrix = evaluate_transform(*node.block, context_.document);
    std::string sum = number_of(matrix[3][node.index]);
    for (std::size_t i = 0; i < 3; ++i)
      if (matrix[i][node.index] != 0)
        sum += fmt::format(" + {} * {}", number_of(matrix[i][node.index]), operands[i]);
    return "(" + sum + ")";
  }

  /// `sum` and `prod`, written out; the body's first parameter is the counter.
  std::string loop(const FunctionNode& node, const std::vector<std::string>& operands) const {
    const std::optional<double> first = constant(operands.at(0)), last = constant(operands.at(1));
    if (!first || !last) throw Unwritable{"a loop whose ends depend on the place"};
    const bool is_sum = node.name == "sum";
    std::string text;
    std::vector<std::string> parameters(operands.begin() + 1, operands.end());
    for (double counter = *first; counter <= *last; ++counter) {
      parameters[0] = number_of(counter);
      const std::string term = Writer(*node.function, parameters, context_, depth_ + 1, pigment_).text();
      text += fmt::format("{}{}", text.empty() ? "" : is_sum ? " + " : " * ", term);
      if (text.size() > kMaxExpressionLength || counter + 1 == counter)
        throw Unwritable{"a loop of too many steps"};
    }
    return text.empty() ? (is_sum ? "0" : "1") : "(" + text + ")";
  }

  static std::string spline(const FunctionNode& node, const std::vector<std::string>& operands) {
    if (node.spline == nullptr || operands.empty() || node.index > 4) throw Unwritable{"an unknown spline"};
    return spline_text(*node.spline, node.index, operands[0]);
  }

  std::string pattern(const FunctionNode& node, const std::vector<std::string>& operands) const {
    if (node.block == nullptr || operands.size() < 3) throw Unwritable{"an unknown pattern"};
    if (node.block->keyword != "pattern") return pigment(node, operands);
    Pigment shown;
    PatternReader reader(context_, [&](const Block& block) -> Node {
      read_pigment(context_, block, shown);
      return nullptr;
    });
    Arguments arguments(context_, *node.block);
    PovPattern p;
    while (!arguments.at_end())
      if (!reader.take(arguments, p)) throw Unwritable{"a pattern with more than expressions have"};
    const Coordinates at = place_in(p, operands);
    if (p.word == "pigment_pattern") return waved_formula(p, {brightness(shown, at)});
    return value_of(p, at);
  }

  /// The coordinates of a place, as formulas.
  using Coordinates = std::array<std::string, 3>;

  /// Where a pattern is asked for its value, at the place that three operands are.
  template <class Operands>
  static Coordinates place_in(const PovPattern& p, const Operands& operands) {
    const std::string name = fmt::format("a pattern '{}'", p.word);
    Affine all;
    for (const auto& modifier : p.modifiers) {
      const auto* const moves = std::get_if<Moves>(&modifier);
      if (moves == nullptr) throw Unwritable{name + " with a warp"};
      all = moves->all * all;
    }
    if (!(p.turbulence == Vec3d{0, 0, 0})) throw Unwritable{name + " with turbulence"};
    if (!all.is_invertible()) throw Unwritable{name + " with a transform that has no inverse"};
    return moved(all.inverse(), operands);
  }

  std::string value_of(const PovPattern& p, const Coordinates& at) const {
    const PatternFormula formula = pattern_formula(p, at, context_.noise_generator);
    if (formula.text.empty()) throw Unwritable{fmt::format("a pattern '{}'", p.word)};
    return waved_formula(p, formula);
  }

  /// A channel of a pigment's colour: of the colour at the place itself, where that is asked for.
  std::string pigment(const FunctionNode& node, const std::vector<std::string>& operands) const {
    if (node.index > 4) throw Unwritable{"an unknown pigment"};
    if (pigment_ != nullptr) {
      const bool is_here = operands[0] == kPlace[0] && operands[1] == kPlace[1] && operands[2] == kPlace[2];
      if (!is_here || node.index > 2 || (*pigment_ != nullptr && *pigment_ != node.block))
        throw Unwritable{"pigments of several places"};
      *pigment_ = node.block;
      return kChannels[node.index];
    }
    Pigment p;
    read_pigment(context_, *node.block, p);
    return channel(p, node.index, operands);
  }

  /// As video weights colours, see pattern_figures.cpp in render/.
  std::string brightness(const Pigment& p, const Coordinates& at) const {
    return filled("0.297 * $0 + 0.589 * $1 + 0.114 * $2",
                  {channel(p, 0, at), channel(p, 1, at), channel(p, 2, at)});
  }

  template <class Operands>
  std::string channel(const Pigment& p, std::uint32_t index, const Operands& operands) const {
    const auto of = [&](const PigmentEntry& entry) {
      const PovColor& c = entry.color;
      return index < 3 ? c.rgb[static_cast<int>(index)] : index == 3 ? c.filter : c.transmit;
    };
    if (is_solid(p)) return number_of(of({0, p.solid, nullptr}));
    const Coordinates at = place_in(p.pattern, operands);
    const auto text_of = [&](const PigmentEntry& entry) {
      return entry.pigment != nullptr ? channel(*entry.pigment, index, at) : number_of(of(entry));
    };
    if (p.is_average) return mean(p.entries, text_of);
    const std::vector<PigmentEntry> entries = entries_of(p);
    if (std::ranges::any_of(entries, [](const PigmentEntry& entry) { return entry.pigment != nullptr; }))
      return blend(p, entries, value_of(p.pattern, at), text_of);
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i + 1 < entries.size(); ++i) {
      const double a = of(entries[i]), b = of(entries[i + 1]);
      // The values of a list are its numbers.
      if (p.pattern.is_list)
        pieces.push_back({static_cast<double>(i) + 0.5, static_cast<double>(i) + 0.5, {b}});
      else
        pieces.push_back({entries[i].at, entries[i + 1].at, {a, b - a}});
    }
    return pieces_text(value_of(p.pattern, at), of(entries.front()), pieces);
  }

  /// The mean of entries whose places are weights.
  template <class TextOf>
  static std::string mean(const std::vector<PigmentEntry>& entries, const TextOf& text_of) {
    double weights = 0;
    for (const PigmentEntry& entry : entries) weights += entry.at;
    if (!(weights > 0)) throw Unwritable{"an average of nothing"};
    std::string sum;
    for (const PigmentEntry& entry : entries)
      sum +=
          fmt::format("{}{} * {}", sum.empty() ? "" : " + ", number_of(entry.at / weights), text_of(entry));
    return "(" + sum + ")";
  }

  /// From entry to entry as the value `v` of the pattern says; in a list it is the number of one.
  template <class TextOf>
  static std::string blend(const Pigment& p, const std::vector<PigmentEntry>& entries, const std::string& v,
                           const TextOf& text_of) {
    std::string before = text_of(entries.front()), sum = before;
    for (std::size_t i = 0; i + 1 < entries.size(); ++i) {
      const double middle = static_cast<double>(i) + 0.5;
      Piece part{entries[i].at, entries[i + 1].at, {0, 1}};
      if (p.pattern.is_list) part = {middle, middle, {1}};
      if (!(part.to > part.from)) part.c = {1};
      const std::string next = text_of(entries[i + 1]);
      sum += fmt::format(" + ({} - {}) * {}", next, before, pieces_text(v, 0, {part}));
      before = next;
      if (sum.size() > kMaxExpressionLength)
        throw Unwritable{"pigments that are too long when they are written out"};
    }
    return "(" + sum + ")";
  }

  /// The coordinates of the place to which a map takes the place that three operands are.
  template <class Operands>
  static Coordinates moved(const Affine& map, const Operands& operands) {
    Coordinates to;
    const Vec3d origin = map.point({0, 0, 0});
    for (int row = 0; row < 3; ++row) {
      std::string sum;
      for (int column = 0; column < 3; ++column) {
        Vec3d unit{0, 0, 0};
        unit[column] = 1;
        const double factor = map.vector(unit)[row];
        if (factor == 0) continue;
        sum += sum.empty() ? "" : " + ";
        sum += factor == 1
                   ? operands[static_cast<std::size_t>(column)]
                   : fmt::format("{} * {}", number_of(factor), operands[static_cast<std::size_t>(column)]);
      }
      if (origin[row] != 0 || sum.empty())
        sum += fmt::format("{}{}", sum.empty() ? "" : " + ", number_of(origin[row]));
      to[static_cast<std::size_t>(row)] = "(" + sum + ")";
    }
    return to;
  }

  static std::string call(std::string_view name, const std::vector<std::string>& operands) {
    for (const Formula& pattern : kFormulas)
      if (pattern.name == name) return fill(pattern.text, operands);
    if (name == "min" || name == "max") {
      if (operands.size() == 1) return operands[0];
      return fmt::format("{}({})", name, fmt::join(operands, ", "));
    }
    if (name == "if" || name == "select" || name == "?") return select(name, operands);
    throw Unwritable{fmt::format("'{}'", name)};
  }

  /// `select` asks whether its first operand is below 0, `if` whether it is not 0.
  static std::string select(std::string_view name, const std::vector<std::string>& operands) {
    if (name == "select" && operands.size() == 3)
      return fill("(max(0, -sign({0})) * {1} + (1 - max(0, -sign({0}))) * {2})", operands);
    if (name == "select" && operands.size() == 4)
      return fill("(max(0, -sign({0})) * {1} + (1 - abs(sign({0}))) * {2} + max(0, sign({0})) * {3})",
                  operands);
    return fill("(abs(sign({0})) * {1} + (1 - abs(sign({0}))) * {2})", operands);
  }

  static std::string fill(const char* text, std::vector<std::string> operands) {
    std::size_t needed = 0;
    for (const char* at = text; *at != '\0'; ++at)
      if (*at == '{' && at[1] >= '0' && at[1] <= '9')
        needed = std::max<std::size_t>(needed, static_cast<std::size_t>(at[1] - '0') + 1);
    if (operands.size() < needed) throw Unwritable{"a function with too few operands"};
    operands.resize(8);
    return fmt::format(fmt::runtime(text), operands[0], operands[1], operands[2], operands[3], operands[4],
                       operands[5], operands[6], operands[7]);
  }

  const Function& function_;
  std::vector<std::string> parameters_;
  Context& context_;
  int depth_;
  std::shared_ptr<const Block>* pigment_;
  std::vector<std::string> texts_;
};

}  // namespace

std::optional<std::string> function_text(Context& context, const Function& function, const Place& where,
                                         double threshold, std::span<const std::string_view> variables) {
  try {
    std::string text = Writer(function, {variables.begin(), variables.end()}, context, 0).text();
    if (threshold != 0) text += fmt::format(" - {}", number_of(threshold));
    parse_expression(text, variables);
    return text;
  } catch (const Unwritable& reason) {
    context.tell(
        "function with " + reason.why, where,
        "this function contains " + reason.why + ", which expressions here do not have; it is left out");
  } catch (const std::exception& error) {
    context.warn(where, fmt::format("this function is no expression here: {}; it is left out", error.what()));
  }
  return std::nullopt;
}

std::optional<ColorFunction> function_of_pigment(Context& context, const Function& function) {
  ColorFunction found;
  try {
    const auto& place = Writer::kPlace;
    found.text = Writer(function, {place[0], place[1], place[2]}, context, 0, &found.pigment).text();
    if (found.pigment == nullptr || found.text.find('@') != std::string::npos) return std::nullopt;
    parse_expression(found.text, std::array<std::string_view, 3>{"x", "y", "z"});
    return found;
  } catch (const Unwritable&) {
  } catch (const std::exception&) {}
  return std::nullopt;
}

}  // namespace oktett::pov
