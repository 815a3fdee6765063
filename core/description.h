#pragma once
/// \file How a shape describes its parameters: once, beside its data. The reader of scene files, the table in
/// docs/scene-format.md and the random cases of verification are made from these descriptions.
///
/// A data struct has
/// - `void describe(auto& p)`, which visits its parameters in order, e.g. `p.field("radius", radius, kLength,
///   "distance of the surface from the centre")`, see ParameterVisitor. The default of a parameter is the
///   value that its member has before the visit;
/// - `kSurface`, its key in scene files. A struct with several keys has
///   `static void surfaces(auto& v)` instead, which calls `v.surface(key, shape)` for each, with the values
///   that it starts from.

#include <cstdint>
#include <initializer_list>

#include "core/vec3.h"

namespace oktett {

/// Greatest magnitude of a coordinate or length: its square still fits a float.
inline constexpr double kMaxCoordinate = 1e18;

enum class Unit : std::uint8_t { none, length, degrees };

/// The numbers that are allowed.
struct Range {
  double lo = -kMaxCoordinate;
  double hi = kMaxCoordinate;
  bool lo_open = false;  ///< `lo` itself is not allowed
  bool hi_open = false;
  Unit unit = Unit::none;

  constexpr bool contains(double value) const {
    return (lo_open ? value > lo : value >= lo) && (hi_open ? value < hi : value <= hi);
  }
};

inline constexpr Range kAnyNumber{};
inline constexpr Range kNonNegative{0, kMaxCoordinate};
inline constexpr Range kPositive{0, kMaxCoordinate, true};
inline constexpr Range kUnitInterval{0, 1};
inline constexpr Range kCoordinate{-kMaxCoordinate, kMaxCoordinate, false, false, Unit::length};
inline constexpr Range kLength{0, kMaxCoordinate, false, false, Unit::length};
inline constexpr Range kPositiveLength{0, kMaxCoordinate, true, false, Unit::length};
inline constexpr Range kAngle{-kMaxCoordinate, kMaxCoordinate, false, false, Unit::degrees};
/// Whole numbers, or how many items a list may have.
constexpr Range whole(std::uint32_t lo, std::uint32_t hi) {
  return {static_cast<double>(lo), static_cast<double>(hi)};
}

/// A shape of scene files.
struct Surface {
  const char* key;
  const char* meaning;  ///< one line
};

/// What is said of one parameter.
struct Parameter {
  enum class Need : std::uint8_t {
    required,
    defaulted,  ///< may be left out: it keeps the value that it has
    optional,   ///< may be left out, which means something else than any value
  };
  const char* key;
  const char* meaning;  ///< one line
  Range range;          ///< of each number, or of the length of a list
  Need need;
};

/// One of a list of words.
template <class T>
struct Choice {
  const char* name;
  T value;
};
template <class T>
struct ChoiceOf {
  T& value;
  std::initializer_list<Choice<T>> choices;
};

/// A box {min, max} with an inside; both are needed.
struct SolidBox {
  Vec3d &lo, &hi;
};
/// A box {min, max}, either of which may be left out. One without volume cuts everything away.
struct ClipBox {
  Vec3d &lo, &hi;
};
/// A value that has no member of its own: whoever reads the shape reads it, too.
struct ByHand {
  const char* type;            ///< in Markdown
  const char* usual = "none";  ///< the default
};

/// What `describe` is called with. `Self` has `visit(const Parameter&, value)`, with a reference to a member
/// or one of the types above; it returns whether the parameter is given. It may hide `check` and
/// `nothing_if`.
template <class Self>
class ParameterVisitor {
 public:
  void field(const char* key, auto&& value, const Range& range, const char* meaning) {
    self().visit(Parameter{key, meaning, range, Parameter::Need::defaulted}, value);
  }
  void required(const char* key, auto&& value, const Range& range, const char* meaning) {
    self().visit(Parameter{key, meaning, range, Parameter::Need::required}, value);
  }
  /// Returns whether it is given.
  bool optional(const char* key, auto&& value, const Range& range, const char* meaning) {
    return self().visit(Parameter{key, meaning, range, Parameter::Need::optional}, value);
  }
  // The same for what is no number or has no limits.
  void field(const char* key, auto&& value, const char* text) { field(key, value, kAnyNumber, text); }
  void required(const char* key, auto&& value, const char* text) { required(key, value, kAnyNumber, text); }
  bool optional(const char* key, auto&& value, const char* text) {
    return optional(key, value, kAnyNumber, text);
  }
  template <class T>
  void choice(const char* key, T& value, std::initializer_list<Choice<T>> choices, const char* meaning) {
    field(key, ChoiceOf<T>{value, choices}, meaning);
  }
  /// Makes it an error at the value of `key` (of the whole map for null) if not `ok`; ", found `found`"
  /// follows the message if that is given.
  void check(bool /*ok*/, const char* /*key*/, const char* /*message*/, const double* /*found*/ = nullptr) {}
  /// Says that the shape has no points if `is_empty`, and why. It is left out with a warning.
  void nothing_if(bool /*is_empty*/, const char* /*reason*/) {}

 private:
  Self& self() { return static_cast<Self&>(*this); }
};

}  // namespace oktett
