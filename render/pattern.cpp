#include "render/pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/math.h"
#include "render/pattern_noise.h"
#include "render/pattern_values.h"

namespace oktett {
namespace {

/// Noise of all octaves, in [-1, 1].
double turbulence(const Turbulence& t, Vec3d p, NoiseGenerator generator) {
  double sum = 0, total = 0, weight = 1;
  for_each_octave<1>(
      t.octaves, generator,
      [&](Vec3d(&place)[1]) {
        place[0] = p;
        // Moved by a half, so that the zeros of the octaves do not fall together.
        p = p * 2 + Vec3d{0.5, 0.5, 0.5};
      },
      [&](const double(&noise)[1]) {
        sum += weight * noise[0];
        total += weight;
        weight *= t.roughness;
      });
  return sum / total;
}

double value_of(const CheckerPattern& c, const Vec3d& p, NoiseGenerator) {
  // Moved a little, so that faces at multiples of the size do not lie where the colours meet.
  constexpr double kAside = 0x1p-12;
  const Vec3d q = p / c.size;
  const std::int64_t sum = cell_of(q.x + kAside) + cell_of(q.y + kAside) + cell_of(q.z + kAside);
  return (sum & 1) != 0 ? 1 : 0;
}

double value_of(const GradientPattern& g, const Vec3d& p, NoiseGenerator) {
  const Vec3d along = g.to - g.from;
  return dot(p - g.from, along) / dot(along, along);
}

double value_of(const RadialPattern& r, const Vec3d& p, NoiseGenerator) {
  return (length(p - r.center) - r.inner) / (r.outer - r.inner);
}

double value_of(const NoisePattern& n, const Vec3d& p, NoiseGenerator generator) {
  return 0.5 + 0.5 * turbulence(n.turbulence, p / n.size, generator);
}

double value_of(const MarblePattern& m, const Vec3d& p, NoiseGenerator generator) {
  const Vec3d q = p / m.size;
  const double layer = q.x + m.distortion * turbulence(m.turbulence, q, generator);
  return 0.5 - 0.5 * portable::cos(2 * std::numbers::pi * (layer - std::floor(layer)));
}

double value_of(const WoodPattern& w, const Vec3d& p, NoiseGenerator generator) {
  const Vec3d q = p / w.size;
  // Noise is drawn out along the trunk.
  const double bend = turbulence(w.turbulence, Vec3d{q.x, q.y * 0.1, q.z} * 0.25, generator);
  const double ring = std::sqrt(q.x * q.x + q.z * q.z) + 4 * w.distortion * bend;
  const double part = ring - std::floor(ring);
  return part * part * (3 - 2 * part);
}

/// Whether values beyond 0 and 1 have the first and the last colour, unless a wave is asked for.
template <class P>
constexpr bool kClamps = requires(const P& pattern) {
  value_of(pattern, Vec3d{}, NoiseGenerator{});
};
/// Whether the pattern has single values.
template <class P>
constexpr bool kIsBlocks = requires {
  P::kValues;
};

template <class P>
constexpr bool kShowsColors = requires {
  P::kShowsColors;
};

template <class P>
constexpr WaveShape own_wave() {
  return requires { P::kTriangle; }
  ? WaveShape::triangle : WaveShape::ramp;
}

/// What becomes of a number outside [0, 1]. A NaN becomes 0.
double clamped(double value) { return value > 0 ? std::min(value, 1.0) : 0; }

bool is_plain(const Wave& wave) {
  return wave.shape == WaveShape::own && wave.frequency == 1 && wave.phase == 0;
}

/// The value before and after the wave.
struct PatternSample {
  double raw, value;
};

PatternSample sample(const Pattern& pattern, const Vec3d& p, const PatternFrame& frame) {
  return std::visit(
      [&]<class P>(const P& kind) -> PatternSample {
        if constexpr (kShowsColors<P>) {
          return {0, 0};
        } else if constexpr (kClamps<P>) {
          const double raw = value_of(kind, p, frame.turbulence.generator);
          return {raw, is_plain(frame.wave) ? clamped(raw) : waved(frame.wave, WaveShape::ramp, raw)};
        } else {
          const double raw = raw_value(kind, p, frame);
          if constexpr (kIsBlocks<P>)
            return {raw, clamped(raw / (P::kValues - 1))};
          else
            return {raw, waved(frame.wave, own_wave<P>(), raw)};
        }
      },
      pattern);
}

/// Some patterns use turbulence otherwise than by displacing places.
bool displaces(const Pattern& pattern) {
  return !std::holds_alternative<LayersPattern>(pattern) && !std::holds_alternative<RingsPattern>(pattern);
}

/// The place in the pattern that a place of its own space shows.
Vec3d place_in(const PatternTexture& texture, const Vec3d& p) {
  const Vec3d q = warped(texture.warps, p);
  return displaces(texture.pattern) ? displaced(texture.turbulence, q) : q;
}

// ---- Patterns that have colours in place of values.

Color color_of(const PatternColor& shown, const Vec3d& p, const PatternTextures* others) {
  if (shown.texture == TextureIndex{}) return shown.color;
  return others == nullptr ? Color{0, 0, 0} : others->color(shown.texture.index, p);
}

Color shown_color(const OverPattern& over, const Vec3d& p, const PatternTextures* others) {
  const Color filter = color_of(over.filter, p, others);
  const Color color = color_of(over.color, p, others);
  return filter == Color{0, 0, 0} ? color : color + filter * color_of(over.under, p, others);
}

/// The part of a turn about the y axis, from the x axis towards z.
double turn_of(const Vec3d& p) {
  const double turn = portable::atan2(p.z, p.x) / (2 * std::numbers::pi);
  return turn - std::floor(turn);
}

Color shown_color(const ProjectedPattern& image, const Vec3d& p, const PatternTextures* others) {
  if (others == nullptr || !is_finite(p)) return {0, 0, 0};
  using enum ProjectedPattern::Projection;
  double u = p.x, v = p.y;
  if (image.projection != planar) {
    const double across = std::sqrt(p.x * p.x + p.z * p.z);
    u = turn_of(p);
    if (image.projection == spherical) v = 0.5 + portable::atan2(p.y, across) / std::numbers::pi;
    if (image.projection == toroidal) {
      const double around = portable::atan2(p.y, across - 1) / (2 * std::numbers::pi);
      v = around - std::floor(around);
    }
  }
  return others->image(image.texture.index, {static_cast<float>(u), static_cast<float>(v)});
}

/// The colour of a pattern without values; nothing for all others.
std::optional<Color> shown_color(const Pattern& pattern, const Vec3d& p, const PatternTextures* others) {
  return std::visit(
      [&]<class P>(const P& kind) -> std::optional<Color> {
        if constexpr (kShowsColors<P>) return shown_color(kind, p, others);
        return std::nullopt;
      },
      pattern);
}

/// The two entries of a map that a value is between, and how far it is from the first to the second.
struct MapPlace {
  const PatternEntry &before, &after;
  double part;
};
MapPlace place_in_map(const std::vector<PatternEntry>& map, double value) {
  const auto after = std::ranges::find_if(map, [&](const PatternEntry& entry) { return entry.at > value; });
  if (after == map.begin()) return {*after, *after, 0};
  const PatternEntry& before = *(after - 1);
  if (after == map.end() || before.at == value) return {before, before, 0};
  return {before, *after, (value - before.at) / (after->at - before.at)};
}

/// The colour at a place of a pattern whose value there is `value`.
Color color_at(const PatternTexture& texture, double value, const Vec3d& place,
               const PatternTextures* others) {
  if (texture.map.empty()) {
    const std::vector<Color>& colors = texture.colors;
    const std::size_t last = colors.size() - 1;
    const double at = value * static_cast<double>(last);
    const auto before = static_cast<std::size_t>(at);
    if (before >= last) return colors[last];
    const auto part = static_cast<float>(at - static_cast<double>(before));
    return colors[before] * (1 - part) + colors[before + 1] * part;
  }
  const auto color_of = [&](const PatternEntry& entry) {
    if (entry.texture.index == TextureIndex{}.index) return entry.color;
    return others == nullptr ? Color{0, 0, 0} : others->color(entry.texture.index, place);
  };
  const MapPlace at = place_in_map(texture.map, value);
  if (&at.before == &at.after) return color_of(at.before);
  const auto part = static_cast<float>(at.part);
  return color_of(at.before) * (1 - part) + color_of(at.after) * part;
}

/// What a pattern looks like at this scale is smooth.
double detail_of(const Pattern& pattern) {
  return std::visit(
      []<class P>(const P& kind) -> double {
        if constexpr (requires { kind.turbulence; })
          return kind.size * portable::exp2(-static_cast<double>(kind.turbulence.octaves));
        else if constexpr (requires { kind.size; })
          return kind.size;
        else if constexpr (requires { kind.outer; })
          return kind.outer - kind.inner;
        else if constexpr (requires { kind.from; })
          return length(kind.to - kind.from);
        else if constexpr (std::is_same_v<P, GranitePattern>)
          return 0x1p-7;
        else if constexpr (std::is_same_v<P, WrinklesPattern>)
          return 0x1p-9;
        else
          return 1;
      },
      pattern);
}

/// The same with turbulence and waves.
double detail_of(const PatternTexture& texture) {
  double detail = detail_of(texture.pattern);
  if (std::abs(texture.wave.frequency) > 1) detail /= std::abs(texture.wave.frequency);
  const PatternTurbulence& t = texture.turbulence;
  if (t.amount == Vec3d{0, 0, 0} || t.lambda <= 1) return detail;
  return std::min(detail, portable::pow(t.lambda, 1 - static_cast<double>(t.octaves)));
}

/// Whether values on both sides of a place do not hang together.
bool is_broken(const PatternTexture& texture, const PatternSample& before, const PatternSample& after) {
  return std::visit(
      [&]<class P>(const P& kind) {
        // Values of these are colours already.
        if constexpr (kShowsColors<P>) return std::abs(after.value - before.value) > 0.25;
        bool steps = kIsBlocks<P> || requires { P::kSteps; };
        if constexpr (requires { kind.solid; }) steps = kind.solid;
        if (steps) {
          return before.raw != after.raw;
        } else {
          if (kClamps<P> && is_plain(texture.wave)) return false;
          constexpr double kMostDifference = 0.25;
          const bool far_apart = std::abs(after.raw - before.raw) > kMostDifference;
          return far_apart || (jumps(texture.wave, own_wave<P>()) &&
                               period_of(texture.wave, before.raw) != period_of(texture.wave, after.raw));
        }
      },
      texture.pattern);
}

}  // namespace

void PatternTexture::set_noise_generator(NoiseGenerator generator) {
  turbulence.generator = generator;
  for (Warp& warp : warps)
    if (auto* const turbulent = std::get_if<TurbulenceWarp>(&warp))
      turbulent->turbulence.generator = generator;
}

double pattern_value(const Pattern& pattern, const Vec3d& p) {
  const PatternTurbulence none;
  const Wave own;
  return sample(pattern, p, {none, own}).value;
}

Color pattern_color(const PatternTexture& texture, const Vec3d& p, const PatternTextures* others) {
  const Vec3d place = place_in(texture, texture.to_pattern.point(p));
  if (const std::optional<Color> shown = shown_color(texture.pattern, place, others)) return *shown;
  const PatternFrame frame{texture.turbulence, texture.wave, others};
  return color_at(texture, sample(texture.pattern, place, frame).value, place, others);
}

namespace {

struct Height {
  PatternSample sample;
  double height;
};

/// The first channel at a place of the pattern.
Height height_at(const PatternTexture& texture, const Vec3d& place, const PatternTextures* others) {
  const PatternFrame frame{texture.turbulence, texture.wave, others};
  if (const std::optional<Color> shown = shown_color(texture.pattern, place, others))
    return {{shown->x, shown->x}, shown->x};
  const PatternSample found = sample(texture.pattern, place, frame);
  if (!texture.map.empty()) return {found, double{color_at(texture, found.value, place, others).x}};
  const std::vector<Color>& colors = texture.colors;
  const double at = found.value * static_cast<double>(colors.size() - 1);
  const auto before = std::min(static_cast<std::size_t>(at), colors.size() - 1);
  const auto after = std::min(before + 1, colors.size() - 1);
  const double low = colors[before].x, high = colors[after].x;
  return {found, low + (high - low) * (at - static_cast<double>(before))};
}

/// The slope that other textures have together; nothing if the pattern does not show any.
std::optional<Vec3d> mixed_slope(const PatternTexture& texture, const Vec3d& place,
                                 const PatternTextures* others) {
  if (others == nullptr) return std::nullopt;
  const auto slope_of = [&](const TextureIndex& shown) {
    return shown == TextureIndex{} ? Vec3d{0, 0, 0} : others->slope(shown.index, place);
  };
  if (const auto* const over = std::get_if<OverPattern>(&texture.pattern)) {
    if (!(over->filter.texture == TextureIndex{})) return std::nullopt;
    return slope_of(over->color.texture) + slope_of(over->under.texture) * double{over->filter.color.x};
  }
  const bool is_some = std::ranges::any_of(
      texture.map, [](const PatternEntry& entry) { return !(entry.texture == TextureIndex{}); });
  if (!is_some) return std::nullopt;
  const PatternFrame frame{texture.turbulence, texture.wave, others};
  const MapPlace at = place_in_map(texture.map, sample(texture.pattern, place, frame).value);
  const Vec3d before = slope_of(at.before.texture);
  return at.part == 0 ? before : before * (1 - at.part) + slope_of(at.after.texture) * at.part;
}

/// From differences to the corners of a tetrahedron around the place.
Vec3d tetrahedral_slope(const PatternTexture& texture, const Vec3d& place, const PatternTextures* others) {
  constexpr double kStep = 0.02;
  const double third = 1.0 / 3, high = std::sqrt(8.0) / 3, low = std::sqrt(2.0) / 3,
               side = std::sqrt(6.0) / 3;
  const Vec3d corners[4] = {{high, -third, 0}, {-low, -third, side}, {-low, -third, -side}, {0, 1, 0}};
  Vec3d slope{0, 0, 0};
  for (const Vec3d& corner : corners)
    slope += corner * (0.75 / kStep * height_at(texture, place + corner * kStep, others).height);
  return slope;
}

/// pattern_slope with a noise generator of POV-Ray's.
Vec3d povray_slope(const PatternTexture& texture, const Vec3d& p, const PatternTextures* others) {
  const Vec3d place = place_in(texture, texture.to_pattern.point(p));
  std::optional<Vec3d> slope = mixed_slope(texture, place, others);
  if (!slope && texture.map.empty()) {
    // Surfaces lean away from a slope, and towards a bend.
    slope = povray_bend(texture.pattern, place, {texture.turbulence, texture.wave, others});
    if (slope) slope = -*slope;
  }
  if (!slope) slope = tetrahedral_slope(texture, place, others);
  for (const Warp& warp : texture.warps)
    if (const auto* const moved = std::get_if<TransformWarp>(&warp))
      slope = moved->to_pattern.normal_by_inverse(*slope);
  return texture.to_pattern.normal_by_inverse(*slope);
}

}  // namespace

Vec3d pattern_slope(const PatternTexture& texture, const Vec3d& p, const PatternTextures* others) {
  if (texture.turbulence.generator != NoiseGenerator::own) return povray_slope(texture, p, others);
  const Vec3d place = texture.to_pattern.point(p);
  const double step = detail_of(texture) * 0x1p-10;
  Vec3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d before = place, after = place;
    before[axis] -= step, after[axis] += step;
    const Height high = height_at(texture, place_in(texture, after), others);
    const Height low = height_at(texture, place_in(texture, before), others);
    slope[axis] = is_broken(texture, low.sample, high.sample)
                      ? 0
                      : (high.height - low.height) / (after[axis] - before[axis]);
  }
  return texture.to_pattern.normal_by_inverse(slope);
}

}  // namespace oktett
