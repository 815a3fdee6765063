#include "render/transport/path_lights.h"

#include <limits>

#include "render/light/emitter_kinds.h"
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

}  // namespace oktett
