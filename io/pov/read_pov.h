#pragma once
/// \file Reads scenes in the language of POV-Ray 3.7: follows all directives and macros, computes all
/// expressions, and returns what is left. Within io/ only; knows nothing of what the statements mean.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/pov/document.h"

namespace oktett::pov {

/// Questions of a scene whose answers need to know what its objects and patterns are. Without an answer
/// (nullopt), reading fails where the question stands.
class ObjectQueries {
 public:
  using Point = std::array<double, 3>;
  using BlockPointer = std::shared_ptr<const Block>;
  struct Hit {
    bool found = false;
    Point point{}, normal{};
  };

  virtual ~ObjectQueries() = default;
  /// Called before the first question: `document`, which is being read, has the places of blocks.
  virtual void begin(const Document& document);
  /// How many steps (Limits::steps) the answers since the last call have taken.
  virtual std::uint64_t take_steps();
  /// `inside(object, point)`
  virtual std::optional<bool> inside(const BlockPointer& object, const Point& point);
  /// `trace(object, origin, direction)`
  virtual std::optional<Hit> trace(const BlockPointer& object, const Point& origin, const Point& direction);
  /// `min_extent(object)` and `max_extent(object)`
  virtual std::optional<std::pair<Point, Point>> extent(const BlockPointer& object);
  /// `function { pigment { ... } }` at a point: red, green, blue, filter, transmit.
  virtual std::optional<std::array<double, 5>> pigment(const BlockPointer& block, const Point& point);
  /// `function { pattern { ... } }` at a point.
  virtual std::optional<double> pattern(const BlockPointer& block, const Point& point);
  /// `function { internal(N) }`, as functions.inc declares f_sphere and the others.
  virtual std::optional<double> internal(std::uint32_t number, std::span<const double> arguments);
  /// `vturbulence(lambda, omega, octaves, point)`
  virtual std::optional<Point> turbulence(double lambda, double omega, int octaves, const Point& point);
};

/// How much a scene may ask for. Whatever exceeds one of these is an Error that names it.
struct Limits {
  std::uint32_t include_depth = 64;
  std::uint32_t includes = 100'000;   ///< files included, each time counted
  std::uint32_t macro_depth = 2'000;  ///< calls of macros within calls
  std::uint32_t nesting = 400;        ///< of blocks, parentheses and directives within each other
  std::uint32_t value_depth = 1'000;  ///< of declared values within values
  /// Directives, calls of macros and functions, passes of loops; long texts, copies and the like count as
  /// many. An endless loop takes less than ten seconds.
  std::uint64_t steps = 50'000'000;
  std::uint64_t values = 50'000'000;          ///< elements of the tree; blocks count as some
  std::uint64_t array_elements = 20'000'000;  ///< of all arrays together
  std::uint64_t string_length = 1 << 20;
  std::uint64_t bytes = std::uint64_t{4} << 30;         ///< read from files, each file counted once
  std::uint64_t file_bytes = std::uint64_t{512} << 20;  ///< of one file
};

struct ReadOptions {
  /// Where included files are looked for after the folder of the file that names them and that of the scene.
  std::vector<std::string> library_folders = default_library_folders();
  std::map<std::string, std::variant<double, std::string>>
      definitions;  ///< names that the scene finds declared
  double clock = 0, initial_clock = 0, final_clock = 0, clock_delta = 0;
  bool clock_on = false;
  int frame_number = 0, initial_frame = 0, final_frame = 0;
  int image_width = 800, image_height = 600;
  /// The only folder in which #fopen may read and write files; empty: none. Paths that lead out of it are
  /// refused.
  std::string file_folder;
  ObjectQueries* queries = nullptr;  ///< null: none is answered
  Limits limits;
  /// Gets what #debug, #render and #statistics say; null: it is dropped.
  std::function<void(const std::string&)> said;

  /// Where packages of POV-Ray put its include files.
  static std::vector<std::string> default_library_folders();
};

/// Reads the scene at `path`. Throws Error, which names file, line, column and the macros on the way.
Document read_pov(const std::string& path, const ReadOptions& options = {});

/// The option of commands that allows #fopen, for messages.
inline constexpr const char* kFileFolderOption = "--files";

/// The value of a function with one value, as expressions of the scene compute it. Throws Error if it has
/// none, or takes more steps.
double evaluate(const Function& function, std::span<const double> arguments, ObjectQueries* queries,
                std::uint64_t most_steps = std::uint64_t{1} << 40);

/// The value of a spline. POV-Ray's cubic splines have the mean slope of both neighbours at each point, and
/// stay constant before the second and behind the last point but one; all others stay constant outside.
std::array<double, 5> evaluate(const Spline& spline, double at);

/// Twelve numbers by rows: a point p becomes p * M, with translation in the last row.
using Matrix = std::array<std::array<double, 3>, 4>;

/// The map of `transform { ... }`, or of what stands in any block between translate, rotate, scale, matrix,
/// transform. Throws Error of `document` if it is malformed.
Matrix evaluate_transform(const Block& block, const Document& document);

}  // namespace oktett::pov
