#include <algorithm>
#include <filesystem>
#include <numbers>

#include "io/pov/interpreter.h"
#include "io/text/files.h"

namespace oktett::pov {

Interpreter::Interpreter(const ReadOptions& options, Document& document)
    : options_(options), limits_(options.limits), document_(document) {
  const std::pair<const char*, double> variables[] = {{"clock_delta", options.clock_delta},
                                                      {"initial_clock", options.initial_clock},
                                                      {"final_clock", options.final_clock},
                                                      {"frame_number", options.frame_number},
                                                      {"initial_frame", options.initial_frame},
                                                      {"final_frame", options.final_frame},
                                                      {"image_width", options.image_width},
                                                      {"image_height", options.image_height},
                                                      {"tau", 2 * std::numbers::pi}};
  for (const auto& [name, value] : variables) {
    Datum datum;
    datum.value = Numbers{{value}, 1, false};
    names_.intern(name).bindings.push_back({0, {std::make_shared<Datum>(std::move(datum)), {}}});
  }
  for (const auto& [name, value] : options.definitions) {
    Datum datum;
    if (const double* number = std::get_if<double>(&value))
      datum.value = Numbers{{*number}, 1, false};
    else
      datum.value = std::get<std::string>(value);
    names_.intern(name).bindings.push_back({0, {std::make_shared<Datum>(std::move(datum)), {}}});
  }
}

void Interpreter::run(const std::string& path) {
  Datum name;
  name.value = std::filesystem::path(path).filename().string();
  names_.intern("input_file_name").bindings.push_back({0, {std::make_shared<Datum>(std::move(name)), {}}});
  enter_file(path, {});
  std::uint32_t depth = 0;
  while (peek().kind != Token::Kind::end) {
    if (take_if(',') || take_if(';')) continue;
    const Token& token = peek();
    const bool is_word = token.kind == Token::Kind::word;
    if (!is_word) fail_expected("an object or another statement", token);
    if (token.name->keyword == "default"_kw) {
      // As a directive, without its '#'.
      const Place where = take().where;
      set_default(where);
      continue;
    }
    parse_element(document_.statements, depth);
  }
}

void Interpreter::fail(const Place& where, const std::string& message) const {
  throw document_.error(where, message);
}

void Interpreter::fail_expected(const std::string& what, const Token& found) const {
  fail(found.where, "expected " + what + ", found " + describe(found));
}

void Interpreter::warn(const Place& where, const std::string& message) {
  constexpr std::size_t most = 1000;
  if (document_.warnings.size() < most) document_.warnings.push_back({document_.location(where), message});
}

void Interpreter::count_step(const Place& where, std::uint64_t count) {
  steps_ += count;
  if (steps_ > limits_.steps)
    fail(where, "the scene takes more than " + std::to_string(limits_.steps) + " steps");
}

void Interpreter::count_values(const Place& where, std::uint64_t count) {
  values_ += count;
  if (values_ > limits_.values) fail(where, "more than " + std::to_string(limits_.values) + " values");
}

Interpreter::Level::Level(Interpreter& interpreter, const Place& where) : interpreter_(interpreter) {
  if (interpreter.nesting_ >= interpreter.limits_.nesting)
    interpreter.fail(where, "more than " + std::to_string(interpreter.limits_.nesting) +
                                " blocks, parentheses and directives within each other");
  ++interpreter.nesting_;
}

std::uint32_t Interpreter::deeper(std::uint32_t depth, const Place& where) const {
  if (depth >= limits_.value_depth)
    fail(where, "more than " + std::to_string(limits_.value_depth) + " declared values within each other");
  return depth + 1;
}

const Token& Interpreter::peek() {
  if (pending_.empty()) pending_.push_back(fetch());
  return pending_.back();
}

Token Interpreter::take() {
  if (pending_.empty()) return fetch();
  const Token token = pending_.back();
  pending_.pop_back();
  return token;
}

void Interpreter::push_back(const Token& token) { pending_.push_back(token); }

Token Interpreter::take_written() {
  if (!pending_.empty()) return take();
  try {
    Token token;
    skip_space(at_);
    lex(at_, names_, token);
    token.where.call = call_;
    return token;
  } catch (const LexError& error) {
    Place where = error.where.place();
    where.call = call_;
    fail(where, error.message);
  }
}

bool Interpreter::next_is(char c) {
  if (!pending_.empty()) return pending_.back().is(c);
  try {
    skip_space(at_);
  } catch (const LexError& error) {
    fail(error.where.place(), error.message);
  }
  return *at_.p == c && !(c == '.' && is_digit(at_.p[1]));
}

bool Interpreter::take_if(char c) {
  if (pending_.empty() ? next_is('#') || next_is(c) || is_letter(*at_.p) : true) {
    if (!peek().is(c)) return false;
    pending_.pop_back();
    return true;
  }
  return false;
}

void Interpreter::expect(char c, const char* behind) {
  if (take_if(c)) return;
  fail_expected(in_quotes({&c, 1}) + " " + behind, peek());
}

bool Interpreter::ends_expression() {
  if (!pending_.empty()) return false;
  if (next_is(',')) return true;
  const char c = *at_.p;
  return c == '}' || c == ')' || c == '>' || c == '<' || c == ';' || c == ']' || c == '{' || c == '"' ||
         is_digit(c) || (c == '.' && is_digit(at_.p[1]));
}

Token Interpreter::fetch() {
  for (;;) {
    Token token;
    Cursor start = at_;
    try {
      skip_space(at_);
      start = at_;
      lex(at_, names_, token);
    } catch (const LexError& error) {
      Place where = error.where.place();
      where.call = call_;
      fail(where, error.message);
    }
    token.where.call = call_;
    if (token.kind == Token::Kind::word) {
      const Datum* const datum = token.name->datum();
      const auto* macro = datum ? datum->get<std::shared_ptr<const Macro>>() : nullptr;
      if (macro == nullptr) return token;
      const std::shared_ptr<const Macro> kept = *macro;
      call_macro(token, kept);
    } else if (token.is('#')) {
      if (!follow_directive(token)) {
        at_ = start;
        token.kind = Token::Kind::held;
        return token;
      }
    } else if (token.kind == Token::Kind::end && frames_.size() > 1 && hold_.frames == frames_.size()) {
      // A declaration that ends with the file: what follows the file must find the name declared.
      token.kind = Token::Kind::held;
      return token;
    } else if (token.kind != Token::Kind::end || !leave_frame(token)) {
      return token;
    }
    if (!pending_.empty()) return take();
  }
}

/// At the end of a text. False: it was the scene's.
bool Interpreter::leave_frame(Token& token) {
  const Frame& frame = frames_.back();
  if (open_.size() > frame.open) fail(open_.back().where, "this directive has no #end");
  check_floor(token.where);
  if (frames_.size() == 1) return false;
  if (frame.macro != nullptr) fail(token.where, "expected #end of the macro '" + frame.macro->name + "'");
  for (Name* name : frame.locals)
    while (!name->bindings.empty() && name->bindings.back().scope == frame.scope) name->bindings.pop_back();
  at_ = frame.back;
  call_ = frame.call;
  frames_.pop_back();
  return true;
}

Source& Interpreter::source(const std::string& path, const Place& where) {
  const bool may_change = !options_.file_folder.empty();
  const auto known = source_of_.find(path);
  if (known != source_of_.end() && !may_change) return *known->second;
  const auto file =
      known != source_of_.end() ? known->second->file : static_cast<std::uint32_t>(document_.files.size());
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path_to_open(path), error);
  const auto check = [&](std::uint64_t bytes) {
    if (bytes > limits_.file_bytes)
      fail(where, in_quotes(path) + " is larger than " + std::to_string(limits_.file_bytes) + " bytes");
    if (bytes > limits_.bytes - bytes_)
      fail(where, "the scene reads more than " + std::to_string(limits_.bytes) + " bytes from files");
  };
  if (!error) check(size);
  std::unique_ptr<Source> source;
  try {
    source = std::make_unique<Source>(path, file, may_change);
  } catch (const Error& problem) {
    if (document_.files.empty()) throw;
    fail(where, problem.what());
  }
  check(source->text.size());
  bytes_ += source->text.size();
  if (file == document_.files.size()) document_.files.push_back(path);
  sources_.push_back(std::move(source));
  source_of_[path] = sources_.back().get();
  return *sources_.back();
}

void Interpreter::enter_file(const std::string& path, const Place& where) {
  if (++includes_ > limits_.includes)
    fail(where, "more than " + std::to_string(limits_.includes) + " files are included");
  const auto depth = static_cast<std::uint32_t>(std::count_if(
      frames_.begin(), frames_.end(), [](const Frame& frame) { return frame.macro == nullptr; }));
  if (depth > limits_.include_depth)
    fail(where, "more than " + std::to_string(limits_.include_depth) + " files include each other");
  Source& file = source(path, where);
  frames_.push_back({at_, open_.size(), static_cast<std::uint32_t>(frames_.size()), &file, nullptr, call_});
  at_ = {&file, file.text.data(), file.text.data(), 1};
  count_step(where, file.text.size() / kBytesOfStep);
}

std::uint32_t Interpreter::note_call(const Macro& macro, const Place& where) {
  // Calls of the same place share a number: loops would make millions.
  constexpr std::size_t most = 1'000'000;
  const std::array<std::uint32_t, 4> key{where.file, where.line, where.column, where.call};
  if (const auto found = call_numbers_.find(key); found != call_numbers_.end()) return found->second;
  if (document_.calls.size() >= most) return where.call;
  document_.calls.push_back({macro.name, where});
  const auto number = static_cast<std::uint32_t>(document_.calls.size() - 1);
  call_numbers_.emplace(key, number);
  return number;
}

void Interpreter::call_macro(const Token& token, const std::shared_ptr<const Macro>& called) {
  const Macro& macro = *called;
  const Level level(*this, token.where);
  count_step(token.where, 1 + macro.length / kBytesOfStep);
  if (macro_depth_ >= limits_.macro_depth)
    fail(token.where,
         "more than " + std::to_string(limits_.macro_depth) + " calls of macros within each other");
  const std::string what = "macro '" + macro.name + "'";
  const Hold outer = hold_;
  hold_ = {};
  if (!next_is('(')) fail_expected("'(' behind " + what, take_written());
  take();
  std::vector<std::optional<Reference>> arguments;
  const std::size_t count = macro.parameters.size();
  while (!peek().is(')')) {
    if (arguments.size() == count)
      fail_expected(
          "')', as " + what + " takes " + std::to_string(count) + (count == 1 ? " value" : " values"),
          peek());
    if (peek().is(',')) {  // an optional one left out
      if (!macro.parameters[arguments.size()].optional) fail_expected("a value for " + what, peek());
      take();
      arguments.emplace_back();
      continue;
    }
    const Token first = take();
    const bool is_name = first.kind == Token::Kind::word && first.name->keyword == kNoKeyword;
    if (is_name && first.name->bindings.empty()) undeclared(first);
    std::optional<Reference> reference;
    if (is_name) {
      reference = access(first);
      if (!next_is(',') && !next_is(')') && !next_is('#')) {
        const Datum kept = value_of(*reference, first);
        reference = Reference{std::make_shared<Datum>(value_behind(kept, first)), {}};
      }
    } else {
      push_back(first);
      reference = Reference{std::make_shared<Datum>(parse_value()), {}};
    }
    arguments.push_back(std::move(reference));
    take_if(',');  // which may be left out
  }
  take();
  hold_ = outer;
  while (arguments.size() < count && macro.parameters[arguments.size()].optional) arguments.emplace_back();
  if (arguments.size() < count)
    fail(token.where,
         what + " takes " + std::to_string(count) + " values, found " + std::to_string(arguments.size()));
  Frame frame{at_, open_.size(), static_cast<std::uint32_t>(frames_.size()), nullptr, nullptr, call_};
  frame.macro = called;
  frames_.push_back(std::move(frame));
  for (std::size_t i = 0; i < count; ++i) {
    Name& name = *macro.parameters[i].name;
    if (arguments[i]) bind(name, frames_.back().scope, std::move(*arguments[i]));
  }
  ++macro_depth_;
  call_ = note_call(macro, token.where);
  at_ = macro.body;
}

void Interpreter::bind(Name& name, std::uint32_t scope, Reference reference) {
  name.bindings.push_back({scope, std::move(reference)});
  frames_[scope].locals.push_back(&name);
}

void Interpreter::undeclared(const Token& name) {
  std::vector<std::string> known = names_.declared();
  known.insert(known.end(), kKeywords.begin(), kKeywords.end());
  fail(name.where, "nothing is declared as " + in_quotes(name.name->text) + similar(name.name->text, known));
}

/// What a name stands for, with the indices behind it.
Reference Interpreter::access(const Token& name) {
  if (name.name->bindings.empty()) undeclared(name);
  Reference reference = name.name->bindings.back().value;
  if (!next_is('[')) return reference;
  const Level level(*this, name.where);
  std::vector<std::pair<double, Place>> indices;
  while (next_is('[')) {
    take();
    const Place where = peek().where;
    indices.emplace_back(parse_float(), where);
    expect(']', "behind the index of an array");
  }
  std::size_t used = 0;
  while (used < indices.size()) {
    const Datum* const datum = reference.find();
    const Array* const array = datum ? datum->array() : nullptr;
    if (array == nullptr)
      fail(indices[used].second, in_quotes(name.name->text) + " has no index here: it is no array");
    if (indices.size() - used < array->sizes.size())
      fail(name.where, "the array " + in_quotes(name.name->text) + " takes " +
                           std::to_string(array->sizes.size()) + " indices, found " +
                           std::to_string(indices.size() - used));
    std::size_t index = 0;
    for (const std::size_t size : array->sizes) {
      const auto& [value, where] = indices[used++];
      if (!(value > -1 && value < static_cast<double>(size)))
        fail(where, "index " + std::to_string(value) + " is out of range: the array " +
                        in_quotes(name.name->text) + " has elements 0 to " + std::to_string(size - 1));
      index = index * size + static_cast<std::size_t>(value);
    }
    reference.path.push_back(index);
  }
  return reference;
}

const Datum& Interpreter::value_of(const Reference& reference, const Token& name) {
  const Datum* const datum = reference.find();
  if (datum != nullptr && !datum->empty()) return *datum;
  fail(name.where, reference.path.empty()
                       ? in_quotes(name.name->text) + " has no value yet"
                       : "this element of " + in_quotes(name.name->text) + " has no value yet");
}

}  // namespace oktett::pov
