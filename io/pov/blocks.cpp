#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "io/pov/evaluate.h"
#include "io/pov/interpreter.h"
#include "io/pov/numeric.h"

namespace oktett::pov {

void Interpreter::add(std::vector<Element>& elements, const Place& where, Value value) {
  count_values(where, 1);
  elements.push_back({where, std::move(value)});
}

/// Numbers and vectors of plain numbers with commas between them, as meshes list them by the million: as the
/// rest would read them, only faster. Whether it read any.
bool Interpreter::take_plain_numbers(std::vector<Element>& elements) {
  if (!pending_.empty()) return false;
  bool any = false;
  const char* const end = at_.source->end;
  const auto plain = [&](Cursor& at, double& x) {
    const bool negative = *at.p == '-';
    const char* const p = at.p + (negative ? 1 : 0);
    if (!is_digit(*p) && !(*p == '.' && is_digit(p[1]))) return false;
    at.p = scan_number(p, end, x);
    if (negative) x = -x;
    skip_space(at);
    return true;
  };
  try {
    for (;;) {
      skip_space(at_);
      Cursor at = at_;
      Place where = at.place();
      where.call = call_;
      Numbers value;
      if (*at.p == '<') {
        ++at.p;
        std::uint8_t size = 0;
        for (;; ++size) {
          skip_space(at);
          if (size == 5 || !plain(at, value.v[size])) return any;
          if (*at.p == '>') break;
          if (*at.p != ',') return any;
          ++at.p;
        }
        if (size == 0) return any;
        value.size = static_cast<std::uint8_t>(size + 1);
        ++at.p;
        skip_space(at);
      } else if (!plain(at, value.v[0])) {
        return any;
      }
      const char c = *at.p;
      if (c != ',' && c != '}' && c != '<' && c != ']') return any;
      if (c == ',') ++at.p;
      at_ = at;
      add(elements, where, value);
      any = true;
      // Lists of meshes say how long they are. No element takes fewer than two characters.
      constexpr double least = 64;
      if (elements.size() == 1 && value.size == 1 && value.v[0] >= least &&
          value.v[0] < static_cast<double>(end - at.p) / 2 &&
          value.v[0] < static_cast<double>(limits_.values - values_))
        elements.reserve(static_cast<std::size_t>(value.v[0]) + 1);
    }
  } catch (const LexError& error) {
    fail(error.where.place(), error.message);
  }
}

void Interpreter::parse_elements(std::vector<Element>& elements, const Token& opening, char closing,
                                 std::uint32_t& depth) {
  const Hold outer = hold_;
  hold_ = {};
  for (;;) {
    take_plain_numbers(elements);
    if (take_if(closing)) break;
    if (take_if(',')) continue;
    const Token& next = peek();
    if (next.is(closing)) continue;
    if (next.kind == Token::Kind::end)
      fail(opening.where, "this block has no '" + std::string(1, closing) + "'");
    parse_element(elements, depth);
  }
  hold_ = outer;
}

/// The union that an element of a union stands for, if it is no more than its objects; else null.
static const Block* plain_union(const Element& e) {
  const auto* held = std::get_if<BlockPtr>(&e.value);
  while (held != nullptr && *held != nullptr && (*held)->keyword == "object" && (*held)->elements.size() == 1)
    held = std::get_if<BlockPtr>(&(*held)->elements[0].value);
  if (held == nullptr || *held == nullptr || (*held)->keyword != "union") return nullptr;
  constexpr std::array<std::string_view, 10> kModifiers{
      "texture",          "pigment",  "normal",     "finish",     "interior",
      "interior_texture", "material", "clipped_by", "bounded_by", "photons"};
  const bool is_plain = std::ranges::all_of((*held)->elements, [&](const Element& part) {
    const auto* const block = std::get_if<BlockPtr>(&part.value);
    return block != nullptr && *block != nullptr &&
           std::ranges::find(kModifiers, (*block)->keyword) == kModifiers.end();
  });
  return is_plain ? held->get() : nullptr;
}

/// Unions nest so deeply until their parts are put in place of them.
static constexpr std::uint32_t kDeepUnion = 256;

/// Adds an element of a union, or the parts of the union that it stands for, as far as these nest deeply.
static void splice(const Element& e, std::vector<Element>& flat) {
  const Block* const inner = plain_union(e);
  if (inner == nullptr || inner->depth < kDeepUnion) return flat.push_back(e);
  for (const Element& part : inner->elements) splice(part, flat);
}

/// Loops add to a union by declaring it again as one of itself and another object. Returns how many blocks
/// nest in `all` when the parts stand in it themselves.
std::uint32_t Interpreter::flatten_union(Block& all, const Place& where) {
  std::vector<Element> flat;
  for (const Element& e : all.elements) splice(e, flat);
  count_step(where, flat.size());
  all.elements = std::move(flat);
  std::uint32_t depth = 0;
  for (const Element& e : all.elements)
    if (const auto* const block = std::get_if<BlockPtr>(&e.value); block != nullptr && *block != nullptr)
      depth = std::max(depth, (*block)->depth);
  return depth;
}

/// A block whose opening brace was read.
std::shared_ptr<Block> Interpreter::parse_block(const Token& keyword, std::uint32_t& depth) {
  const Level level(*this, keyword.where);
  count_values(keyword.where, 3);  // it takes as much memory
  auto block = std::make_shared<Block>();
  block->keyword = keyword.kind == Token::Kind::word ? kKeywords[keyword.name->keyword] : "[";
  block->where = keyword.where;
  block->default_texture = default_texture_;
  std::uint32_t inner = 0;
  parse_elements(block->elements, keyword, keyword.kind == Token::Kind::word ? '}' : ']', inner);
  if (inner >= 2 * kDeepUnion && block->keyword == "union") inner = flatten_union(*block, keyword.where);
  block->depth = deeper(inner, keyword.where);
  depth = std::max(depth, block->depth);
  // An entry of a map without a number, as `average` may have, has the weight 1.
  if (block->keyword == "[" && !block->elements.empty() &&
      !std::holds_alternative<Numbers>(block->elements[0].value)) {
    count_values(keyword.where, 1);
    block->elements.insert(block->elements.begin(), {block->elements[0].where, number(1)});
  }
  if (block->elements.capacity() > 2 * block->elements.size()) block->elements.shrink_to_fit();
  return block;
}

Datum Interpreter::parse_block_value(const Token& keyword) {
  expect('{', "before a block");
  Datum datum;
  datum.value = BlockPtr(parse_block(keyword, datum.depth));
  return datum;
}

void Interpreter::parse_element(std::vector<Element>& elements, std::uint32_t& depth) {
  const Token token = peek();
  const Place where = token.where;
  if (token.kind == Token::Kind::sign) {
    if (token.sign == '[') {
      take();
      add(elements, where, BlockPtr(parse_block(token, depth)));
      return;
    }
    if (token.sign == '<') {
      std::vector<Numbers> list;
      const Numbers value = parse_postfix(parse_vector(&list));
      if (!list.empty()) {
        auto block = std::make_shared<Block>();
        block->keyword = "<", block->where = where;
        for (const Numbers& x : list) block->elements.push_back({where, x});
        add(elements, where, BlockPtr(std::move(block)));
        return;
      }
      term_ = value;
    } else if (token.sign != '(' && token.sign != '-' && token.sign != '+' && token.sign != '!') {
      fail_expected("a value or a keyword", token);
    }
    Numbers value = parse_sum();
    while (value.is_color && add_channel(value)) {}
    add(elements, where, value);
    return;
  }
  if (token.kind == Token::Kind::word && token.keyword() != kNoKeyword) {
    take();
    // Of a gamma `srgb` is the kind, else it begins a colour.
    if (token.keyword() == "srgb"_kw && !elements.empty()) {
      const auto* const before = std::get_if<Word>(&elements.back().value);
      if (before != nullptr && (before->text == "gamma" || before->text == "assumed_gamma")) {
        add(elements, where, Word{kKeywords[token.keyword()]});
        return;
      }
    }
    // The names of functions are words too: `julia_fractal { ... sqr }`.
    const bool is_call = find_numeric(kKeywords[token.keyword()]) == nullptr || next_is('(');
    if (is_call && starts_value(token)) {
      push_back(token);
      add_value(elements, token, depth);
      return;
    }
    if (token.keyword() == "pwr"_kw && next_is('(')) {
      add(elements, where, Word{kKeywords[token.keyword()]});
      for (const double x : parse_arguments()) add(elements, where, number(x));
      return;
    }
    if (token.keyword() == "function"_kw && !next_is('{') && !next_is('(')) {
      // `function WIDTH, HEIGHT { ... }` is a picture.
      add(elements, where, Word{kKeywords[token.keyword()]});
      add(elements, where, parse_sum());
      skip_comma();
      add(elements, where, parse_sum());
    } else if (token.keyword() != "function"_kw && token.keyword() != "spline"_kw) {
      if (!next_is('{')) {
        add(elements, where, Word{kKeywords[token.keyword()]});
        return;
      }
      take();
      add(elements, where, BlockPtr(parse_block(token, depth)));
      return;
    }
    const Datum datum = token.keyword() == "spline"_kw ? parse_spline(token) : parse_function(token);
    depth = std::max(depth, datum.depth);
    if (const SplinePtr* spline = datum.get<SplinePtr>()) add(elements, where, *spline);
    if (const FunctionPtr* function = datum.get<FunctionPtr>()) add(elements, where, *function);
    return;
  }
  add_value(elements, token, depth);
}

void Interpreter::add_value(std::vector<Element>& elements, const Token& token, std::uint32_t& depth) {
  const Place where = token.where;
  Datum datum = parse_value();
  depth = std::max(depth, datum.depth);
  if (Numbers* value = std::get_if<Numbers>(&datum.value)) {
    while (value->is_color && add_channel(*value)) {}
    add(elements, where, *value);
  } else if (std::string* text = std::get_if<std::string>(&datum.value)) {
    add(elements, where, std::move(*text));
  } else if (const BlockPtr* block = datum.get<BlockPtr>()) {
    add(elements, where, *block);
  } else if (const FunctionPtr* function = datum.get<FunctionPtr>()) {
    add(elements, where, *function);
  } else if (const SplinePtr* spline = datum.get<SplinePtr>()) {
    add(elements, where, *spline);
  } else {
    fail_expected("a value or a keyword", token);
  }
}

/// Whether an expression, a string or a declared value starts here, and not a word or a block.
bool Interpreter::starts_value(const Token& token) const {
  const Keyword keyword = token.keyword();
  if (keyword == kNoKeyword || is_color_keyword(keyword) || is_string_keyword(keyword)) return true;
  switch (keyword) {
    case "x"_kw:
    case "y"_kw:
    case "z"_kw:
    case "t"_kw:
    case "u"_kw:
    case "v"_kw:
    case "pi"_kw:
    case "on"_kw:
    case "yes"_kw:
    case "true"_kw:
    case "off"_kw:
    case "no"_kw:
    case "false"_kw:
    case "clock"_kw:
    case "clock_on"_kw:
    case "version"_kw:
    case "now"_kw:
    case "asc"_kw:
    case "defined"_kw:
    case "dimensions"_kw:
    case "dimension_size"_kw:
    case "file_exists"_kw:
    case "inside"_kw:
    case "min_extent"_kw:
    case "max_extent"_kw:
    case "trace"_kw:
    case "rand"_kw:
    case "seed"_kw:
    case "strcmp"_kw:
    case "strlen"_kw:
    case "val"_kw:
    case "vdot"_kw:
    case "vlength"_kw:
    case "vcross"_kw:
    case "vnormalize"_kw:
    case "vrotate"_kw:
    case "vaxis_rotate"_kw:
    case "vturbulence"_kw:
      return true;
    default:
      return find_numeric(kKeywords[keyword]) != nullptr;
  }
}

Datum Interpreter::parse_value() {
  const Token token = peek();
  Datum datum;
  const Keyword keyword = token.keyword();
  if (token.kind == Token::Kind::string || is_string_keyword(keyword)) {
    datum.value = parse_string();
    return datum;
  }
  if (token.kind == Token::Kind::word && keyword == kNoKeyword) {
    take();
    const Reference reference = access(token);
    const Datum& found = value_of(reference, token);
    if (const std::string* text = found.get<std::string>()) check_length(text->size(), token.where);
    const Datum kept = found;
    return value_behind(kept, token);
  }
  if (is_color_keyword(keyword)) {
    take();
    datum.value = parse_color(token);
    return datum;
  }
  if (keyword != kNoKeyword && !starts_value(token)) {
    take();
    if (keyword == "function"_kw) return parse_function(token);
    if (keyword == "spline"_kw) return parse_spline(token);
    if (keyword == "array"_kw) return parse_array(token);
    if (!next_is('{')) fail_expected("a value", token);
    return parse_block_value(token);
  }
  datum.value = parse_sum();
  return datum;
}

Datum Interpreter::value_behind(const Datum& datum, const Token& name) {
  const bool is_called = (datum.get<FunctionPtr>() || datum.get<SplinePtr>()) && next_is('(');
  if (!is_called && datum.get<Numbers>() == nullptr) return datum;
  term_ = call_value(datum, name);
  Datum result;
  result.value = parse_sum();
  return result;
}

Datum Interpreter::parse_spline(const Token& keyword) {
  const Level level(*this, keyword.where);
  const Hold outer = hold_;
  hold_ = {};
  expect('{', "behind spline");
  auto spline = std::make_shared<Spline>();
  spline->kind = Spline::Kind::linear;
  spline->size = 2;
  while (!take_if('}')) {
    const Token token = peek();
    if (token.kind == Token::Kind::end) fail(keyword.where, "this block has no '}'");
    if (take_if(',') || (token.keyword() != kNoKeyword && spline_kind(token.keyword(), spline->kind))) {
      if (!token.is(',')) take();
      continue;
    }
    if (token.kind == Token::Kind::word && token.keyword() == kNoKeyword) {
      take();
      const Reference reference = access(token);
      const Datum datum = value_of(reference, token);
      if (const SplinePtr* other = datum.get<SplinePtr>()) {
        count_values(token.where, (*other)->points.size());
        *spline = **other;
        continue;
      }
      term_ = call_value(datum, token);
    }
    Spline::Point point{to_float(parse_sum(), token.where), {}};
    skip_comma();
    const Numbers value = parse_sum();
    point.value = value.v;
    if (value.size == 1) point.value[1] = value.v[0];
    spline->size = std::max(spline->size, static_cast<int>(value.size));
    count_values(token.where, 1);
    spline->points.push_back(point);
  }
  hold_ = outer;
  if (std::ranges::any_of(spline->points, [](const Spline::Point& p) { return p.at != p.at; }))
    fail(keyword.where, "a point of this spline has no place");
  // Of points at the same place the last one counts, but the point that is farthest so far stays.
  std::map<double, Spline::Point> at;
  for (const Spline::Point& point : spline->points)
    if (const auto [old, added] = at.try_emplace(point.at, point);
        !added && (at.size() == 1 || std::next(old) != at.end()))
      old->second = point;
  spline->points.clear();
  for (const auto& [place, point] : at) spline->points.push_back(point);
  Datum datum;
  datum.value = SplinePtr(std::move(spline));
  return datum;
}

/// `array[2][3] { ... }`, or `array { ... }` with as many elements as are listed.
Datum Interpreter::parse_array(const Token& keyword) {
  const Level level(*this, keyword.where);
  const Hold outer = hold_;
  hold_ = {};
  std::vector<std::size_t> sizes;
  double count = 1;
  while (next_is('[')) {
    take();
    const Place where = peek().where;
    const double size = parse_float();
    if (!(size >= 1)) fail(where, "expected a size of at least 1");
    count *= std::floor(size);
    if (!(count + static_cast<double>(array_count_->living) <= static_cast<double>(limits_.array_elements)))
      fail(where, "arrays have more than " + std::to_string(limits_.array_elements) + " elements");
    sizes.push_back(static_cast<std::size_t>(size));
    expect(']', "behind the size of an array");
  }
  Datum datum;
  datum.depth = deeper(0, keyword.where);
  std::shared_ptr<Array> array;
  if (sizes.empty()) {
    expect('{', "behind array");
    array = std::make_shared<Array>(sizes, 0, array_count_);
    while (!take_if('}')) {
      Datum element = parse_value();
      datum.depth = std::max(datum.depth, deeper(element.depth, keyword.where));
      array->append(std::move(element));
      if (array_count_->living > limits_.array_elements)
        fail(keyword.where, "arrays have more than " + std::to_string(limits_.array_elements) + " elements");
      skip_comma();
    }
    array->sizes = {array->elements.size()};
  } else {
    array = std::make_shared<Array>(sizes, static_cast<std::size_t>(count), array_count_);
    count_step(keyword.where, array->elements.size() / 4);
    std::size_t next = 0;
    if (next_is('{')) fill_array(*array, 0, next, datum.depth);
  }
  hold_ = outer;
  datum.value = std::move(array);
  return datum;
}

void Interpreter::fill_array(Array& array, std::size_t dimension, std::size_t& next, std::uint32_t& depth) {
  const Level level(*this, peek().where);
  expect('{', "before the elements of an array");
  std::size_t stride = 1;
  for (std::size_t i = dimension + 1; i < array.sizes.size(); ++i) stride *= array.sizes[i];
  const std::size_t first = next;
  for (std::size_t i = 0; !take_if('}'); ++i) {
    if (i == array.sizes[dimension])
      fail_expected("'}', as the array has " + std::to_string(i) + " elements here", peek());
    next = first + i * stride;
    const Place where = peek().where;
    if (dimension + 1 < array.sizes.size()) {
      fill_array(array, dimension + 1, next, depth);
    } else {
      Datum element = parse_value();
      depth = std::max(depth, deeper(element.depth, where));
      array.elements[next] = std::move(element);
    }
    skip_comma();
  }
  next = first + array.sizes[dimension] * stride;
}

}  // namespace oktett::pov
