/// \file Polynomials, blobs of inverse squares and surfaces of revolution in scene files.

#include <fmt/format.h>

#include <algorithm>

#include "io/scene/exact.h"
#include "kernels/exact/blob.h"
#include "kernels/exact/lathe.h"
#include "kernels/exact/polynomial_expression.h"
#include "kernels/exact/revolution.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

/// Most points of a profile.
constexpr std::size_t kMaxProfilePoints = 1024;

void read_root_finder(SceneLoad& load, const YamlNode* node, roots::Method& method) {
  using roots::Method;
  if (node)
    method = load.values.choice<Method>(*node, {{"auto", Method::automatic},
                                                {"closed", Method::closed},
                                                {"bernstein", Method::bernstein},
                                                {"sturm", Method::sturm},
                                                {"laguerre", Method::laguerre},
                                                {"bisection", Method::bisection},
                                                {"newton", Method::newton}});
}

std::vector<Monomial> read_equation(SceneLoad& load, const YamlNode& node) {
  const std::string text = load.values.text(node);
  try {
    return expand_polynomial(text);
  } catch (const Error& e) {
    fail_in_text("equation", node, text, e);
  }
}

MaybeForm read_polynomial(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "polynomial", {"equation", "bounds", "open", "root_finder", "normals"});
  PolynomialShape shape;
  shape.terms = read_equation(load, fields.require("equation"));
  read_bounds(load, fields.require("bounds"), shape.lo, shape.hi);
  load.values.read(fields["open"], shape.open);
  read_root_finder(load, fields["root_finder"], shape.root_finder);
  const bool varies = std::any_of(shape.terms.begin(), shape.terms.end(),
                                  [](const Monomial& m) { return m.i + m.j + m.k > 0; });
  if (!varies) return skip_exact(load, key, "the equation does not depend on x, y or z");
  return shape;
}

BlobSource read_source(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a source", {"point", "line", "plane", "weight"});
  BlobSource source;
  load.values.read(fields["weight"], source.weight);
  const YamlNode *point = fields["point"], *line = fields["line"], *plane = fields["plane"];
  if ((point != nullptr) + (line != nullptr) + (plane != nullptr) != 1)
    throw Error(node.where(), "a source is one of 'point', 'line' and 'plane'");
  if (point) {
    source.kind = BlobSource::Kind::point;
    source.at = load.values.vector(*point);
    return source;
  }
  const YamlNode* direction;
  if (line) {
    const Fields of(*line, "line", {"point", "direction"});
    source.kind = BlobSource::Kind::line;
    load.values.read(of["point"], source.at);
    direction = &of.require("direction");
  } else {
    const Fields of(*plane, "plane", {"normal", "offset"});
    source.kind = BlobSource::Kind::plane;
    direction = &of.require("normal");
    load.values.read(of["offset"], source.offset);
  }
  source.direction = load.values.vector(*direction);
  if (!(length(source.direction) > 0)) throw Error(direction->where(), "the direction must not be zero");
  return source;
}

MaybeForm read_blob(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "blob", {"sources", "iso", "bounds", "open", "root_finder", "normals"});
  BlobShape shape;
  const YamlNode& sources = fields.require("sources");
  const auto items = list_items(sources, "sources");
  if (items.empty() || items.size() > kMaxBlobSources)
    throw Error(sources.where(),
                fmt::format("expected 1 to {} sources, found {}", kMaxBlobSources, items.size()));
  for (const YamlNode* item : items) {
    shape.sources.push_back(read_source(load, *item));
    if (shape.sources.back().weight != 0) continue;
    load.warn(item->where(), "the weight is zero; the source is skipped");
    shape.sources.pop_back();
  }
  load.values.read(fields["iso"], shape.iso, kPositive);
  if (const YamlNode* bounds = fields["bounds"]) {
    shape.bounded = true;
    read_bounds(load, *bounds, shape.lo, shape.hi);
  }
  load.values.read(fields["open"], shape.open);
  read_root_finder(load, fields["root_finder"], shape.root_finder);
  const auto positive = [](const BlobSource& s) { return s.weight > 0; };
  const auto endless = [](const BlobSource& s) { return s.kind != BlobSource::Kind::point; };
  if (std::none_of(shape.sources.begin(), shape.sources.end(), positive))
    return skip_exact(load, key, "no source has a positive weight");
  if (!shape.bounded && std::any_of(shape.sources.begin(), shape.sources.end(), endless))
    throw Error(node.where(), "a blob with lines or planes is endless and needs 'bounds'");
  return shape;
}

enum class ProfileKind { spline, linear, sor, curve, bezier };

MaybeForm read_revolution(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "revolution", {"points", "profile", "open", "normals"});
  auto kind = ProfileKind::spline;
  if (const YamlNode* profile = fields["profile"])
    kind = load.values.choice<ProfileKind>(*profile, {{"spline", ProfileKind::spline},
                                                      {"linear", ProfileKind::linear},
                                                      {"sor", ProfileKind::sor},
                                                      {"curve", ProfileKind::curve},
                                                      {"bezier", ProfileKind::bezier}});
  RevolutionShape shape;
  load.values.read(fields["open"], shape.open);
  const YamlNode& points = fields.require("points");
  const auto items = list_items(points, "points");
  const std::size_t n = items.size();
  const bool ends_are_slopes = kind != ProfileKind::linear && kind != ProfileKind::bezier;
  const std::size_t least = kind == ProfileKind::linear ? 2 : 4;
  if (n < least || n > kMaxProfilePoints)
    throw Error(points.where(),
                fmt::format("expected {} to {} points, found {}", least, kMaxProfilePoints, n));
  if (kind == ProfileKind::bezier && n % 3 != 1)
    throw Error(points.where(),
                fmt::format("expected 4, 7, 10, … points, 3 more for each piece; found {}", n));
  const bool ascends = kind == ProfileKind::spline || kind == ProfileKind::sor || kind == ProfileKind::linear;
  double greatest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double p[2];
    load.values.numbers(*items[i], p);
    const bool on_surface = ends_are_slopes ? i > 0 && i + 1 < n : kind == ProfileKind::linear || i % 3 == 0;
    if (on_surface && p[0] < 0)
      throw Error(items[i]->where(), "the profile crosses the axis: the radius is negative");
    if (on_surface) greatest = std::max(greatest, p[0]);
    if (ascends && i > 0) {
      const double before = shape.points.back().height;
      if (kind == ProfileKind::linear ? p[1] < before : p[1] <= before)
        throw Error(items[i]->where(),
                    fmt::format("heights must ascend: {} comes after {}; for other profiles "
                                "there is 'profile: curve'",
                                p[1], before));
    }
    shape.points.push_back({p[0], p[1]});
  }
  if (greatest == 0) return skip_exact(load, key, "all radii are zero");
  if (kind == ProfileKind::curve || kind == ProfileKind::bezier) {
    LatheShape lathe;
    lathe.points = kind == ProfileKind::curve ? curve_through(shape.points) : shape.points;
    lathe.open = shape.open;
    if (const std::string wrong = why_bad_profile(lathe); !wrong.empty()) throw Error(points.where(), wrong);
    return lathe;
  }
  if (kind == ProfileKind::linear && !(shape.points.front().height < shape.points.back().height))
    return skip_exact(load, key, "all heights are the same");
  shape.profile = kind == ProfileKind::linear ? RevolutionShape::Profile::linear
                  : kind == ProfileKind::sor  ? RevolutionShape::Profile::sor
                                              : RevolutionShape::Profile::spline;
  if (const auto height = profile_crosses_axis(shape))
    throw Error(points.where(), fmt::format("the profile crosses the axis: at height {:.6g} the radius is "
                                            "negative",
                                            *height));
  return shape;
}

constexpr ExactReader kReaders[] = {
    {"polynomial", read_polynomial}, {"blob", read_blob}, {"revolution", read_revolution}};

}  // namespace

std::span<const ExactReader> polynomial_readers() { return kReaders; }

}  // namespace oktett
