#include "io/pov/evaluate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "io/pov/numeric.h"

namespace oktett::pov {
namespace {

// ---- Transforms

Matrix unit_matrix() { return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}}; }

/// First `a`, then `b`.
Matrix then(const Matrix& a, const Matrix& b) {
  Matrix m{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + (i == 3 ? b[3][j] : 0);
  return m;
}

Matrix inverse(const Matrix& m, const Place& where, const Document& document) {
  Matrix r{};
  const auto minor = [&](std::size_t i, std::size_t j) {
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  if (determinant == 0) throw document.error(where, "this transform has no inverse");
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) r[i][j] = minor(j, i) / determinant;
  for (std::size_t j = 0; j < 3; ++j) r[3][j] = -(m[3][0] * r[0][j] + m[3][1] * r[1][j] + m[3][2] * r[2][j]);
  return r;
}

/// About the axis `axis` by degrees, by the left-handed rule of POV-Ray.
Matrix rotation(std::size_t axis, double degrees) {
  Matrix m = unit_matrix();
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  m[i][i] = m[j][j] = c;
  m[i][j] = s;
  m[j][i] = -s;
  return m;
}

/// Computes the map of a transform. Blocks that are used again and again are computed once: transforms of
/// transforms can double at each declaration.
class TransformEvaluation {
 public:
  explicit TransformEvaluation(const Document& document) : document_(document) {}

  Matrix value(const Block& block) {
    Matrix total = unit_matrix();
    const std::vector<Element>& elements = block.elements;
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const Element& element = elements[k];
      ++elements_;
      if (const BlockPtr* inner = std::get_if<BlockPtr>(&element.value)) {
        if ((*inner)->keyword == "transform") total = then(total, shared_value(*inner));
        continue;
      }
      const Word* const word = std::get_if<Word>(&element.value);
      if (word == nullptr) continue;
      if (word->text == "inverse") {
        total = inverse(total, element.where, document_);
        continue;
      }
      const bool is_matrix = word->text == "matrix";
      if (!is_matrix && word->text != "translate" && word->text != "rotate" && word->text != "scale")
        continue;
      const Element* const next = k + 1 < elements.size() ? &elements[k + 1] : nullptr;
      Matrix m = unit_matrix();
      if (is_matrix) {
        const BlockPtr* const list = next ? std::get_if<BlockPtr>(&next->value) : nullptr;
        if (list == nullptr || (*list)->elements.size() != 12)
          throw document_.error(element.where, "expected a vector of 12 numbers behind 'matrix'");
        for (std::size_t i = 0; i < 12; ++i) {
          const Numbers* const number = std::get_if<Numbers>(&(*list)->elements[i].value);
          m[i / 3][i % 3] = number ? number->v[0] : 0;
        }
      } else {
        const Numbers* const value = next ? std::get_if<Numbers>(&next->value) : nullptr;
        if (value == nullptr)
          throw document_.error(element.where, "expected a vector behind " + in_quotes(word->text));
        for (std::size_t i = 0; i < 3; ++i) {
          const double x = value->size == 1 ? value->v[0] : value->v[i];
          if (word->text == "translate") m[3][i] = x;
          if (word->text == "scale") m[i][i] = x == 0 ? 1 : x;
          if (word->text == "rotate") m = then(m, rotation(i, x));
        }
      }
      total = then(total, m);
      ++k;
    }
    return total;
  }

  /// How many were looked at.
  std::size_t elements() const { return elements_; }

 private:
  Matrix shared_value(const BlockPtr& block) {
    if (block.use_count() == 1) return value(*block);
    const auto known = known_.find(block.get());
    if (known != known_.end()) return known->second;
    const Matrix result = value(*block);
    known_.emplace(block.get(), result);
    return result;
  }

  const Document& document_;
  std::size_t elements_ = 0;
  std::unordered_map<const Block*, Matrix> known_;
};

// ---- Functions

/// Why a function has no value.
struct NoValue {
  std::string message;
};

/// Computes values of functions; the number of steps and the depth are limited.
class Evaluation {
 public:
  Evaluation(ObjectQueries* queries, std::uint64_t& steps, std::uint64_t most_steps, const Document& document)
      : queries_(queries), steps_(steps), most_steps_(most_steps), document_(document) {}

  /// The value, or the components of a function that has some.
  Numbers value(const Function& function, std::span<const double> arguments) {
    const FunctionNode& last = function.nodes.back();
    if (last.op == FunctionNode::Op::internal && function.nodes.size() == 1)
      return {{internal(last, arguments)}, 1, false};
    check_count(function, arguments.size());
    const std::vector<double> values = run(function, arguments);
    if (!has_components(function)) return {{values.back()}, 1, false};
    return components(last, operands(last, values));
  }

 private:
  static constexpr int kMostDepth = 300;

  static void check_count(const Function& function, std::size_t count) {
    if (count != function.parameters.size())
      throw NoValue{"the function takes " + std::to_string(function.parameters.size()) + " values, found " +
                    std::to_string(count)};
  }

  static std::vector<double> operands(const FunctionNode& node, const std::vector<double>& values) {
    std::vector<double> result;
    result.reserve(node.operands.size());
    for (const std::uint32_t operand : node.operands) result.push_back(values[operand]);
    return result;
  }

  std::vector<double> run(const Function& function, std::span<const double> arguments) {
    if (++depth_ > kMostDepth) throw NoValue{"more than 300 functions call each other"};
    std::vector<double> values;
    values.reserve(function.nodes.size());
    for (const FunctionNode& node : function.nodes) values.push_back(step(node, values, arguments));
    --depth_;
    return values;
  }

  void count(std::uint64_t steps) {
    steps_ += steps;
    if (steps_ > most_steps_)
      throw NoValue{"the scene takes more than " + std::to_string(most_steps_) + " steps"};
  }

  double step(const FunctionNode& node, const std::vector<double>& values,
              std::span<const double> arguments) {
    count(1 + node.operands.size() / 4);
    switch (node.op) {
      case FunctionNode::Op::constant:
        return node.number;
      case FunctionNode::Op::parameter:
        return arguments[node.index];
      case FunctionNode::Op::call:
        return call(node, values);
      case FunctionNode::Op::internal:
        return internal(node, operands(node, values));
      case FunctionNode::Op::user:
        return run(*node.function, operands(node, values)).back();
      default:
        return components(node, operands(node, values)).v[node.index];
    }
  }

  double call(const FunctionNode& node, const std::vector<double>& values) {
    const auto at = [&](std::size_t i) { return values[node.operands[i]]; };
    if (node.function != nullptr) return loop(node, values);
    if (const NumericFunction* numeric = find_numeric(node.name))
      return numeric->value(operands(node, values));
    if (node.name == "neg") return -at(0);
    if (node.name == "!") return at(0) == 0;
    switch (node.name[0]) {
      case '+':
        return at(0) + at(1);
      case '-':
        return at(0) - at(1);
      case '*':
        return at(0) * at(1);
      case '/':
        return at(0) / at(1);
      case '&':
        return at(0) != 0 && at(1) != 0;
      case '|':
        return at(0) != 0 || at(1) != 0;
      case '=':
        return at(0) == at(1);
      case '!':
        return at(0) != at(1);
      case '<':
        return node.name.size() == 1 ? at(0) < at(1) : at(0) <= at(1);
      default:
        return node.name.size() == 1 ? at(0) > at(1) : at(0) >= at(1);
    }
  }

  double loop(const FunctionNode& node, const std::vector<double>& values) {
    std::vector<double> arguments = operands(node, values);
    const double last = arguments[1];
    arguments.erase(arguments.begin());
    const bool is_sum = node.name == "sum";
    double result = is_sum ? 0 : 1;
    for (double counter = values[node.operands[0]]; counter <= last; ++counter) {
      if (counter + 1 == counter) throw NoValue{"a loop of a function has no end"};
      arguments[0] = counter;
      const double value = run(*node.function, arguments).back();
      result = is_sum ? result + value : result * value;
    }
    return result;
  }

  /// Counts what the last answer took.
  void count_answer() {
    if (queries_ != nullptr) count(queries_->take_steps());
  }

  double internal(const FunctionNode& node, std::span<const double> arguments) {
    const auto value = queries_ ? queries_->internal(node.index, arguments) : std::nullopt;
    count_answer();
    if (!value)
      throw NoValue{"the internal function " + std::to_string(node.index) +
                    " has no value while a scene is read"};
    return *value;
  }

  Numbers components(const FunctionNode& node, const std::vector<double>& operands) {
    if (node.op == FunctionNode::Op::spline) {
      count(steps_of(*node.spline));
      return {evaluate(*node.spline, operands[0]), static_cast<std::uint8_t>(node.spline->size), false};
    }
    const ObjectQueries::Point point{operands[0], operands[1], operands[2]};
    if (node.op == FunctionNode::Op::transform) {
      TransformEvaluation transform(document_);
      const Matrix m = transform.value(*node.block);
      count(transform.elements());
      Numbers result;
      result.size = 3;
      for (std::size_t i = 0; i < 3; ++i)
        result.v[i] = point[0] * m[0][i] + point[1] * m[1][i] + point[2] * m[2][i] + m[3][i];
      return result;
    }
    if (node.block->keyword == "pigment") {
      const auto color = queries_ ? queries_->pigment(node.block, point) : std::nullopt;
      count_answer();
      if (!color) throw NoValue{"pigments have no values while a scene is read"};
      return {*color, 5, true};
    }
    const auto value = queries_ ? queries_->pattern(node.block, point) : std::nullopt;
    count_answer();
    if (!value) throw NoValue{"patterns have no values while a scene is read"};
    return {{*value}, 1, false};
  }

  ObjectQueries* queries_;
  std::uint64_t& steps_;
  std::uint64_t most_steps_;
  const Document& document_;
  int depth_ = 0;
};

}  // namespace

bool has_components(const Function& function) { return function.components > 1; }

std::uint64_t steps_of(const Spline& spline) {
  return 1 + (spline.kind == Spline::Kind::natural ? spline.points.size() / 2 : 0);
}

bool spline_kind(Keyword keyword, Spline::Kind& kind) {
  switch (keyword) {
    case "linear_spline"_kw:
      kind = Spline::Kind::linear;
      return true;
    case "quadratic_spline"_kw:
      kind = Spline::Kind::quadratic;
      return true;
    case "cubic_spline"_kw:
      kind = Spline::Kind::cubic;
      return true;
    case "natural_spline"_kw:
      kind = Spline::Kind::natural;
      return true;
    default:
      return false;
  }
}

Numbers FunctionCaller::call(const Function& function, std::span<const double> arguments) const {
  try {
    return Evaluation(interpreter_.options_.queries, interpreter_.steps_, interpreter_.limits_.steps,
                      interpreter_.document_)
        .value(function, arguments);
  } catch (const NoValue& problem) {
    interpreter_.fail(where_, problem.message);
  }
}

double evaluate(const Function& function, std::span<const double> arguments, ObjectQueries* queries,
                std::uint64_t most_steps) {
  std::uint64_t steps = 0;
  const Document document;
  try {
    return Evaluation(queries, steps, most_steps, document).value(function, arguments).v[0];
  } catch (const NoValue& problem) {
    throw Error(problem.message);
  }
}

/// The second derivatives at the points of a natural spline, for one component.
static std::vector<double> curvatures(const std::vector<Spline::Point>& points, std::size_t component) {
  const std::size_t n = points.size();
  std::vector<double> second(n, 0.0), right(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = points[i].at - points[i - 1].at, behind = points[i + 1].at - points[i].at;
    const double share = before / (before + behind), pivot = share * second[i - 1] + 2;
    const double slope = (points[i + 1].value[component] - points[i].value[component]) / behind -
                         (points[i].value[component] - points[i - 1].value[component]) / before;
    second[i] = (share - 1) / pivot;
    right[i] = (6 * slope / (before + behind) - share * right[i - 1]) / pivot;
  }
  std::vector<double> result(n, 0.0);
  for (std::size_t i = n - 1; i-- > 1;) result[i] = second[i] * result[i + 1] + right[i];
  return result;
}

std::array<double, 5> evaluate(const Spline& spline, double at) {
  const std::vector<Spline::Point>& points = spline.points;
  const std::size_t n = points.size();
  if (n == 0) return {};
  const bool cubic = spline.kind == Spline::Kind::cubic && n > 2;
  if (cubic && at <= points[1].at) return points[1].value;
  if (cubic && at >= points[n - 2].at) return points[n - 2].value;
  if (!(at > points.front().at) || n == 1) return points.front().value;
  if (at >= points.back().at) return points.back().value;
  const auto behind =
      std::upper_bound(points.begin(), points.end(), at,
                       [](double value, const Spline::Point& point) { return value < point.at; });
  const auto i = static_cast<std::size_t>(behind - points.begin()) - 1;
  const Spline::Point &p = points[i], &q = points[i + 1];
  const double width = q.at - p.at, u = (at - p.at) / width;
  std::array<double, 5> result{};
  for (std::size_t c = 0; c < 5; ++c) {
    const double a = p.value[c], b = q.value[c];
    const auto slope = [&](std::size_t k) {
      return (points[k + 1].value[c] - points[k].value[c]) / (points[k + 1].at - points[k].at);
    };
    double value = a + u * (b - a);
    if (spline.kind == Spline::Kind::quadratic && n > 2) {
      // Through three points: of the interval and the one before, or the first three.
      const std::size_t first = i == 0 ? 0 : i - 1;
      value = 0;
      for (std::size_t k = first; k < first + 3; ++k) {
        double weight = 1;
        for (std::size_t l = first; l < first + 3; ++l)
          if (l != k) weight *= (at - points[l].at) / (points[k].at - points[l].at);
        value += weight * points[k].value[c];
      }
    } else if (cubic) {
      const double start = width * 0.5 * (slope(i - 1) + slope(i)),
                   end = width * 0.5 * (slope(i) + slope(i + 1));
      const double v = 1 - u;
      value = v * v * (1 + 2 * u) * a + u * u * (3 - 2 * u) * b + u * v * v * start - u * u * v * end;
    } else if (spline.kind == Spline::Kind::natural && n > 2) {
      const std::vector<double> second = curvatures(points, c);
      const double v = 1 - u;
      value += ((v * v * v - v) * second[i] + (u * u * u - u) * second[i + 1]) * width * width / 6;
    }
    result[c] = value;
  }
  return result;
}

Matrix evaluate_transform(const Block& block, const Document& document) {
  return TransformEvaluation(document).value(block);
}

}  // namespace oktett::pov
