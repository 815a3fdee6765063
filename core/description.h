#pragma once
/// \file How shapes, lights, settings and all else of a scene describe their parameters: once, beside the
/// data. The reader of scene files, their JSON Schema, the tables in docs/scene-format.md and the random
/// cases of verification are made from these descriptions.
///
/// A data struct has
/// - `void describe(auto& p)`, which visits its parameters in order, e.g. `p.field("radius", radius, kLength,
///   "distance of the surface from the centre")`, see ParameterVisitor. The default of a parameter is the
///   value that its member has before the visit;
/// - `kShapeInfo`, of a shape, its key in scene files. A struct with several keys has
///   `static void surfaces(auto& v)` instead, which calls `v.surface(key, shape)` for each, with the values
///   that it starts from;
/// - `kMap`, if it is no shape and is called otherwise than its key, such as "a medium".

#include <cstdint>
#include <initializer_list>
#include <span>
#include <type_traits>

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

/// Seeds of random numbers.
inline constexpr Range kAnySeed = whole(0, 0xffffffff);

/// A shape of scene files.
struct ShapeInfo {
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
  std::span<const Choice<T>> choices;
};

/// A box {min, max} with an inside; both are needed.
struct SolidBox {
  Vec3d &lo, &hi;

  void describe(auto& p) {
    p.required("min", lo, kCoordinate, "the corner of least x, y and z");
    p.required("max", hi, kCoordinate, "the corner of greatest x, y and z");
    p.check(lo.x < hi.x, "max", "the x of max must be greater than that of min");
    p.check(lo.y < hi.y, "max", "the y of max must be greater than that of min");
    p.check(lo.z < hi.z, "max", "the z of max must be greater than that of min");
  }
};
/// A box {min, max}, either of which may be left out. One without volume cuts everything away.
struct ClipBox {
  Vec3d &lo, &hi;

  void describe(auto& p) {
    p.optional("min", lo, kCoordinate, "the corner of least x, y and z");
    p.optional("max", hi, kCoordinate, "the corner of greatest x, y and z");
    p.check(lo.x <= hi.x, "max", "the clip box has min > max along x");
    p.check(lo.y <= hi.y, "max", "the clip box has min > max along y");
    p.check(lo.z <= hi.z, "max", "the clip box has min > max along z");
  }
};
/// A value that has no member of its own: whoever reads the shape reads it, too.
struct ByHand {
  const char* type;            ///< in Markdown
  const char* form;            ///< its definition in the JSON Schema
  const char* usual = "none";  ///< the default
};

/// What `describe` is called with. `Self` has `visit(const Parameter&, value)`, with a reference to a member
/// or one of the types above; it returns whether the parameter is given, as all that visit one do. It may
/// hide what stands below `choice`.
template <class Self>
class ParameterVisitor {
 public:
  bool field(const char* key, auto&& value, const Range& range, const char* meaning) {
    return self().visit(Parameter{key, meaning, range, Parameter::Need::defaulted}, value);
  }
  void required(const char* key, auto&& value, const Range& range, const char* meaning) {
    self().visit(Parameter{key, meaning, range, Parameter::Need::required}, value);
  }
  bool optional(const char* key, auto&& value, const Range& range, const char* meaning) {
    return self().visit(Parameter{key, meaning, range, Parameter::Need::optional}, value);
  }
  // The same for what is no number or has no limits.
  bool field(const char* key, auto&& value, const char* text) { return field(key, value, kAnyNumber, text); }
  void required(const char* key, auto&& value, const char* text) { required(key, value, kAnyNumber, text); }
  bool optional(const char* key, auto&& value, const char* text) {
    return optional(key, value, kAnyNumber, text);
  }
  template <class T>
  bool choice(const char* key, T& value, std::type_identity_t<std::span<const Choice<T>>> choices,
              const char* meaning) {
    return field(key, ChoiceOf<T>{value, choices}, meaning);
  }
  template <class T>
  bool choice(const char* key, T& value, std::initializer_list<Choice<T>> choices, const char* meaning) {
    return choice(key, value, std::span<const Choice<T>>(choices.begin(), choices.size()), meaning);
  }
  /// Exactly one of the keys is given. If it has a message, the reader sees to that; else who goes on with
  /// the values does.
  void one_of(std::initializer_list<const char*> /*keys*/, const char* /*message*/ = nullptr) {}
  /// At most one of both is given, else it is an error at the value of `at`, of the whole map for null. The
  /// message may be left out.
  void not_both(const char* /*a*/, const char* /*b*/, const char* /*message*/ = nullptr,
                const char* /*at*/ = nullptr) {}
  /// Makes it an error at the value of `key` (of the whole map for null) if not `ok`; ", found `found`"
  /// follows the message if that is given.
  void check(bool /*ok*/, const char* /*key*/, const char* /*message*/, const double* /*found*/ = nullptr) {}
  /// Says that the shape has no points if `is_empty`, and why. It is left out with a warning.
  void nothing_if(bool /*is_empty*/, const char* /*reason*/) {}

 private:
  Self& self() { return static_cast<Self&>(*this); }
};

}  // namespace oktett
