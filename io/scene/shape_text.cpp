#include "io/scene/shape_text.h"

#include <array>
#include <type_traits>
#include <variant>

#include "io/scene/readers.h"
#include "kernels/functions/tape_data.h"
#include "kernels/heights/height_grid.h"

namespace oktett {
namespace {

/// Text in brackets: `text(item)` of each item, parted by commas.
template <class List, class Text>
std::string list_text(const List& list, const Text& text) {
  std::string out = "[";
  for (const auto& item : list) out += (out.size() > 1 ? ", " : "") + text(item);
  return out + "]";
}

std::string polynomial_text(const std::vector<Monomial>& terms) {
  std::string out;
  for (const Monomial& m : terms) {
    out += (out.empty() ? "(" : " + (") + number_text(m.c) + ")";
    const std::uint8_t powers[] = {m.i, m.j, m.k};
    for (std::size_t k = 0; k < 3; ++k)
      if (powers[k] > 0) out += fmt::format("*{}^{}", "xyz"[k], powers[k]);
  }
  return out;
}

std::string source_text(const BlobSource& s) {
  const std::string weight = ", weight: " + number_text(s.weight) + "}";
  if (s.kind == BlobSource::Kind::point) return "{point: " + vector_text(s.at) + weight;
  if (s.kind == BlobSource::Kind::line)
    return "{line: {point: " + vector_text(s.at) + ", direction: " + vector_text(s.direction) + "}" + weight;
  return "{plane: {normal: " + vector_text(s.direction) + ", offset: " + number_text(s.offset) + "}" + weight;
}

/// Which of the parameters that mean something by being left out are given.
template <class T>
bool is_given(const T&, std::string_view) {
  return true;
}
bool is_given(const PolygonShape& s, std::string_view key) { return key != "holes" || !s.holes.empty(); }
bool is_given(const QuadricShape& s, std::string_view key) { return key != "clip" || s.clipped; }
bool is_given(const BlobShape& s, std::string_view key) { return key != "bounds" || s.bounded; }
bool is_given(const ParametricShape& s, std::string_view key) { return key != "clip" || s.cut; }
bool is_given(const MeshShape& s, std::string_view key) {
  return key != "stroke_width" || s.stroke_width > 0;
}
bool is_given(const MetaballsShape& s, std::string_view key) { return key != "balls" || !s.balls.empty(); }
bool is_given(const HeightFieldShape& s, std::string_view key) { return key != "base" || !s.open; }

/// Gathers `key: value` of each parameter of a shape. Those without a member are left to the caller.
template <class Shape>
class ParameterWriter : public ParameterVisitor<ParameterWriter<Shape>> {
 public:
  ParameterWriter(Shape& shape, NormalMethod normals) : shape_(shape), normals_(normals) {
    shape.describe(*this);
  }

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    if constexpr (!std::is_same_v<std::remove_const_t<T>, ByHand>)
      if (parameter.need != Parameter::Need::optional || is_given(shape_, parameter.key))
        add(parameter.key, text(value));
    return false;
  }
  void normals() { describe_normals(*this, normals_); }

  void add(const std::string& key, const std::string& value) {
    text_ += (text_.empty() ? "" : ", ") + key + ": " + value;
  }
  std::string map() const { return "{" + text_ + "}"; }

 private:
  static std::string text(double v) { return number_text(v); }
  static std::string text(std::uint32_t v) { return fmt::format("{}", v); }
  static std::string text(bool v) { return v ? "true" : "false"; }
  static std::string text(const Vec3d& v) { return vector_text(v); }
  static std::string text(const SolidBox& box) { return box_text(box.lo, box.hi); }
  static std::string text(const ClipBox& box) { return box_text(box.lo, box.hi); }
  static std::string text(const std::vector<Monomial>& terms) { return '"' + polynomial_text(terms) + '"'; }
  static std::string text(const FunctionTape& tape) { return '"' + function_text(tape) + '"'; }
  static std::string text(const UvFunction& f) {
    return '"' + function_text(f.tape, kSurfaceVariables) + '"';
  }
  static std::string text(const BezierPatchPoints& patch) { return text(patch.p); }
  static std::string text(const HalfSpace& h) {
    return text(std::array{h.normal.x, h.normal.y, h.normal.z, h.offset});
  }
  static std::string text(const ProfilePoint& p) { return text(std::array{p.radius, p.height}); }
  static std::string text(const SweptSphere& s) {
    return text(std::array{s.center.x, s.center.y, s.center.z, s.radius});
  }
  static std::string text(const PolygonHole& hole) { return text(hole.vertices); }
  static std::string text(const FlatPoint& p) { return text(std::array{p.x, p.z}); }
  static std::string text(const Affine& map) { return transform_text(map); }
  static std::string text(const BlobSource& source) { return source_text(source); }
  static std::string text(const MetaBall& ball) {
    MetaBall copy = ball;
    return ParameterWriter<MetaBall>(copy, NormalMethod::gradient).map();
  }
  template <class T, std::size_t N>
  static std::string text(const T (&list)[N]) {
    return list_text(list, [](const T& item) { return text(item); });
  }
  template <class T, std::size_t N>
  static std::string text(const std::array<T, N>& list) {
    return list_text(list, [](const T& item) { return text(item); });
  }
  template <class T>
  static std::string text(const std::vector<T>& list) {
    return list_text(list, [](const T& item) { return text(item); });
  }
  template <class T>
  static std::string text(const ChoiceOf<T>& choice) {
    for (const Choice<T>& c : choice.choices)
      if (c.value == choice.value) return c.name;
    return "";
  }
  static std::string box_text(const Vec3d& lo, const Vec3d& hi) {
    return "{min: " + vector_text(lo) + ", max: " + vector_text(hi) + "}";
  }

  Shape& shape_;
  NormalMethod normals_;
  std::string text_;
};

template <class T>
std::string map_text(T described) {
  return ParameterWriter<T>(described, NormalMethod::gradient).map();
}

std::string skeleton_text(const Skeleton& skeleton) {
  if (const auto* polygon = std::get_if<PolygonSkeleton>(&skeleton))
    return "polygon: " + list_text(polygon->vertices, vector_text);
  if (const auto* point = std::get_if<PointSkeleton>(&skeleton)) return "point: " + map_text(*point);
  if (const auto* segment = std::get_if<SegmentSkeleton>(&skeleton)) return "segment: " + map_text(*segment);
  return "ellipsoid: " + map_text(std::get<EllipsoidSkeleton>(skeleton));
}

std::string element_text(const FieldElement& element) {
  constexpr const char* kNames[] = {"inverse_square", "gaussian", "quadratic", "rational", "wyvill"};
  const Potential& p = element.potential;
  const bool by_b = p.kind == PotentialKind::gaussian || p.kind == PotentialKind::quadratic;
  std::string out = "{" + skeleton_text(element.skeleton) +
                    ", potential: " + kNames[static_cast<std::size_t>(p.kind)] +
                    (by_b ? ", b: " : ", radius: ") + number_text(p.scale);
  if (p.kind == PotentialKind::rational) out += ", d: " + number_text(p.d);
  return out + ", weight: " + number_text(p.weight) + "}";
}

/// The outermost blend and its list.
std::pair<std::string, std::string> blend_text(const BlobTreeShape& tree) {
  struct Part {
    std::string key, text;  ///< without a key it is an element
    std::string item() const { return key.empty() ? text : "{" + key + ": " + text + "}"; }
  };
  constexpr const char* kKeys[] = {"", "sum", "max", "min", "difference"};
  std::vector<Part> stack;
  for (const Blend& blend : tree.blends) {
    if (blend.op == Blend::Op::element) {
      stack.push_back({"", element_text(tree.elements[blend.element])});
      continue;
    }
    const std::size_t first = stack.size() - blend.count;
    const std::string list =
        list_text(std::span(stack).subspan(first), [](const Part& part) { return part.item(); });
    stack.resize(first);
    stack.push_back({kKeys[static_cast<std::size_t>(blend.op)], list});
  }
  const Part& whole = stack.back();
  return whole.key.empty() ? std::pair<std::string, std::string>{"sum", "[" + whole.text + "]"}
                           : std::pair{whole.key, whole.text};
}

/// What the description of a shape leaves out.
template <class Writer, class T>
void add_by_hand(Writer&, const T&, SideFiles&) {}
template <class Writer>
void add_by_hand(Writer& writer, const MeshShape& shape, SideFiles& files) {
  writer.add("file", '"' + files.mesh(*shape.mesh) + '"');
}
template <class Writer>
void add_by_hand(Writer& writer, const HeightFieldShape& shape, SideFiles& files) {
  writer.add("file", '"' + files.heights(*shape.grid) + '"');
}
template <class Writer>
void add_by_hand(Writer& writer, const MetaballsShape& shape, SideFiles&) {
  if (!shape.elements.empty()) writer.add("elements", list_text(shape.elements, element_text));
}
template <class Writer>
void add_by_hand(Writer& writer, const BlobTreeShape& shape, SideFiles&) {
  const auto [key, list] = blend_text(shape);
  writer.add(key, list);
}

template <class T>
std::string described_text(const char* key, T shape, SideFiles& files,
                           NormalMethod normals = NormalMethod::gradient) {
  if constexpr (std::is_same_v<T, HeightFieldShape>) shape.interpolation = shape.grid->interpolation();
  ParameterWriter<T> writer(shape, normals);
  add_by_hand(writer, shape, files);
  return std::string(key) + ": " + writer.map();
}

/// Finds the key of a shape that has several.
struct KeyFinder {
  const SuperquadricShape& shape;
  const char* key = nullptr;
  void surface(const ShapeInfo& surface, const SuperquadricShape& other) {
    if (other.form == shape.form && other.ratio == shape.ratio) key = surface.key;
  }
};

/// With all balls among the elements if there are any, since a file has one list.
MetaballsShape as_one_list(MetaballsShape shape) {
  if (shape.elements.empty()) return shape;
  std::vector<FieldElement> all;
  for (const MetaBall& b : shape.balls)
    all.push_back({PointSkeleton{b.center}, {PotentialKind::wyvill, b.radius, 1, b.strength}});
  all.insert(all.end(), shape.elements.begin(), shape.elements.end());
  return {shape.iso, {}, std::move(all)};
}

template <class T>
std::string form_text(const T& form, SideFiles& files, NormalMethod normals) {
  using Kind = TurnedProfile::Kind;
  if constexpr (std::is_same_v<T, RevolutionShape>) {
    constexpr Kind kKinds[] = {Kind::spline, Kind::linear, Kind::sor};
    const TurnedProfile profile{form.points, kKinds[static_cast<std::size_t>(form.profile)], form.open};
    return described_text("revolution", profile, files, normals);
  } else if constexpr (std::is_same_v<T, LatheShape>) {
    return described_text("revolution", TurnedProfile{form.points, Kind::bezier, form.open}, files, normals);
  } else if constexpr (std::is_same_v<T, PrismShape>) {
    return described_text("prism", form, files, normals);
  } else if constexpr (std::is_same_v<T, QuadricShape>) {
    return described_text("quadric", form, files, normals);
  } else if constexpr (std::is_same_v<T, SuperquadricShape>) {
    KeyFinder finder{form};
    SuperquadricShape::surfaces(finder);
    return described_text(finder.key, form, files, normals);
  } else if constexpr (std::is_same_v<T, MetaballsShape>) {
    return described_text("metaballs", as_one_list(form), files, normals);
  } else {
    return described_text(T::kShapeInfo.key, form, files, normals);
  }
}

}  // namespace

std::string vector_text(const Vec3d& v) { return list_text(std::array{v.x, v.y, v.z}, number_text); }

std::string transform_text(const Affine& map) {
  std::array<double, 12> rows;
  map.to_rows(rows.data());
  return "{matrix: " + list_text(rows, number_text) + "}";
}

std::string shape_text(const Shape& shape, SideFiles& files) {
  return std::visit(
      [&]<class T>(const T& s) -> std::string {
        if constexpr (std::is_same_v<T, ExactShape>) {
          return std::visit([&](const auto& form) { return form_text(form, files, s.normals); }, s.form);
        } else if constexpr (std::is_same_v<T, SpheresShape>) {
          return "spheres: " +
                 list_text(s.spheres, [](const SphereShape& sphere) { return map_text(sphere); });
        } else if constexpr (requires { T::kShapeInfo; }) {
          return described_text(T::kShapeInfo.key, s, files);
        } else {
          return "";
        }
      },
      shape);
}

}  // namespace oktett
