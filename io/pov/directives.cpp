#include <array>
#include <cmath>
#include <filesystem>

#include "io/pov/interpreter.h"
#include "io/text/files.h"

namespace oktett::pov {
namespace {

/// Numbers that differ by less count as equal.
constexpr double kTolerance = 1e-10;

bool opens_block(Keyword keyword) {
  switch (keyword) {
    case "if"_kw:
    case "ifdef"_kw:
    case "ifndef"_kw:
    case "while"_kw:
    case "for"_kw:
    case "switch"_kw:
    case "macro"_kw:
      return true;
    default:
      return false;
  }
}

/// Of the directives that divide or end a block.
bool divides_block(Keyword keyword) {
  switch (keyword) {
    case "end"_kw:
    case "else"_kw:
    case "elseif"_kw:
    case "case"_kw:
    case "range"_kw:
    case "break"_kw:
      return true;
    default:
      return false;
  }
}

}  // namespace

bool Interpreter::follow_directive(const Token& hash) {
  const Level level(*this, hash.where);
  const Token word = take_written();
  const Keyword keyword = word.keyword();
  if (hold_.frames == frames_.size()) {
    const bool declares = keyword == "declare"_kw || keyword == "local"_kw || keyword == "undef"_kw;
    if (hold_.all || declares || (divides_block(keyword) && open_.size() <= hold_.open)) return false;
  }
  count_step(hash.where);
  switch (keyword) {
    case "declare"_kw:
      declare(false);
      break;
    case "local"_kw:
      declare(true);
      break;
    case "undef"_kw:
      undef();
      break;
    case "if"_kw:
    case "ifdef"_kw:
    case "ifndef"_kw:
      begin_if(hash.where, keyword);
      break;
    case "else"_kw:
    case "elseif"_kw:
      reach_else(hash.where);
      break;
    case "case"_kw:
    case "range"_kw:
      reach_case(hash.where);
      break;
    case "end"_kw:
      reach_end(hash.where);
      break;
    case "while"_kw:
      begin_while(hash.where);
      break;
    case "for"_kw:
      begin_for(hash.where);
      break;
    case "switch"_kw:
      begin_switch(hash.where);
      break;
    case "break"_kw:
      break_out(hash.where);
      break;
    case "macro"_kw:
      define_macro(hash.where);
      break;
    case "include"_kw:
      include(hash.where);
      break;
    case "version"_kw:
      set_version();
      break;
    case "default"_kw:
      set_default(hash.where);
      break;
    case "debug"_kw:
    case "render"_kw:
    case "statistics"_kw: {
      const std::string text = parse_string();
      if (options_.said) options_.said(text);
      break;
    }
    case "warning"_kw:
      warn(hash.where, parse_string());
      break;
    case "error"_kw:
      fail(hash.where, "the scene stops here: " + parse_string());
    case "fopen"_kw:
      open_file();
      break;
    case "fclose"_kw:
      close_file();
      break;
    case "read"_kw:
      read_file();
      break;
    case "write"_kw:
      write_file();
      break;
    default: {
      if (word.kind == Token::Kind::sign) {
        warn(hash.where, "a '#' without a directive is left out");
        push_back(word);
        break;
      }
      static const std::vector<std::string> known{
          "break",  "case",  "debug",  "declare", "default", "else",    "elseif",  "end",   "error",
          "fclose", "fopen", "for",    "if",      "ifdef",   "ifndef",  "include", "local", "macro",
          "range",  "read",  "switch", "undef",   "version", "warning", "while",   "write"};
      std::string message = "expected a directive behind '#', found " + describe(word);
      if (word.kind == Token::Kind::word) message += similar(word.name->text, known);
      fail(word.where, message);
    }
  }
  return true;
}

// ---- Declarations

bool Interpreter::assign(const Reference& reference, Datum value, const Place& where) {
  std::uint32_t depth = value.depth;
  for (std::size_t i = 0; i < reference.path.size(); ++i) depth = deeper(depth, where);
  Datum* const target = reference.find_to_write();
  if (target == nullptr) return false;
  Datum* level = reference.slot.get();
  for (std::size_t i = 0; i < reference.path.size(); ++i) {
    level->depth = std::max(level->depth, depth - static_cast<std::uint32_t>(i));
    level = &std::get<std::shared_ptr<Array>>(level->value)->elements[reference.path[i]];
  }
  *target = std::move(value);
  if (array_count_->copied == 0) return true;
  const std::size_t copied = array_count_->copied;
  array_count_->copied = 0;
  count_step(where, copied / 4);
  if (array_count_->living > limits_.array_elements)
    fail(where, "arrays have more than " + std::to_string(limits_.array_elements) + " elements");
  return true;
}

Datum Interpreter::named(Datum datum, const Token& name) {
  if (const BlockPtr* block = datum.get<BlockPtr>()) {
    if ((*block)->name.empty()) {
      count_values(name.where, (*block)->elements.size());
      auto copy = std::make_shared<Block>(**block);
      copy->name = name.name->text;
      datum.value = BlockPtr(std::move(copy));
    }
  } else if (const FunctionPtr* function = datum.get<FunctionPtr>(); function && (*function)->name.empty()) {
    count_values(name.where, (*function)->nodes.size());
    auto copy = std::make_shared<Function>(**function);
    copy->name = name.name->text;
    datum.value = FunctionPtr(std::move(copy));
  }
  return datum;
}

Reference Interpreter::variable(const Token& name, bool local) {
  return variable(name, local, frames_.back().scope);
}

Reference Interpreter::variable(const Token& name, bool local, std::uint32_t scope) {
  std::vector<Binding>& bindings = name.name->bindings;
  // Behind those of macros whose text has begun since.
  const auto inner = std::find_if(bindings.begin(), bindings.end(),
                                  [scope](const Binding& binding) { return binding.scope > scope; });
  if (inner != bindings.begin() && (!local || std::prev(inner)->scope == scope))
    return std::prev(inner)->value;
  const std::uint32_t own = local ? scope : 0;
  frames_[own].locals.push_back(name.name);
  return bindings.insert(inner, Binding{own, {std::make_shared<Datum>(), {}}})->value;
}

/// `#declare NAME = value` or `#declare NAME[index] = value`; the `#declare` was read.
void Interpreter::declare(bool local) {
  Token name = take_written();
  if (name.kind == Token::Kind::word && name.name->text == "deprecated" && !next_is('=') && !next_is('[')) {
    // `deprecated once "why" NAME`: whoever uses the name would be told why not to.
    if (is_letter(*at_.p)) take_written();
    if (next_is('"')) take_written();
    name = take_written();
  }
  if (name.kind != Token::Kind::word) fail_expected("a name to declare", name);
  if (name.name->keyword != kNoKeyword)
    fail(name.where, "expected a name to declare, found the keyword " + in_quotes(name.name->text));
  std::optional<Reference> element;
  if (next_is('[')) element = access(name);
  expect('=', "behind the name that is declared");
  // The value may end in the text of a macro, with names of its own.
  const std::uint32_t scope = frames_.back().scope;
  const auto set = [&](Datum value) {
    if (!assign(element ? *element : variable(name, local, scope), std::move(value), name.where))
      fail(name.where, "the array " + in_quotes(name.name->text) + " has changed in between");
  };
  while (next_is('#') && pending_.empty()) {
    // Other names may be declared before the value of this one.
    const Cursor start = at_;
    const Token hash = take_written();
    const Cursor behind = at_;
    const Keyword directive = take_written().keyword();
    const bool declares = directive == "declare"_kw || directive == "local"_kw;
    at_ = declares ? behind : start;
    if (!declares || !follow_directive(hash)) break;
  }
  const Hold outer = hold_;
  const std::size_t frames = frames_.size();
  hold_ = {frames, open_.size(), false};
  Datum value = named(parse_value(), name);
  // Textures in a row are the layers of one.
  if (const BlockPtr* first = value.get<BlockPtr>();
      first && (*first)->keyword == "texture" && !next_is(';')) {
    std::shared_ptr<Block> layers;
    // What follows may be the call of a macro that is given the texture.
    set(value);
    while (peek().keyword() == "texture"_kw) {
      const Token keyword = take();
      std::uint32_t depth = value.depth;
      if (layers == nullptr) {
        layers = std::make_shared<Block>();
        layers->keyword = "texture", layers->where = (*first)->where, layers->name = name.name->text;
        add(layers->elements, (*first)->where, *value.get<BlockPtr>());
        value.depth = deeper(value.depth, name.where);
      }
      take();
      auto layer = parse_block(keyword, depth);
      value.depth = std::max(value.depth, deeper(depth, name.where));
      add(layers->elements, keyword.where, BlockPtr(std::move(layer)));
    }
    if (layers != nullptr) value.value = BlockPtr(std::move(layers));
  }
  // Behind the value that a macro gave, the macro ends.
  if (hold_.all = true; frames_.size() > frames) peek();
  hold_ = outer;
  if (!pending_.empty() && pending_.back().kind == Token::Kind::held) pending_.pop_back();
  if (next_is(';')) take();
  set(std::move(value));
}

void Interpreter::undef() {
  const Token name = take_written();
  if (name.kind != Token::Kind::word) fail_expected("a name", name);
  if (next_is('[')) {
    assign(access(name), {}, name.where);
  } else if (!name.name->bindings.empty()) {
    name.name->bindings.pop_back();
  }
  if (next_is(';')) take();
}

void Interpreter::define_macro(const Place& where) {
  const Token name = take_written();
  if (name.kind != Token::Kind::word || name.name->keyword != kNoKeyword)
    fail_expected("the name of a macro", name);
  auto macro = std::make_shared<Macro>();
  macro->name = name.name->text;
  const Token open = take_written();
  if (!open.is('(')) fail_expected("'(' behind the name of a macro", open);
  for (;;) {
    Token token = take_written();
    if (token.is(')')) break;
    if (token.is(',')) continue;
    const bool optional =
        token.kind == Token::Kind::word && token.name->text == "optional" && !next_is(',') && !next_is(')');
    if (optional) token = take_written();
    if (token.kind != Token::Kind::word || token.name->keyword != kNoKeyword)
      fail_expected("the name of a parameter of the macro '" + macro->name + "'", token);
    macro->parameters.push_back({token.name, optional});
  }
  macro->body = at_;
  skip_block(where, false, false);
  macro->length = static_cast<std::size_t>(at_.p - macro->body.p);
  Datum datum;
  datum.value = std::shared_ptr<const Macro>(std::move(macro));
  // Macros are global, whoever defines them; a second definition replaces the first.
  assign(variable(name, false), std::move(datum), name.where);
}

// ---- Choices and loops

void Interpreter::check_floor(const Place& where) const {
  if (frames_.size() == floor_.first && open_.size() <= floor_.second)
    fail(where, "what ends here began before the condition that this stands in");
}

void Interpreter::check_enclosed(const Place& where) const {
  if (frames_.size() != floor_.first || open_.size() != floor_.second)
    fail(where, "the condition of this directive does not end where it began");
}

bool Interpreter::condition() {
  const Enclosed enclosed(*this);
  expect('(', "before a condition");
  const Place where = peek().where;
  const bool result = to_float(parse_relation(), where) != 0;
  expect(')', "behind a condition");
  check_enclosed(where);
  return result;
}

/// `(NAME)` or `(NAME[index])`
bool Interpreter::is_defined() {
  const Token open = take_written();
  if (!open.is('(')) fail_expected("'('", open);
  const Token name = take_written();
  if (name.kind != Token::Kind::word) fail_expected("a name", name);
  bool result = name.name->datum() != nullptr && !name.name->datum()->empty();
  if (next_is('[')) {
    // The index may undefine the name, so its value is kept alive.
    const Reference reference = name.name->bindings.empty() ? Reference{} : access(name);
    const Datum* const datum = reference.find();
    result = datum != nullptr && !datum->empty();
  } else if (result) {
    const auto* const file = name.name->datum()->get<std::shared_ptr<TextFile>>();
    if (file != nullptr) result = !(*file)->at_end();
  }
  expect(')', "behind a name");
  return result;
}

Interpreter::Stop Interpreter::skip_block(const Place& opened, bool else_stops, bool case_stops) {
  const char* const end = at_.source->end;
  std::uint32_t depth = 0;
  for (;;) {
    const char c = *at_.p;
    if (c == '\0' && at_.p >= end) fail(opened, "this directive has no #end");
    if (c == '/' || c == '\n' || c == '\r') {
      const char* const before = at_.p;
      try {
        skip_space(at_);
      } catch (const LexError& error) {
        fail(error.where.place(), error.message);
      }
      if (at_.p == before) ++at_.p;
      continue;
    }
    if (c != '#' && c != '"') {
      ++at_.p;
      continue;
    }
    if (c == '"') {
      take_written();
      continue;
    }
    ++at_.p;
    try {
      skip_space(at_);
    } catch (const LexError& error) {
      fail(error.where.place(), error.message);
    }
    if (!is_letter(*at_.p)) continue;
    const Keyword keyword = take_written().keyword();
    if (opens_block(keyword)) {
      ++depth;
    } else if (keyword == "end"_kw) {
      if (depth == 0) return Stop::end;
      --depth;
    } else if (depth == 0 && divides_block(keyword)) {
      if (else_stops && keyword == "else"_kw) return Stop::at_else;
      if (else_stops && keyword == "elseif"_kw) return Stop::at_elseif;
      if (case_stops && keyword == "case"_kw) return Stop::at_case;
      if (case_stops && keyword == "range"_kw) return Stop::at_range;
    }
  }
}

void Interpreter::begin_if(const Place& where, Keyword kind) {
  bool holds = kind == "if"_kw ? condition() : is_defined() == (kind == "ifdef"_kw);
  while (!holds) {
    const Stop stop = skip_block(where, true, false);
    if (stop == Stop::end) return;
    if (stop == Stop::at_else) break;
    holds = condition();
  }
  open_.push_back({.kind = Open::Kind::chosen, .where = where});
}

/// The end of a branch that was followed; a case of a #switch goes on through what stands for all others.
void Interpreter::reach_else(const Place& where) {
  check_floor(where);
  if (open_.size() == frames_.back().open) fail(where, "there is no #if that this belongs to");
  const Open::Kind kind = open_.back().kind;
  if (kind == Open::Kind::switched) return;
  if (kind != Open::Kind::chosen) fail(where, "expected #end of the loop before this");
  skip_block(open_.back().where, false, false);
  open_.pop_back();
}

/// Goes on through the next case.
void Interpreter::reach_case(const Place& where) {
  if (open_.size() == frames_.back().open || open_.back().kind != Open::Kind::switched)
    fail(where, "there is no #switch that this belongs to");
  const Enclosed enclosed(*this);
  expect('(', "behind #case or #range");
  parse_float();
  skip_comma();
  if (!next_is(')')) parse_float();
  expect(')', "behind #case or #range");
  check_enclosed(where);
}

void Interpreter::begin_switch(const Place& where) {
  double value = 0;
  {
    const Enclosed enclosed(*this);
    expect('(', "behind #switch");
    value = parse_float();
    expect(')', "behind the value of #switch");
    check_enclosed(where);
  }
  open_.push_back({.kind = Open::Kind::switched, .where = where, .value = value});
  select_case(where);
}

void Interpreter::select_case(const Place& where) {
  const double value = open_.back().value;
  for (;;) {
    const Stop stop = skip_block(where, true, true);
    if (stop == Stop::end) {
      open_.pop_back();
      return;
    }
    if (stop == Stop::at_else) return;
    if (stop == Stop::at_elseif) continue;
    const Enclosed enclosed(*this);
    expect('(', "behind #case or #range");
    const double first = parse_float();
    bool fits = std::abs(value - first) < kTolerance;
    if (stop == Stop::at_range) {
      skip_comma();
      fits = value >= first - kTolerance && value <= parse_float() + kTolerance;
    }
    expect(')', "behind #case or #range");
    check_enclosed(where);
    if (fits) return;
  }
}

void Interpreter::begin_while(const Place& where) {
  const Cursor start = at_;
  if (!condition()) {
    skip_block(where, false, false);
    return;
  }
  open_.push_back({.kind = Open::Kind::repeated, .where = where, .start = start});
}

void Interpreter::begin_for(const Place& where) {
  std::optional<Enclosed> enclosed(std::in_place, *this);
  expect('(', "behind #for");
  const Token name = take_written();
  if (name.kind != Token::Kind::word || name.name->keyword != kNoKeyword)
    fail_expected("the name of a counter", name);
  skip_comma();
  const double first = parse_float();
  skip_comma();
  const double last = parse_float();
  skip_comma();
  const Place at_step = peek().where;
  const double step = next_is(')') ? 1 : parse_float();
  if (step == 0) fail(at_step, "the step of #for must not be 0");
  expect(')', "behind #for");
  check_enclosed(where);
  enclosed.reset();
  Open loop{.kind = Open::Kind::counted, .where = where, .start = at_, .last = last, .step = step};
  loop.counter = variable(name, true);
  Datum counter;
  counter.value = Numbers{{first}, 1, false};
  assign(loop.counter, std::move(counter), where);
  open_.push_back(std::move(loop));
  if (for_goes_on(open_.size() - 1)) return;
  skip_block(where, false, false);
  open_.pop_back();
}

bool Interpreter::for_goes_on(std::size_t index) {
  const Open& loop = open_[index];
  const Datum* const counter = loop.counter.find();
  const Numbers* const number = counter ? counter->get<Numbers>() : nullptr;
  if (number == nullptr || number->size != 1)
    fail(loop.where, "the counter of this loop is no number any more");
  return loop.step > 0 ? number->v[0] <= loop.last + kTolerance : number->v[0] >= loop.last - kTolerance;
}

void Interpreter::reach_end(const Place& where) {
  check_floor(where);
  Frame& frame = frames_.back();
  if (open_.size() == frame.open) {
    if (frame.macro == nullptr) fail(where, "there is no directive that this ends");
    for (Name* name : frame.locals)
      while (!name->bindings.empty() && name->bindings.back().scope == frame.scope) name->bindings.pop_back();
    at_ = frame.back;
    call_ = frame.call;
    --macro_depth_;
    frames_.pop_back();
    return;
  }
  const std::size_t index = open_.size() - 1;
  const Open::Kind kind = open_[index].kind;
  if (kind == Open::Kind::repeated || kind == Open::Kind::counted) {
    const Cursor behind = at_;
    const Open loop = open_[index];
    const bool same = behind.source == loop.start.source && behind.p > loop.start.p;
    count_step(where, same ? static_cast<std::size_t>(behind.p - loop.start.p) / kBytesOfStep
                           : behind.source->text.size() / kBytesOfStep);
    at_ = loop.start;
    bool again;
    if (kind == Open::Kind::repeated) {
      again = condition();
    } else {
      const Datum* const counter = loop.counter.find();
      const Numbers* const number = counter ? counter->get<Numbers>() : nullptr;
      if (number == nullptr || number->size != 1)
        fail(loop.where, "the counter of this loop is no number any more");
      Datum next;
      next.value = Numbers{{number->v[0] + loop.step}, 1, false};
      assign(loop.counter, std::move(next), where);
      again = for_goes_on(index);
    }
    if (again) return;
    at_ = behind;
  }
  open_.pop_back();
}

void Interpreter::break_out(const Place& where) {
  check_floor(where);
  std::size_t level = open_.size();
  const std::size_t base = frames_.back().open;
  while (level > base && open_[level - 1].kind == Open::Kind::chosen) --level;
  if (level == base || (frames_.size() == floor_.first && level <= floor_.second))
    fail(where, "there is no loop or #switch to leave");
  while (open_.size() >= level) {
    skip_block(open_.back().where, false, false);
    open_.pop_back();
  }
}

// ---- The rest

/// The time that a look for a file takes, in steps.
static constexpr std::uint64_t kStepsOfFile = 100;

/// Of the folders in which a file is looked for, the path in the first that has it.
static std::string find_file(const std::string& name, const std::vector<std::string>& folders) {
  namespace fs = std::filesystem;
  for (const std::string& folder : folders) {
    const std::string path = folder.empty() ? name : (fs::path(folder) / name).string();
    std::error_code error;
    if (fs::is_regular_file(path, error) || path_to_open(path) != path) return path;
  }
  return {};
}

/// The folder of the file that is being read comes first, then that of the scene.
static std::vector<std::string> folders_for(const std::string& name, const std::string& reading,
                                            const std::string& scene, const ReadOptions& options) {
  namespace fs = std::filesystem;
  if (fs::path(name).is_absolute()) return {""};
  std::vector<std::string> folders{fs::path(reading).parent_path().string(),
                                   fs::path(scene).parent_path().string()};
  // What the scene has written may be included, too.
  if (!options.file_folder.empty()) folders.push_back(options.file_folder);
  folders.insert(folders.end(), options.library_folders.begin(), options.library_folders.end());
  return folders;
}

bool Interpreter::file_exists(const std::string& name, const Place& where) {
  count_step(where, kStepsOfFile);
  return !find_file(name, folders_for(name, at_.source->path, document_.files[0], options_)).empty();
}

void Interpreter::include(const Place& where) {
  namespace fs = std::filesystem;
  const std::string name = parse_string();
  if (next_is(';')) take();
  count_step(where, kStepsOfFile);
  const std::vector<std::string> folders = folders_for(name, at_.source->path, document_.files[0], options_);
  std::string path = find_file(name, folders);
  for (const char* ending : {".inc", ".INC"})
    if (path.empty()) path = find_file(name + ending, folders);
  if (path.empty())
    fail(where, "cannot include " + in_quotes(name) + ": no such file beside " + in_quotes(at_.source->path) +
                    " or in a library folder" + did_you_mean_file((fs::path(folders[0]) / name).string()));
  enter_file(path, where);
}

void Interpreter::set_version() {
  const Hold outer = hold_;
  hold_ = {frames_.size(), open_.size(), true};
  if (peek().kind == Token::Kind::word && peek().name->text == "unofficial") {
    take();
    if (peek().kind == Token::Kind::word) take();
    parse_float();
  } else {
    version_ = parse_float();
    // Objects may be asked before the end.
    document_.version = version_;
  }
  hold_ = outer;
  if (!pending_.empty() && pending_.back().kind == Token::Kind::held) pending_.pop_back();
  if (next_is(';')) take();
}

/// Later defaults add to earlier ones, also where they are whole textures.
void Interpreter::set_default(const Place& where) {
  const Token opening = peek();
  expect('{', "behind #default");
  Block given;
  std::uint32_t depth = 0;
  parse_elements(given.elements, opening, '}', depth);
  auto texture = default_texture_ ? std::make_shared<Block>(*default_texture_) : std::make_shared<Block>();
  count_values(where, texture->elements.size());
  texture->keyword = "texture";
  texture->where = where;
  for (Element& element : given.elements) {
    const auto* block = std::get_if<BlockPtr>(&element.value);
    if (block == nullptr) continue;
    if ((*block)->keyword == "texture")
      texture->elements.insert(texture->elements.end(), (*block)->elements.begin(), (*block)->elements.end());
    if ((*block)->keyword != "camera" && (*block)->keyword != "texture") texture->elements.push_back(element);
  }
  default_texture_ = std::move(texture);
}

}  // namespace oktett::pov
