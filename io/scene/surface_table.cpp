#include "io/scene/surface_table.h"

#include <fmt/format.h>

#include <concepts>
#include <string_view>

#include "io/scene/readers.h"
#include "io/scene/schema.h"

namespace oktett {
namespace {

using Type = DescribedParameter::Type;

/// What a value may be, in Markdown.
std::string allowed(const Range& range, double) {
  return describe(range, range.unit == Unit::degrees                   ? "angle"
                         : range.unit == Unit::length && range.lo >= 0 ? "length"
                                                                       : "number");
}
std::string allowed(const Range& range, std::uint32_t) { return describe(range, "whole number"); }
std::string allowed(const Range&, std::same_as<bool> auto) { return "flag"; }
std::string allowed(const Range& range, const Vec3d&) {
  if (range.unit == Unit::degrees) return "3 angles";
  if (range.lo >= 0) return "3 lengths, each " + describe(range, "").substr(1);
  return range.unit == Unit::length ? "point" : "vector";
}
std::string allowed(const Range&, std::span<const double> x) { return fmt::format("{} numbers", x.size()); }
std::string allowed(const Range&, std::span<const Vec3d> x) { return fmt::format("{} points", x.size()); }
std::string allowed(const Range&, const std::vector<Monomial>&) {
  return "polynomial in x, y and z of degree 1 to 32: numbers, `+ - * / ^`, parentheses and functions of "
         "numbers; with `=` the right side is subtracted. What is multiplied out must stay below a million "
         "products of terms";
}
std::string allowed(const Range&, const FunctionTape&) { return "[expression](#values) in x, y and z"; }
std::string allowed(const Range&, const UvFunction&) { return "[expression](#values) in u and v"; }
std::string allowed(const Range&, const SolidBox&) { return "`{min, max}`, two points"; }
std::string allowed(const Range&, const ClipBox& box) { return '`' + written(box) + '`'; }
std::string allowed(const Range&, const TextureIndex&) { return "[texture](#textures)"; }
std::string allowed(const Range&, const VoxelFile&) { return "file of [densities](#media)"; }
std::string allowed(const Range&, const PatternColor&) { return "color, number or [texture](#textures)"; }
std::string allowed(const Range&, const ByHand& value) { return value.type; }
template <class T>
std::string allowed(const Range&, const ChoiceOf<T>& choice) {
  std::string words;
  for (const Choice<T>& c : choice.choices) {
    const bool last = &c == &choice.choices.back();
    words += fmt::format("{}`{}`", words.empty() ? "" : last ? " or " : ", ", c.name);
  }
  return words;
}

/// The items of a list.
std::string items(const Vec3d&) { return "points"; }
std::string items(const PolygonHole&) { return "lists of points"; }
std::string items(const HalfSpace&) { return "`[nx, ny, nz, d]`"; }
std::string items(const ProfilePoint&) { return "`[radius, height]`"; }
std::string items(const SweptSphere&) { return "`[x, y, z, radius]`"; }
std::string items(const BezierPatchPoints&) { return "lists of 16 points"; }
std::string items(const PlaneOutline&) { return "lists of points, 2 numbers each"; }
std::string items(const Affine&) { return "[transforms](#transforms)"; }
std::string items(const BlobSource& source) {
  return fmt::format(
      "`{{point: [x, y, z]}}`, `{{line: {{point: {}, direction}}}}` or `{{plane: {{normal, offset: "
      "{:g}}}}}`, each with "
      "`weight: {:g}`",
      written(source.at), source.offset, source.weight);
}
std::string items(MetaBall ball);
template <class T>
std::string allowed(const Range& counts, const std::vector<T>&) {
  const std::string number =
      counts.lo > 0 ? fmt::format("{} to {}", counts.lo, counts.hi) : fmt::format("at most {}", counts.hi);
  return fmt::format("list of {} {}", number, items(T{}));
}

class ParameterList : public ParameterVisitor<ParameterList> {
 public:
  explicit ParameterList(std::vector<DescribedParameter>& list) : list_(list) {}

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    const Type type = std::is_same_v<T, double>          ? Type::number
                      : std::is_same_v<T, std::uint32_t> ? Type::whole_number
                                                         : Type::other;
    list_.push_back({parameter, type, allowed(parameter.range, value), usual_value(parameter, value)});
    return false;
  }
  void normals() {
    NormalMethod method = NormalMethod::gradient;
    describe_normals(*this, method);
  }

 private:
  std::vector<DescribedParameter>& list_;
};

std::string items(MetaBall ball) {
  std::vector<DescribedParameter> list;
  ParameterList visitor(list);
  ball.describe(visitor);
  std::string text;
  for (const DescribedParameter& p : list)
    text += fmt::format("{}{}: {}", text.empty() ? "`{" : ", ", p.parameter.key, p.usual);
  return text + "}`";
}

struct SurfaceList {
  std::vector<DescribedSurface> list;

  void surface(const ShapeInfo& surface, auto shape) {
    DescribedSurface& entry = list.emplace_back(DescribedSurface{surface, {}});
    ParameterList visitor(entry.parameters);
    shape.describe(visitor);
  }
};

}  // namespace

bool DescribedParameter::operator==(const DescribedParameter& other) const {
  return std::string_view(parameter.key) == other.parameter.key &&
         std::string_view(parameter.meaning) == other.parameter.meaning && text == other.text &&
         usual == other.usual;
}

std::vector<DescribedSurface> described_surfaces() {
  SurfaceList all;
  visit_surfaces(all);
  return std::move(all.list);
}

std::vector<DescribedSurface> described_patterns() {
  SurfaceList all;
  visit_patterns([&](auto pattern) { all.surface(decltype(pattern)::kShapeInfo, pattern); });
  return std::move(all.list);
}

std::string pattern_table() {
  std::string table = "| pattern | key | value | default | meaning |\n|---|---|---|---|---|\n";
  for (const DescribedSurface& pattern : described_patterns()) {
    table += fmt::format("| **`{}`** | | | | {} |\n", pattern.surface.key, pattern.surface.meaning);
    for (const DescribedParameter& p : pattern.parameters)
      table += fmt::format("| | `{}` | {} | {} | {} |\n", p.parameter.key, p.text,
                           p.usual == "required" ? p.usual : '`' + p.usual + '`', p.parameter.meaning);
  }
  return table;
}

std::string surface_table() {
  std::string table = "| shape | key | value | default | meaning |\n|---|---|---|---|---|\n";
  std::string with_normals, normals;
  const std::vector<DescribedSurface> all = described_surfaces();
  for (std::size_t i = 0; i < all.size(); ++i) {
    table += fmt::format("| **`{}`** | | | | {} |\n", all[i].surface.key, all[i].surface.meaning);
    const bool shares = i + 1 < all.size() && all[i].parameters == all[i + 1].parameters;
    for (const DescribedParameter& p : all[i].parameters) {
      const bool is_word = p.usual == "required" || p.usual == "none";
      const std::string row = fmt::format("| | `{}` | {} | {} | {} |\n", p.parameter.key, p.text,
                                          is_word ? p.usual : '`' + p.usual + '`', p.parameter.meaning);
      if (p.parameter.key == std::string_view("normals"))
        with_normals += fmt::format("{}`{}`", with_normals.empty() ? "" : ", ", all[i].surface.key),
            normals = row;
      else if (!shares)
        table += row;
    }
  }
  return table + fmt::format("| {} | | | | one more key: |\n", with_normals) + normals;
}

}  // namespace oktett
