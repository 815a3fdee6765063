#include "render/transport/path_lights.h"

#include <limits>

#include "render/light/emitter_kinds.h"
#include "render/light/light_share.h"
#include "render/transport/render_code.h"

namespace oktett {
namespace {

/// Samples lights for some hits of a block.
class LightSampler {
 public:
  LightSampler(const RenderContext& context, PathBlock& block)
      : context_(context), set_(context.sampled->set()), c_(block) {}

  void add(const std::uint32_t* entry, std::size_t count) {
    LightPoint from[LightGroup::kMost];
    double choices[LightGroup::kMost] = {};
    SquareSample places[LightGroup::kMost];
    LightSet::Choice chosen[LightGroup::kMost];
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t k = entry[i];
      from[i] = c_.from[k], choices[i] = c_.light[k], places[i] = {c_.light_x[k], c_.light_y[k]};
    }
    set_.choose(render_code(context_.isa).lights.choose, {from, count}, choices, places, chosen);
    for (std::size_t i = 0; i < count; ++i) {
      c_.light_x[entry[i]] = places[i].x, c_.light_y[entry[i]] = places[i].y;
      if (chosen[i].probability > 0) add(entry[i], from[i], chosen[i]);
    }
  }

  void finish() {
    const LightCode& code = render_code(context_.isa).lights;
    finish_placed<TriangleEmitter>(triangles_, code.triangle_samples);
    finish_placed<RectangleEmitter>(rectangles_, code.rectangle_samples);
    finish_placed<DiskEmitter>(disks_, code.disk_samples);
    finish_placed<SphereEmitter>(spheres_, code.sphere_samples);
    finish_points(code);
    finish_environment(code);
    finish_suns(code);
  }

 private:
  void add(std::uint32_t k, const LightPoint& from, const LightSet::Choice& chosen) {
    const Emitter& emitter = set_.emitters()[chosen.emitter];
    // Infinite emitters that overlap are told apart by their radiance.
    if (!set_.lights(chosen.emitter, from.lists) && !(set_.environment_overlaps() && is_infinite(emitter)))
      return;
    if (chosen.emitter == from.on) return add_alone(k, from, chosen);
    if (const auto* e = std::get_if<TriangleEmitter>(&emitter); e != nullptr && is_finite(e->radiance))
      return put(triangles_, k, chosen, e);
    if (const auto* e = std::get_if<RectangleEmitter>(&emitter); e != nullptr && is_finite(e->radiance))
      return put(rectangles_, k, chosen, e);
    if (const auto* e = std::get_if<DiskEmitter>(&emitter); e != nullptr && is_finite(e->radiance))
      return put(disks_, k, chosen, e);
    if (const auto* e = std::get_if<SphereEmitter>(&emitter); e != nullptr && is_outside(*e, from.position))
      return put(spheres_, k, chosen, e);
    if (const auto* e = std::get_if<PointEmitter>(&emitter)) return put_cone(k, chosen, light_cone(*e));
    if (const auto* e = std::get_if<SpotEmitter>(&emitter)) return put_cone(k, chosen, light_cone(*e));
    if (const auto* e = std::get_if<EnvironmentEmitter>(&emitter)) {
      if (map_ == nullptr) map_ = e;
      if (map_ == e) return put(environment_, k, chosen, e);
    }
    if (const auto* e = std::get_if<DirectionalEmitter>(&emitter); e != nullptr && e->angle > 0)
      return put(suns_, k, chosen, e);
    add_alone(k, from, chosen);
  }

  void add_alone(std::uint32_t k, const LightPoint& from, const LightSet::Choice& chosen) {
    if (const auto sample = set_.sample(from, chosen, {c_.light_x[k], c_.light_y[k]})) set(k, *sample);
  }

  static bool is_infinite(const Emitter& emitter) {
    const auto* const sun = std::get_if<DirectionalEmitter>(&emitter);
    return sun != nullptr ? sun->angle > 0 : std::holds_alternative<EnvironmentEmitter>(emitter);
  }

  static bool is_outside(const SphereEmitter& e, const Vec3f& position) {
    const Vec3d to = Vec3d(e.center) - Vec3d(position);
    const double square = dot(to, to), radius = e.radius;
    return square >= radius * radius && square > 0 && is_finite(e.radiance);
  }

  void put(LightGroup& group, std::uint32_t k, const LightSet::Choice& chosen, const void* emitter) {
    const std::size_t i = group.count++;
    group.entry[i] = k, group.number[i] = chosen.emitter, group.emitter[i] = emitter;
    group.probability[i] = chosen.probability;
    InteractionBlock::put(group.position, i, c_.from[k].position);
    group.x[i] = c_.light_x[k], group.y[i] = c_.light_y[k];
  }

  void put_cone(std::uint32_t k, const LightSet::Choice& chosen, const LightCone& cone) {
    cones_[points_.count] = cone;
    put(points_, k, chosen, &cones_[points_.count]);
  }

  static void repeat_last(LightGroup& group) {
    const std::size_t last = group.count - 1;
    for (std::size_t i = group.count; i % PathBlock::kGroup != 0; ++i) {
      group.emitter[i] = group.emitter[last], group.x[i] = group.x[last], group.y[i] = group.y[last];
      InteractionBlock::put(group.position, i, InteractionBlock::get(group.position, last));
    }
  }

  void set(std::uint32_t k, const LightSample& s) {
    c_.light_kind[k] = s.delta ? LightKind::delta : LightKind::area;
    c_.light_emitter[k] = s.emitter;
    InteractionBlock::put(c_.light_direction, k, s.direction);
    InteractionBlock::put(c_.light_color, k, s.radiance * context_.sampled->texture_at(s, context_.textures));
    c_.light_distance[k] = s.distance, c_.light_pdf[k] = s.pdf;
  }

  void set(const LightGroup& group, std::size_t i, float distance, const Color& radiance, float pdf,
           bool delta = false) {
    if (!(pdf > 0)) return;
    set(group.entry[i], LightSample{.direction = InteractionBlock::get(group.direction, i),
                                    .distance = distance,
                                    .radiance = radiance,
                                    .pdf = pdf,
                                    .delta = delta,
                                    .emitter = group.number[i],
                                    .u = static_cast<float>(group.x[i]),
                                    .v = static_cast<float>(group.y[i])});
  }

  static float pdf_of(const LightGroup& group, std::size_t i) {
    return static_cast<float>(group.pdf[i] * group.probability[i]);
  }

  template <class Kind>
  void finish_placed(LightGroup& group, void (*samples)(LightGroup&)) {
    if (group.count == 0) return;
    repeat_last(group);
    samples(group);
    for (std::size_t i = 0; i < group.count; ++i)
      set(group, i, group.distance[i], static_cast<const Kind*>(group.emitter[i])->radiance,
          pdf_of(group, i));
  }

  /// What fading and tightness leave of the light of a spot.
  float spot_share(const LightGroup& group, std::size_t i) const {
    const auto& spot = std::get<SpotEmitter>(set_.emitters()[group.number[i]]);
    const Vec3d direction(InteractionBlock::get(group.direction, i));
    return faded_share(spot.fade, group.distance[i]) *
           tight_share(-dot(direction, Vec3d(spot.axis)), spot.tightness);
  }

  void finish_points(const LightCode& code) {
    LightGroup& group = points_;
    if (group.count == 0) return;
    repeat_last(group);
    code.point_samples(group);
    for (std::size_t i = 0; i < group.count; ++i) {
      const Emitter& emitter = set_.emitters()[group.number[i]];
      const auto* point = std::get_if<PointEmitter>(&emitter);
      const Color intensity = point != nullptr ? point->intensity : std::get<SpotEmitter>(emitter).intensity;
      Color light = intensity * group.scale[i];
      if (point != nullptr)
        light =
            light * point->profile(Vec3d(InteractionBlock::get(group.position, i)) - Vec3d(point->position));
      light *= point != nullptr ? faded_share(point->fade, group.distance[i]) : spot_share(group, i);
      if (is_finite(light)) set(group, i, group.distance[i], light, pdf_of(group, i), true);
    }
  }

  void finish_environment(const LightCode& code) {
    LightGroup& group = environment_;
    if (group.count == 0 || map_->map == nullptr || !map_->map->samples()) return;
    repeat_last(group);
    code.map_samples(map_->map->tables(), group);
    if (set_.environment_overlaps()) return set_by_direction(code, group);
    for (std::size_t i = 0; i < group.count; ++i)
      set(group, i, kFar, InteractionBlock::get(group.radiance, i), pdf_of(group, i));
  }

  void finish_suns(const LightCode& code) {
    LightGroup& group = suns_;
    if (group.count == 0) return;
    repeat_last(group);
    code.sun_directions(group);
    if (set_.environment_overlaps()) return set_by_direction(code, group);
    for (std::size_t i = 0; i < group.count; ++i) {
      const auto& sun = *static_cast<const DirectionalEmitter*>(group.emitter[i]);
      set(group, i, kFar, sun.radiance, static_cast<float>(sun_pdf(sun) * group.probability[i]));
    }
  }

  /// Sets samples with the sums of radiance and density over all infinite lights in their directions.
  void set_by_direction(const LightCode& code, const LightGroup& group) {
    EnvironmentValues values;
    LightPoint points[LightGroup::kMost];
    for (std::size_t i = 0; i < group.count; ++i) points[i] = c_.from[group.entry[i]];
    set_.environment_values(code.map, group.count, points,
                            {group.direction[0], group.direction[1], group.direction[2]}, values);
    for (std::size_t i = 0; i < group.count; ++i)
      set(group, i, kFar, InteractionBlock::get(values.radiance, i), values.pdf[i]);
  }

  static constexpr float kFar = std::numeric_limits<float>::infinity();

  const RenderContext& context_;
  const LightSet& set_;
  PathBlock& c_;
  const EnvironmentEmitter* map_ = nullptr;
  LightGroup triangles_, rectangles_, disks_, spheres_, points_, environment_, suns_;
  LightCone cones_[LightGroup::kMost];  ///< of points_
};

}  // namespace

void sample_lights(const RenderContext& context, const std::uint32_t* entry, std::size_t count,
                   PathBlock& c) {
  LightSampler sampler(context, c);
  sampler.add(entry, count);
  sampler.finish();
}

// ---- Light samples of raised points.

namespace {

/// Moves the light sample of a hit to a raised point.
class LightMover {
 public:
  LightMover(const RenderContext& context, PathBlock& block, std::size_t k, const Vec3f& raised)
      : set_(context.sampled->set()),
        sampled_(*context.sampled),
        textures_(context.textures),
        c_(block),
        k_(k),
        from_(block.from[k]),
        to_(block.from[k]) {
    to_.position = raised;
  }

  /// False if that light does not reach the raised point.
  bool move() {
    const bool far = !(c_.light_distance[k_] < std::numeric_limits<float>::infinity());
    if (c_.light_kind[k_] == LightKind::delta) return far || move_point();
    return far ? weigh(set_.environment_pdf(to_, direction())) : move_place();
  }

 private:
  Vec3f direction() const { return InteractionBlock::get(c_.light_direction, k_); }
  void set_color(const Color& color) { InteractionBlock::put(c_.light_color, k_, color); }

  /// Light that is seen as a point has one direction.
  bool move_point() {
    const auto s = sample_emitter(set_.emitters()[c_.light_emitter[k_]], to_, {});
    if (!s) return false;
    set_way(s->direction, s->distance);
    set_color(s->radiance * sampled_.texture_at(*s, textures_));
    return true;
  }

  /// The sample stays at its place on the emitter, so its density there does, too.
  bool move_place() {
    const Emitter& emitter = set_.emitters()[c_.light_emitter[k_]];
    const Vec3d before = Vec3d(direction()) * double{c_.light_distance[k_]};
    const Vec3d place = Vec3d(from_.position) + before, after = place - Vec3d(to_.position);
    const Vec3d normal = normal_at(emitter, place);
    const double size_before = length(before), size_after = length(after);
    // Solid angle that a small piece of the emitter fills, up to a factor that both have.
    const double seen_before = dot(normal, before) / (size_before * size_before * size_before);
    const double seen_after = dot(normal, after) / (size_after * size_after * size_after);
    const double ratio = seen_after / seen_before;
    if (!(ratio > 0)) return false;
    const Vec3f direction(after / size_after);
    const auto distance = static_cast<float>(size_after);
    set_way(direction, distance);
    set_color(InteractionBlock::get(c_.light_color, k_) * static_cast<float>(ratio));
    return weigh(set_.pdf(to_, c_.light_emitter[k_], direction, distance));
  }

  void set_way(const Vec3f& direction, float distance) {
    InteractionBlock::put(c_.light_direction, k_, direction);
    c_.light_distance[k_] = distance;
  }

  /// Makes `pdf`, by which rays that meet the emitter are weighted, the density of the sample. What the light
  /// is divided by stays the same.
  bool weigh(float pdf) {
    const Color light = InteractionBlock::get(c_.light_color, k_) * (pdf / c_.light_pdf[k_]);
    if (!(pdf > 0) || !is_finite(light)) return false;
    set_color(light);
    c_.light_pdf[k_] = pdf;
    return true;
  }

  const LightSet& set_;
  const SceneLights& sampled_;
  const TextureSampler* textures_;
  PathBlock& c_;
  std::size_t k_;
  LightPoint from_, to_;
};

/// Whether light from the unit vector `l` comes from above the shading normal's horizon, but from behind the
/// plane of the triangle.
bool comes_from_behind(const PathBlock& c, std::size_t k, const Vec3f& l) {
  return !(dot(InteractionBlock::get(c.ng, k), l) > 0) && dot(InteractionBlock::get(c.ns, k), l) > 0;
}

}  // namespace

void raise_lights(const RenderContext& context, const std::uint32_t* entry, std::size_t count, PathBlock& c) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t k = entry[i];
    if (c.light_kind[k] == LightKind::none || !c.from[k].front_only ||
        !comes_from_behind(c, k, InteractionBlock::get(c.light_direction, k)))
      continue;
    const Vec3f* const raised = c.raised->point(k);
    if (raised == nullptr) continue;
    if (LightMover(context, c, k, *raised).move() &&
        c.raised->leads_above(k, InteractionBlock::get(c.light_direction, k)))
      c.raised_light |= std::uint64_t{1} << k;
    else
      c.light_kind[k] = LightKind::none;
  }
}

}  // namespace oktett
