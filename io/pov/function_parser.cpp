#include <algorithm>
#include <numbers>

#include "io/pov/evaluate.h"
#include "io/pov/interpreter.h"
#include "io/pov/numeric.h"

namespace oktett::pov {

/// Makes the tree of one function from its text. What is known already, such as a declared number, becomes a
/// constant.
class FunctionParser {
 public:
  FunctionParser(Interpreter& interpreter, Function& function, std::uint32_t& depth)
      : in_(interpreter), function_(function), depth_(depth) {}

  /// From the parameters to the closing brace.
  void parse() {
    if (in_.take_if('(')) {
      for (;;) {
        const Token token = in_.take();
        if (token.is(')')) break;
        if (token.is(',')) continue;
        if (token.kind != Token::Kind::word) in_.fail_expected("the name of a parameter", token);
        if (function_.parameters.size() == kMostParameters)
          in_.fail(token.where, "more than " + std::to_string(kMostParameters) + " parameters of a function");
        function_.parameters.push_back(token.name->text);
      }
    } else {
      function_.parameters = {"x", "y", "z"};
      is_default_ = true;
    }
    in_.expect('{', "before the text of a function");
    if (!parse_special()) finish(parse_logic());
    in_.expect('}', "behind a function");
  }

  /// The value of a loop: `sum` and `prod` make a function of it.
  void parse_body(const std::vector<std::string>& parameters, bool is_default) {
    function_.parameters = parameters;
    is_default_ = is_default;
    finish(parse_logic());
  }

 private:
  using Op = FunctionNode::Op;
  using Index = std::uint32_t;
  static constexpr std::size_t kMostParameters = 256;

  Index add(FunctionNode node) {
    in_.count_values(function_.where, 2 + node.operands.size() / 8);  // it takes as much memory
    function_.nodes.push_back(std::move(node));
    return static_cast<Index>(function_.nodes.size() - 1);
  }
  Index constant(double number) {
    FunctionNode node;
    node.number = number;
    return add(std::move(node));
  }
  Index parameter(std::size_t index) {
    known_parameters_.resize(function_.parameters.size());
    std::optional<Index>& known = known_parameters_[index];
    if (known) return *known;
    FunctionNode node;
    node.op = Op::parameter;
    node.index = static_cast<Index>(index);
    known = add(std::move(node));
    return *known;
  }
  Index call(std::string_view name, std::vector<Index> operands) {
    FunctionNode node;
    node.op = Op::call;
    node.name = name;
    node.operands = std::move(operands);
    return add(std::move(node));
  }

  /// Pigments, patterns, splines, transforms and the functions of the program itself.
  bool parse_special() {
    const Keyword keyword = in_.peek().keyword();
    FunctionNode node;
    if (keyword == "internal"_kw) {
      in_.take();
      in_.expect('(', "behind internal");
      const Place where = in_.peek().where;
      const double number = in_.parse_float();
      if (!(number >= 0 && number < 1000)) in_.fail(where, "expected the number of an internal function");
      in_.expect(')', "behind the number of an internal function");
      node.op = Op::internal;
      node.index = static_cast<Index>(number);
      function_.parameters.clear();
      add(std::move(node));
      return true;
    }
    if (keyword == "spline"_kw) {
      const Token token = in_.take();
      if (is_default_) function_.parameters = {"x"};
      if (function_.parameters.empty()) in_.fail(token.where, "a function of a spline takes a parameter");
      const Datum spline = in_.parse_spline(token);
      node.op = Op::spline;
      node.spline = *spline.get<SplinePtr>();
      function_.components = static_cast<std::uint8_t>(node.spline->size);
      node.operands = {parameter(0)};
      add(std::move(node));
      return true;
    }
    if (keyword != "pigment"_kw && keyword != "pattern"_kw && keyword != "transform"_kw) return false;
    const Token token = in_.take();
    node.op = keyword == "transform"_kw ? Op::transform : Op::pattern;
    in_.expect('{', "before its text");
    node.block = in_.parse_block(token, depth_);
    if (function_.parameters.size() < 3)
      in_.fail(token.where, "a function of " + in_quotes(token.name->text) + " takes three parameters");
    if (keyword == "transform"_kw) function_.components = 3;
    if (keyword == "pigment"_kw) function_.components = 5;
    node.operands = {parameter(0), parameter(1), parameter(2)};
    add(std::move(node));
    return true;
  }

  Index parse_logic() {
    Index value = parse_and();
    while (in_.peek().is('|')) {
      in_.take();
      value = call("|", {value, parse_and()});
    }
    return value;
  }

  Index parse_and() {
    Index value = parse_comparison();
    while (in_.peek().is('&')) {
      in_.take();
      value = call("&", {value, parse_comparison()});
    }
    return value;
  }

  Index parse_comparison() {
    Index value = parse_sum();
    for (;;) {
      const Token& token = in_.peek();
      std::string_view name = token.is('<')   ? "<"
                              : token.is('>') ? ">"
                              : token.is('=') ? "="
                              : token.is('!') ? "!="
                                              : "";
      if (name.empty()) return value;
      in_.take();
      const bool or_equal = name != "=" && in_.take_if('=');
      if (name == "!=" && !or_equal) in_.fail_expected("'=' behind '!'", in_.peek());
      if (or_equal) name = name == "<" ? "<=" : name == ">" ? ">=" : name;
      value = call(name, {value, parse_sum()});
    }
  }

  Index parse_sum() {
    Index value = parse_product();
    for (;;) {
      const bool minus = in_.peek().is('-');
      if (!minus && !in_.peek().is('+')) return value;
      in_.take();
      value = call(minus ? "-" : "+", {value, parse_product()});
    }
  }

  Index parse_product() {
    Index value = parse_factor();
    for (;;) {
      const bool divided = in_.peek().is('/');
      if (!divided && !in_.peek().is('*')) return value;
      in_.take();
      value = call(divided ? "/" : "*", {value, parse_factor()});
    }
  }

  Index parse_factor() {
    bool negative = false;
    while (in_.peek().is('+') || in_.peek().is('-')) negative ^= in_.take().sign == '-';
    if (in_.peek().is('!')) {
      in_.take();
      const Index value = call("!", {parse_term()});
      return negative ? call("neg", {value}) : value;
    }
    const bool is_number = in_.peek().kind == Token::Kind::number;
    const Index value = parse_term();
    if (!negative) return value;
    if (is_number && function_.nodes[value].op == Op::constant) {
      function_.nodes[value].number = -function_.nodes[value].number;
      return value;
    }
    return call("neg", {value});
  }

  std::vector<Index> parse_arguments() {
    const Interpreter::Level level(in_, in_.peek().where);
    std::vector<Index> arguments;
    in_.expect('(', "before the values of a function");
    while (!in_.take_if(')')) {
      arguments.push_back(parse_logic());
      if (!in_.take_if(',') && !in_.peek().is(')')) in_.fail_expected("',' or ')'", in_.peek());
    }
    return arguments;
  }

  Index parse_term() {
    const Token token = in_.take();
    if (token.kind == Token::Kind::number) return constant(token.number);
    if (token.is('(')) {
      const Interpreter::Level level(in_, token.where);
      const Index value = parse_logic();
      in_.expect(')', "in a function");
      return value;
    }
    if (token.kind != Token::Kind::word) in_.fail_expected("a number, a parameter or a function", token);
    const std::string& text = token.name->text;
    const auto found = std::ranges::find(function_.parameters, text);
    if (found != function_.parameters.end())
      return parameter(static_cast<std::size_t>(found - function_.parameters.begin()));
    // The functions of a parametric surface have these two, without a list.
    if (is_default_ && (text == "u" || text == "v")) return parameter(text == "u" ? 0 : 1);
    if (token.name->keyword != kNoKeyword) return parse_keyword(token);
    if (token.name->bindings.empty()) {
      std::vector<std::string> known = in_.names_.declared();
      known.insert(known.end(), function_.parameters.begin(), function_.parameters.end());
      in_.fail(token.where, "the function has no parameter " + in_quotes(text) +
                                ", and nothing is declared by this name" + similar(text, known));
    }
    const Reference reference = in_.access(token);
    const Datum datum = in_.value_of(reference, token);
    if (const FunctionPtr* function = datum.get<FunctionPtr>()) {
      depth_ = std::max(depth_, in_.deeper(datum.depth, token.where));
      return call_function(token, *function);
    }
    if (const SplinePtr* spline = datum.get<SplinePtr>()) {
      FunctionNode node;
      node.op = Op::spline;
      node.spline = *spline;
      return components(token, node, parse_arguments(), 1, static_cast<std::uint8_t>((*spline)->size));
    }
    if (const Numbers* value = datum.get<Numbers>()) {
      const Numbers number = in_.parse_postfix(*value);
      return constant(in_.to_float(number, token.where));
    }
    in_.fail_expected("a number, a parameter or a function", token);
  }

  Index parse_keyword(const Token& token) {
    const std::string& text = token.name->text;
    const NumericFunction* const numeric = find_numeric(text);
    if (numeric != nullptr && in_.next_is('(')) {
      std::vector<Index> arguments = parse_arguments();
      if (arguments.size() < numeric->least || arguments.size() > numeric->most)
        in_.fail(token.where, in_quotes(text) + " takes " + std::to_string(numeric->least) +
                                  (numeric->most > numeric->least ? " or more" : "") + " values, found " +
                                  std::to_string(arguments.size()));
      return call(numeric->name, std::move(arguments));
    }
    switch (token.name->keyword) {
      case "sum"_kw:
      case "prod"_kw:
        return parse_loop(token);
      case "x"_kw:
      case "y"_kw:
      case "z"_kw:
      case "t"_kw:
      case "u"_kw:
      case "v"_kw:
        in_.fail(token.where, in_quotes(text) + " is no parameter of this function");
      case "rand"_kw:
      case "seed"_kw:
      case "inside"_kw:
        in_.fail_expected("a number, a parameter or a function", token);
      default:
        break;
    }
    if (const std::optional<Numbers> value = in_.parse_builtin(token))
      return constant(in_.to_float(in_.parse_postfix(*value), token.where));
    in_.fail_expected("a number, a parameter or a function", token);
  }

  /// `sum(i, first, last, value)`: a call of a function with the counter before the parameters of this one.
  Index parse_loop(const Token& token) {
    const Interpreter::Level level(in_, token.where);
    in_.expect('(', "behind a loop");
    const Token counter = in_.take();
    if (counter.kind != Token::Kind::word) in_.fail_expected("the name of a counter", counter);
    in_.skip_comma();
    const Index first = parse_logic();
    in_.skip_comma();
    const Index last = parse_logic();
    in_.skip_comma();
    auto body = std::make_shared<Function>();
    body->where = counter.where;
    std::vector<std::string> parameters{counter.name->text};
    parameters.insert(parameters.end(), function_.parameters.begin(), function_.parameters.end());
    FunctionParser(in_, *body, depth_).parse_body(parameters, false);
    in_.expect(')', "behind a loop");
    FunctionNode node;
    node.op = Op::call;
    node.name = token.keyword() == "sum"_kw ? "sum" : "prod";
    node.function = std::move(body);
    node.operands = {first, last};
    for (std::size_t i = 0; i < function_.parameters.size(); ++i) node.operands.push_back(parameter(i));
    return add(std::move(node));
  }

  Index call_function(const Token& token, const FunctionPtr& function) {
    // Without values it gets the parameters of this one.
    std::vector<Index> arguments;
    if (in_.next_is('(')) {
      arguments = parse_arguments();
    } else {
      for (std::size_t i = 0; i < function->parameters.size() && i < function_.parameters.size(); ++i)
        arguments.push_back(parameter(i));
    }
    const FunctionNode& last = function->nodes.back();
    if (last.op == Op::internal && function->nodes.size() == 1) {
      FunctionNode node = last;
      node.operands = std::move(arguments);
      return add(std::move(node));
    }
    if (has_components(*function)) {
      return components(token, last, std::move(arguments), function->parameters.size(), function->components);
    }
    if (arguments.size() != function->parameters.size())
      in_.fail(token.where, in_quotes(token.name->text) + " takes " +
                                std::to_string(function->parameters.size()) + " values, found " +
                                std::to_string(arguments.size()));
    FunctionNode node;
    node.op = Op::user;
    node.function = function;
    node.operands = std::move(arguments);
    return add(std::move(node));
  }

  /// A call with several results, and which of them `.x`, `.gray` and the like ask for.
  Index components(const Token& token, FunctionNode node, std::vector<Index> arguments, std::size_t count,
                   std::uint8_t size) {
    if (arguments.size() != count)
      in_.fail(token.where, in_quotes(token.name->text) + " takes " + std::to_string(count) +
                                " values, found " + std::to_string(arguments.size()));
    node.operands = std::move(arguments);
    int index = 0;
    if (in_.next_is('.')) {
      in_.take();
      const Token name = in_.take();
      index = name.kind == Token::Kind::word ? component_index(name.name->text) : -2;
      if (index == -2 || index >= size) in_.fail_expected("a component such as x or red behind '.'", name);
    }
    if (index >= 0) {
      node.index = static_cast<Index>(index);
      return add(std::move(node));
    }
    Index sum = 0;
    for (Index i = 0; i < 3; ++i) {
      node.index = i;
      const Index component = add(node);
      const Index part = call("*", {component, constant(kGray[i])});
      sum = i == 0 ? part : call("+", {sum, part});
    }
    return sum;
  }

  /// The result has to be the last node; one that several share need not be.
  void finish(Index value) {
    if (value + 1 == function_.nodes.size()) return;
    add(FunctionNode(function_.nodes[value]));
  }

  Interpreter& in_;
  Function& function_;
  std::uint32_t& depth_;
  bool is_default_ = false;
  std::vector<std::optional<Index>> known_parameters_;
};

Datum Interpreter::parse_function(const Token& keyword) {
  const Level level(*this, keyword.where);
  const Hold outer = hold_;
  hold_ = {};
  auto function = std::make_shared<Function>();
  function->where = keyword.where;
  std::uint32_t depth = 0;
  FunctionParser(*this, *function, depth).parse();
  hold_ = outer;
  Datum datum;
  datum.value = FunctionPtr(std::move(function));
  datum.depth = depth;
  return datum;
}

}  // namespace oktett::pov
