#include "io/scene/described.h"

#include <algorithm>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"
#include "kernels/exact/polynomial_expression.h"
#include "kernels/fractals/ifs.h"
#include "kernels/functions/function_tape.h"

namespace oktett {
namespace {

/// Throws what is wrong with a text such as an equation, found in `error`, whose column counts bytes in
/// `text`, at its place in the file, and shows it. `text` is what `node` stands for.
[[noreturn]] void fail_in_text(const char* what, const YamlNode& node, const std::string& text,
                               const Error& error) {
  const auto at = std::min(static_cast<std::size_t>(error.where().column) - 1, text.size());
  std::string message = fmt::format("bad {}: {} (column {})", what, error.what(), error.where().column);
  // The part of a long text around the place.
  const std::size_t begin = at > 100 ? at - 100 : 0, length = std::min<std::size_t>(text.size() - begin, 200);
  if (text.find('\n') == std::string::npos && character_count(text) == text.size())
    message += fmt::format("\n  {}\n  {}^", text.substr(begin, length), std::string(at - begin, ' '));
  throw Error(text == node.text ? node.where(at) : node.where(), message);
}

constexpr const char* kNoDirection = "the direction must not be zero";

struct BlobLine {
  Vec3d at{0, 0, 0}, direction{0, 1, 0};

  void describe(auto& p) {
    p.field("point", at, "a point on it");
    p.required("direction", direction, "of any length but zero");
    p.check(length(direction) > 0, "direction", kNoDirection);
  }
};

struct BlobPlane {
  Vec3d normal{0, 1, 0};
  double offset = 0;

  void describe(auto& p) {
    p.required("normal", normal, "of any length but zero");
    p.field("offset", offset, "distance from the origin along the unit normal");
    p.check(length(normal) > 0, "normal", kNoDirection);
  }
};

struct BlobSourceKeys {
  BlobSource source;
  BlobLine line;
  BlobPlane plane;

  static constexpr const char* kMap = "a source";
  void describe(auto& p) {
    using Kind = BlobSource::Kind;
    p.one_of({"point", "line", "plane"}, "a source is one of 'point', 'line' and 'plane'");
    if (p.optional("point", source.at, "a point")) source.kind = Kind::point;
    if (p.optional("line", line, "an endless line")) {
      source.kind = Kind::line;
      source.at = line.at;
      source.direction = line.direction;
    }
    if (p.optional("plane", plane, "an endless plane")) {
      source.kind = Kind::plane;
      source.direction = plane.normal;
      source.offset = plane.offset;
    }
    p.field("weight", source.weight, "of either sign");
  }
};

}  // namespace

void ParameterReader::check(bool ok, const char* key, const char* message, const double* found) const {
  if (ok || why_nothing || is_wrong_) return;
  const YamlNode* value = key ? fields_[key] : &node_;
  if (!value) value = last_ ? last_ : &node_;
  throw Error(value->where(), found ? fmt::format("{}, found {:.6g}", message, *found) : message);
}

void ParameterReader::one_of(std::initializer_list<const char*> keys, const char* message) const {
  const auto given = std::ranges::count_if(keys, [&](const char* key) { return fields_[key] != nullptr; });
  if (message != nullptr && given != 1) throw Error(node_.where(), message);
}

void ParameterReader::not_both(const char* a, const char* b, const char* message, const char* at) const {
  if (fields_[a] == nullptr || fields_[b] == nullptr) return;
  throw Error((at ? *fields_[at] : node_).where(),
              message ? message : fmt::format("expected '{}' or '{}', not both", a, b));
}

void ParameterReader::read(const YamlNode& node, const Parameter& parameter, std::uint32_t& value) {
  value = load_.values.integer(node, static_cast<std::uint32_t>(parameter.range.lo),
                               static_cast<std::uint32_t>(parameter.range.hi));
}

void ParameterReader::read(const YamlNode& node, const Parameter& parameter, Vec3d& value) {
  const bool may_be_zero = parameter.range.contains(0);
  double v[3];
  load_.values.numbers(node, v, may_be_zero ? kAnyNumber : parameter.range);
  for (const double x : v)
    if (!parameter.range.contains(x))
      throw Error(node.where(), fmt::format("the {} must not be negative", parameter.key));
  value = {v[0], v[1], v[2]};
}

void ParameterReader::read(const YamlNode& node, const Parameter& parameter, std::span<Vec3d> points) {
  const auto items = items_of(node, parameter);
  for (std::size_t i = 0; i < std::min(points.size(), items.size()); ++i)
    points[i] = load_.values.vector(*items[i]);
}

void ParameterReader::read(const YamlNode& node, const Parameter&, std::vector<Monomial>& terms) {
  const std::string text = load_.values.text(node);
  try {
    terms = expand_polynomial(text);
  } catch (const Error& e) {
    fail_in_text("equation", node, text, e);
  }
}

std::span<const YamlNode* const> ParameterReader::items_of(const YamlNode& node, const Parameter& parameter) {
  const auto items = list_items(node, parameter.key);
  const Range& counts = parameter.range;
  if (counts.contains(static_cast<double>(items.size()))) return items;
  const std::string expected = counts.lo == counts.hi ? fmt::format("{}", counts.lo)
                               : counts.lo == 0       ? fmt::format("at most {}", counts.hi)
                                                      : fmt::format("{} to {}", counts.lo, counts.hi);
  throw Error(node.where(), fmt::format("expected {} {}, found {}", expected, parameter.key, items.size()));
}

bool read_item(SceneLoad& load, const YamlNode& node, Vec3d& point) {
  point = load.values.vector(node);
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, PolygonHole& hole) {
  std::vector<Vec3d>& points = hole.vertices;
  for (const YamlNode* item : list_items(node, "points"))
    attempt(*item, [&] { points.push_back(load.values.vector(*item)); });
  if (points.size() < 3 || points.size() > kMaxPolygonVertices)
    throw Error(node.where(),
                fmt::format("expected 3 to {} points, found {}", kMaxPolygonVertices, points.size()));
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, HalfSpace& plane) {
  double p[4];
  load.values.numbers(node, p);
  plane = {{p[0], p[1], p[2]}, p[3]};
  if (!(length(plane.normal) > 0)) throw Error(node.where(), "the normal of a plane must not be zero");
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, ProfilePoint& point) {
  double p[2];
  load.values.numbers(node, p);
  point = {p[0], p[1]};
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, SweptSphere& sphere) {
  double p[4];
  load.values.numbers(node, p);
  if (p[3] < 0) throw Error(node.where(), "the radius of a sphere must not be negative");
  sphere = {{p[0], p[1], p[2]}, p[3]};
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, BezierPatchPoints& patch) {
  const auto items = list_items(node, "patches");
  if (items.size() != std::size(patch.p))
    throw Error(node.where(), fmt::format("expected 16 points, found {}", items.size()));
  for (std::size_t k = 0; k < items.size(); ++k)
    attempt(*items[k], [&] { patch.p[k] = load.values.vector(*items[k]); });
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, PlaneOutline& outline) {
  const auto items = list_items(node, "outlines");
  if (items.empty() || items.size() > kMaxOutlinePoints)
    throw Error(node.where(),
                fmt::format("expected 1 to {} points, found {}", kMaxOutlinePoints, items.size()));
  for (const YamlNode* item : items) {
    attempt(*item, [&] {
      double p[2];
      load.values.numbers(*item, p);
      outline.push_back({p[0], p[1]});
    });
  }
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, Color& color) {
  color = load.values.color(node);
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, Affine& map) {
  read_value(load, node, kAnyNumber, map);
  if (!map.is_invertible()) throw Error(node.where(), "expected a map with an inverse, found a singular one");
  if (const double norm = Ifs::norm(map); !(norm < 1))
    throw Error(
        node.where(),
        fmt::format("expected a contraction, found a map that makes lengths up to {:.6g} times as long",
                    norm));
  return true;
}

bool read_item(SceneLoad& load, const YamlNode& node, BlobSource& source) {
  BlobSourceKeys keys;
  read_described(load, node, keys.kMap, keys);
  source = keys.source;
  if (source.weight == 0) load.warn(node.where(), "the weight is zero; the source is skipped");
  return source.weight != 0;
}

std::string schema_of(Schema& schema, const Range&, const BlobSource&) {
  return schema.map(BlobSourceKeys::kMap, BlobSourceKeys{});
}

bool read_item(SceneLoad& load, const YamlNode& node, MetaBall& ball) {
  read_described(load, node, MetaBall::kMap, ball);
  return true;
}

FunctionTape read_function(SceneLoad& load, const YamlNode& node,
                           std::span<const std::string_view> variables) {
  const std::string text = load.values.text(node);
  try {
    return compile_function(text, variables);
  } catch (const Error& e) {
    fail_in_text("function", node, text, e);
  }
}

}  // namespace oktett
