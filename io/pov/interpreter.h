#pragma once
/// \file Follows the directives of a scene and computes its expressions, from the first token to the last.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/pov/lexer.h"
#include "io/pov/read_pov.h"
#include "io/pov/text_file.h"
#include "io/pov/value.h"

namespace oktett::pov {

/// `#macro NAME(parameters)`: its body is a place in a file.
struct Macro {
  struct Parameter {
    Name* name;
    bool optional;
  };
  std::string name;
  std::vector<Parameter> parameters;
  Cursor body;
  std::size_t length = 0;  ///< of the body, in bytes
};

/// Whether a string starts with this word, such as concat.
bool is_string_keyword(Keyword keyword);

class Interpreter {
 public:
  Interpreter(const ReadOptions& options, Document& document);

  /// Reads the whole scene into the document.
  void run(const std::string& path);

 private:
  friend class FunctionParser;
  friend class FunctionCaller;

  // ---- Tokens (tokens.cpp): those of macros and included files come in the place of their calls.
  /// The next token, which stays. Directives before it are followed.
  const Token& peek();
  Token take();
  void push_back(const Token& token);
  /// The next token as it is written, for directives: no macro is called, no directive followed.
  Token take_written();
  /// Whether the sign `c` is next. Looks at the text only: follows no directive.
  bool next_is(char c);
  bool take_if(char c);
  void expect(char c, const char* behind);
  void skip_comma() { take_if(','); }
  /// Whether what follows cannot go on with an expression, as its text alone shows.
  bool ends_expression();
  Token fetch();
  bool leave_frame(Token& token);
  void enter_file(const std::string& path, const Place& where);
  Source& source(const std::string& path, const Place& where);
  void call_macro(const Token& token, const std::shared_ptr<const Macro>& called);
  std::uint32_t note_call(const Macro& macro, const Place& where);

  // ---- Directives (directives.cpp)
  /// Follows the directive whose `#` was read. False: it has to wait, and was left unread.
  bool follow_directive(const Token& hash);
  void declare(bool local);
  void undef();
  void begin_if(const Place& where, Keyword kind);
  void reach_else(const Place& where);
  void reach_case(const Place& where);
  void reach_end(const Place& where);
  void begin_while(const Place& where);
  void begin_for(const Place& where);
  void begin_switch(const Place& where);
  void break_out(const Place& where);
  void define_macro(const Place& where);
  void include(const Place& where);
  void set_version();
  void set_default(const Place& where);
  bool condition();
  bool is_defined();
  bool for_goes_on(std::size_t index);
  enum class Stop : std::uint8_t { end, at_else, at_elseif, at_case, at_range };
  /// As long as it exists, no directive ends what began outside: what stands in the condition of a directive
  /// must leave the directive and its text alone.
  class Enclosed {
   public:
    explicit Enclosed(Interpreter& interpreter) : interpreter_(interpreter), outer_(interpreter.floor_) {
      interpreter.floor_ = {interpreter.frames_.size(), interpreter.open_.size()};
    }
    ~Enclosed() { interpreter_.floor_ = outer_; }
    Enclosed(const Enclosed&) = delete;
    Enclosed& operator=(const Enclosed&) = delete;

   private:
    friend class Interpreter;
    Interpreter& interpreter_;
    std::pair<std::size_t, std::size_t> outer_;
  };
  /// Fails where the text of a condition went on into another file or macro.
  void check_enclosed(const Place& where) const;
  /// Fails if what ends here began outside of a condition.
  void check_floor(const Place& where) const;
  /// Past text that is not followed, up to `#end`, or to one of the others if `stops` is set.
  Stop skip_block(const Place& opened, bool else_stops, bool case_stops);
  void select_case(const Place& where);

  // ---- Files of #fopen (text_file.cpp)
  void open_file();
  void close_file();
  void read_file();
  void write_file();
  TextFile& file_handle(const Token& token);

  // ---- Names
  Reference access(const Token& name);
  Reference variable(const Token& name, bool local);
  /// The same as seen from a frame of this scope.
  Reference variable(const Token& name, bool local, std::uint32_t scope);
  void bind(Name& name, std::uint32_t scope, Reference reference);
  const Datum& value_of(const Reference& reference, const Token& name);
  [[noreturn]] void undeclared(const Token& name);
  /// Writes to a variable or an element. False: the array has changed since.
  bool assign(const Reference& reference, Datum value, const Place& where);
  /// Gives a block or a function the name by which it was declared.
  Datum named(Datum datum, const Token& name);

  // ---- Values (expressions.cpp)
  /// Any value that can be declared.
  Datum parse_value();
  /// Goes on behind the name that stands for `datum`.
  Datum value_behind(const Datum& datum, const Token& name);
  bool starts_value(const Token& token) const;
  Numbers parse_relation();
  Numbers parse_logic();
  std::optional<std::string> take_string();
  bool compare_string(const std::string& text);
  Numbers parse_sum();
  Numbers parse_product();
  Numbers parse_factor();
  Numbers parse_term();
  Numbers parse_postfix(Numbers value);
  Numbers parse_vector(std::vector<Numbers>* long_vector = nullptr);
  Numbers parse_color(const Token& keyword);
  bool add_channel(Numbers& color);
  Numbers call_value(const Datum& datum, const Token& name);
  double parse_float();
  double to_float(const Numbers& value, const Place& where) const;
  std::array<double, 3> parse_point();
  std::vector<double> parse_arguments();

  // ---- Built-in functions (builtins.cpp)
  std::optional<Numbers> parse_builtin(const Token& token);
  std::string parse_string();
  std::optional<std::string> parse_string_call(const Token& token);
  BlockPtr parse_object_argument();
  Numbers random_number();
  std::string unescape(const Token& token);
  void check_length(std::size_t length, const Place& where);
  ObjectQueries& queries(const Token& token);
  bool file_exists(const std::string& name, const Place& where);

  // ---- Statements (blocks.cpp)
  void parse_elements(std::vector<Element>& elements, const Token& opening, char closing,
                      std::uint32_t& depth);
  bool take_plain_numbers(std::vector<Element>& elements);
  void parse_element(std::vector<Element>& elements, std::uint32_t& depth);
  void add_value(std::vector<Element>& elements, const Token& token, std::uint32_t& depth);
  std::shared_ptr<Block> parse_block(const Token& keyword, std::uint32_t& depth);
  std::uint32_t flatten_union(Block& all, const Place& where);
  Datum parse_block_value(const Token& keyword);
  Datum parse_spline(const Token& keyword);
  Datum parse_array(const Token& keyword);
  void fill_array(Array& array, std::size_t dimension, std::size_t& next, std::uint32_t& depth);
  Datum parse_function(const Token& keyword);
  void add(std::vector<Element>& elements, const Place& where, Value value);

  // ---- What is wrong
  [[noreturn]] void fail(const Place& where, const std::string& message) const;
  [[noreturn]] void fail_expected(const std::string& what, const Token& found) const;
  void warn(const Place& where, const std::string& message);
  /// `count`: as much as the work takes longer than an ordinary step.
  void count_step(const Place& where, std::uint64_t count = 1);
  void count_values(const Place& where, std::uint64_t count);
  /// One more level of recursion, while it exists.
  class Level {
   public:
    Level(Interpreter& interpreter, const Place& where);
    ~Level() { --interpreter_.nesting_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;

   private:
    Interpreter& interpreter_;
  };
  std::uint32_t deeper(std::uint32_t depth, const Place& where) const;

  /// A directive that waits for its #end.
  struct Open {
    enum class Kind : std::uint8_t { chosen, repeated, counted, switched };
    Kind kind = Kind::chosen;
    Place where;
    Cursor start{};       ///< of the condition of #while, of the body of #for
    Reference counter{};  ///< of #for
    double last = 0, step = 1;
    double value = 0;  ///< of #switch
  };

  /// A file or a call of a macro whose text is being read.
  struct Frame {
    Cursor back;          ///< where its caller goes on
    std::size_t open;     ///< how many of open_ belong to its callers
    std::uint32_t scope;  ///< of its locals
    const Source* file;   ///< null: a macro
    std::shared_ptr<const Macro> macro;
    std::uint32_t call;
    std::vector<Name*> locals{};
  };

  const ReadOptions& options_;
  const Limits& limits_;
  Document& document_;
  Names names_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::unordered_map<std::string, Source*> source_of_;
  Cursor at_;
  std::uint32_t call_ = Place::kNoCall;
  std::vector<Frame> frames_;
  std::vector<Open> open_;
  std::vector<Token> pending_;   ///< read already, the next one last
  std::optional<Numbers> term_;  ///< the next term, read already
  /// Directives at the level of a declaration wait for its end: the numbers of frames and of open directives.
  struct Hold {
    std::size_t frames = ~std::size_t{0}, open = 0;
    bool all = false;  ///< not only what declares or ends
  } hold_;
  std::pair<std::size_t, std::size_t> floor_{0, 0};  ///< frames and open directives that have to stay
  std::map<std::array<std::uint32_t, 4>, std::uint32_t> call_numbers_;
  std::vector<std::uint32_t> streams_;  ///< of random numbers
  std::shared_ptr<ArrayCount> array_count_ = std::make_shared<ArrayCount>();
  BlockPtr default_texture_;
  double version_ = 3.7;  ///< what `version` is
  std::uint32_t nesting_ = 0, includes_ = 0, macro_depth_ = 0;
  std::uint64_t steps_ = 0, values_ = 0, bytes_ = 0;
};

}  // namespace oktett::pov
