#pragma once
/// \file Reads what describes its parameters (core/description.h). Within io/ only.
///
/// A value that is more than a number, a choice or a described map has a `read_value(load, node, range,
/// value)` and, for the JSON Schema, a `schema_of(schema, range, value)` (io/scene/schema.h), both found by
/// its type.

#include <fmt/format.h>

#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/description.h"
#include "io/scene/load.h"
#include "kernels/exact_form.h"

namespace oktett {

/// Calls v.surface(surface, shape) for each shape of scene files that describes its parameters.
template <class V, class... T>
void visit_surfaces_of(V& v, std::type_identity<std::variant<T...>>) {
  const auto visit = [&]<class S>(std::type_identity<S>) {
    if constexpr (requires { S::kShapeInfo; })
      v.surface(S::kShapeInfo, S{});
    else if constexpr (requires { S::surfaces(v); })
      S::surfaces(v);
  };
  (visit(std::type_identity<T>{}), ...);
}
void visit_surfaces(auto& v) {
  visit_surfaces_of(v, std::type_identity<Shape::variant>{});
  visit_surfaces_of(v, std::type_identity<ExactForm::variant>{});
}

/// The keys of what is described.
class KeyList : public ParameterVisitor<KeyList> {
 public:
  template <class T>
  explicit KeyList(T described) {
    described.describe(*this);
  }
  template <class T>
  bool visit(const Parameter& parameter, T&) {
    keys.push_back(parameter.key);
    return false;
  }
  void normals() { keys.push_back("normals"); }

  std::vector<const char*> keys;
};

template <class T>
concept Described = requires(T& value, KeyList& keys) {
  value.describe(keys);
};
template <class T>
concept HasReader = requires(SceneLoad& load, const YamlNode& node, const Range& range, T& value) {
  read_value(load, node, range, value);
};

/// What a described map is called: T::kMap, else its key.
template <class T>
const char* map_name(const char* key) {
  if constexpr (requires { T::kMap; })
    return T::kMap;
  else
    return key;
}

/// A function of x, y and z, or of other variables.
FunctionTape read_function(SceneLoad& load, const YamlNode& node,
                           std::span<const std::string_view> variables = kSpaceVariables);

// Items of lists. Each returns whether the item is kept; it warns of those that are not.
bool read_item(SceneLoad& load, const YamlNode& node, Vec3d& point);
bool read_item(SceneLoad& load, const YamlNode& node, PolygonHole& hole);
bool read_item(SceneLoad& load, const YamlNode& node, Color& color);
bool read_item(SceneLoad& load, const YamlNode& node, HalfSpace& plane);
bool read_item(SceneLoad& load, const YamlNode& node, ProfilePoint& point);
bool read_item(SceneLoad& load, const YamlNode& node, PlaneOutline& outline);
bool read_item(SceneLoad& load, const YamlNode& node, SweptSphere& sphere);
bool read_item(SceneLoad& load, const YamlNode& node, BezierPatchPoints& patch);
bool read_item(SceneLoad& load, const YamlNode& node, Affine& map);
bool read_item(SceneLoad& load, const YamlNode& node, BlobSource& source);
bool read_item(SceneLoad& load, const YamlNode& node, MetaBall& ball);

/// Reads the values of the fields of a map into the members that they describe.
class ParameterReader : public ParameterVisitor<ParameterReader> {
 public:
  ParameterReader(SceneLoad& load, const YamlNode& node, const Fields& fields)
      : load_(load), node_(node), fields_(fields) {}

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    const bool required = parameter.need == Parameter::Need::required;
    const YamlNode* const node = required ? &fields_.require(parameter.key) : fields_[parameter.key];
    if (!node) return false;
    last_ = node;
    if (node->missing) is_wrong_ = true;
    ErrorList* const errors = node->file->errors;
    const std::size_t before = errors ? errors->failures() : 0;
    attempt(*node, [&] { read(*node, parameter, value); });
    if (errors && errors->failures() != before) is_wrong_ = true;
    return true;
  }
  /// Where errors are gathered: whether some value was wrong and is made up, or missing.
  bool is_wrong() const { return is_wrong_; }
  void normals() { describe_normals(*this, normal_method); }
  void check(bool ok, const char* key, const char* message, const double* found = nullptr) const;
  void one_of(std::initializer_list<const char*> keys, const char* message = nullptr) const;
  void not_both(const char* a, const char* b, const char* message = nullptr, const char* at = nullptr) const;
  void nothing_if(bool is_empty, const char* reason) {
    if (is_empty && !why_nothing && !is_wrong_) why_nothing = reason;
  }

  NormalMethod normal_method = NormalMethod::gradient;
  const char* why_nothing = nullptr;  ///< why the shape has no points, if so

 private:
  void read(const YamlNode& node, const Parameter& parameter, double& value) {
    value = load_.values.number(node, parameter.range);
  }
  void read(const YamlNode& node, const Parameter& parameter, float& value) {
    value = load_.values.single(node, parameter.range);
  }
  void read(const YamlNode& node, const Parameter& parameter, std::uint32_t& value);
  void read(const YamlNode& node, const Parameter&, bool& value) { value = load_.values.boolean(node); }
  void read(const YamlNode& node, const Parameter&, Color& value) { value = load_.values.color(node); }
  void read(const YamlNode& node, const Parameter& parameter, Vec3d& value);
  void read(const YamlNode& node, const Parameter& parameter, std::span<double> values) {
    load_.values.numbers(node, values, parameter.range);
  }
  void read(const YamlNode& node, const Parameter& parameter, std::span<Vec3d> points);
  void read(const YamlNode& node, const Parameter& parameter, std::vector<Monomial>& terms);
  void read(const YamlNode& node, const Parameter&, FunctionTape& f) { f = read_function(load_, node); }
  void read(const YamlNode& node, const Parameter&, UvFunction& f) {
    f.tape = read_function(load_, node, kSurfaceVariables);
  }
  void read(const YamlNode&, const Parameter&, const ByHand&) {}
  template <class T>
  void read(const YamlNode& node, const Parameter&, ChoiceOf<T>& choice) {
    choice.value = load_.values.choice<T>(node, choice.choices);
  }
  template <class T>
  void read(const YamlNode& node, const Parameter& parameter, std::vector<T>& list) {
    list.clear();
    for (const YamlNode* item : items_of(node, parameter)) {
      T value{};
      bool keep = false;
      attempt(*item, [&] { keep = read_item(load_, *item, value); });
      if (keep) list.push_back(std::move(value));
    }
  }
  template <class T>
  requires HasReader<T> || Described<T>
  void read(const YamlNode& node, const Parameter& parameter, T& value);
  /// The items of a list whose length is checked.
  static std::span<const YamlNode* const> items_of(const YamlNode& node, const Parameter& parameter);

  SceneLoad& load_;
  const YamlNode& node_;
  const Fields& fields_;
  const YamlNode* last_ = nullptr;  ///< the value that was read last
  bool is_wrong_ = false;
};

/// Reads a map of parameters; `what` names it. Returns its fields, for what the description does not say.
template <class T>
Fields read_described(SceneLoad& load, const YamlNode& node, const char* what, T& value) {
  static const KeyList known{value};
  Fields fields(node, what, known.keys);
  ParameterReader reader(load, node, fields);
  value.describe(reader);
  return fields;
}

template <class T>
requires HasReader<T> || Described<T>
void ParameterReader::read(const YamlNode& node, const Parameter& parameter, T& value) {
  if constexpr (HasReader<T>)
    read_value(load_, node, parameter.range, value);
  else
    read_described(load_, node, map_name<T>(parameter.key), value);
}

}  // namespace oktett
