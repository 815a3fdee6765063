#include "render/transport/path_lights.h"

#include <limits>

#include "render/transport/render_code.h"

namespace oktett {
namespace {

/// Samples lights for some hits of a block.
class LightSampler {
 public:
  LightSampler(const RenderContext& context, const InteractionBlock& found, PathBlock& block)
      : context_(context), set_(context.sampled->set()), found_(found), c_(block) {}

  void add(const std::uint32_t* entry, const bool* front_only, std::size_t count) {
    LightPoint from[LightGroup::kMost];
    double choices[LightGroup::kMost] = {};
    SquareSample places[LightGroup::kMost];
    LightSet::Choice chosen[LightGroup::kMost];
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t k = entry[i];
      from[i] = {InteractionBlock::get(found_.position, k), InteractionBlock::get(c_.ng, k), front_only[i]};
      choices[i] = c_.light[k], places[i] = {c_.light_x[k], c_.light_y[k]};
    }
    set_.choose(render_code(context_.isa).lights.choose, {from, count}, choices, places, chosen);
    for (std::size_t i = 0; i < count; ++i) {
      c_.light_x[entry[i]] = places[i].x, c_.light_y[entry[i]] = places[i].y;
      if (chosen[i].probability > 0) add(entry[i], from[i], chosen[i]);
    }
  }

  void finish() {
    const LightCode& code = render_code(context_.isa).lights;
    finish_placed(rectangles_, code.rectangle_samples,
                  [](const void* e) { return static_cast<const RectangleEmitter*>(e)->radiance; });
    finish_placed(spheres_, code.sphere_samples,
                  [](const void* e) { return static_cast<const SphereEmitter*>(e)->radiance; });
    finish_environment(code);
    finish_suns(code);
  }

 private:
  void add(std::uint32_t k, const LightPoint& from, const LightSet::Choice& chosen) {
    const Emitter& emitter = set_.emitters()[chosen.emitter];
    if (const auto* e = std::get_if<RectangleEmitter>(&emitter); e != nullptr && is_finite(e->radiance))
      return put(rectangles_, k, chosen, e, from.front_only);
    if (const auto* e = std::get_if<SphereEmitter>(&emitter); e != nullptr && is_outside(*e, from.position))
      return put(spheres_, k, chosen, e, from.front_only);
    if (const auto* e = std::get_if<EnvironmentEmitter>(&emitter)) {
      if (map_ == nullptr) map_ = e;
      if (map_ == e) return put(environment_, k, chosen, e, from.front_only);
    }
    if (const auto* e = std::get_if<DirectionalEmitter>(&emitter);
        e != nullptr && e->angle > 0 && set_.environment_overlaps())
      return put(suns_, k, chosen, &emitter, from.front_only);
    if (const auto sample = set_.sample(from, chosen, {c_.light_x[k], c_.light_y[k]})) set(k, *sample);
  }

  static bool is_outside(const SphereEmitter& e, const Vec3f& position) {
    const Vec3d to = Vec3d(e.center) - Vec3d(position);
    const double square = dot(to, to), radius = e.radius;
    return square >= radius * radius && square > 0 && is_finite(e.radiance);
  }

  void put(LightGroup& group, std::uint32_t k, const LightSet::Choice& chosen, const void* emitter,
           bool front_only) {
    const std::size_t i = group.count++;
    group.entry[i] = k, group.number[i] = chosen.emitter, group.emitter[i] = emitter;
    group.probability[i] = chosen.probability, group.front_only[i] = front_only;
    InteractionBlock::put(group.position, i, InteractionBlock::get(found_.position, k));
    group.x[i] = c_.light_x[k], group.y[i] = c_.light_y[k];
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

  void set(const LightGroup& group, std::size_t i, float distance, const Color& radiance, float pdf) {
    if (!(pdf > 0)) return;
    set(group.entry[i], LightSample{.direction = InteractionBlock::get(group.direction, i),
                                    .distance = distance,
                                    .radiance = radiance,
                                    .pdf = pdf,
                                    .delta = false,
                                    .emitter = group.number[i],
                                    .u = static_cast<float>(group.x[i]),
                                    .v = static_cast<float>(group.y[i])});
  }

  template <class Radiance>
  void finish_placed(LightGroup& group, void (*samples)(LightGroup&), const Radiance& radiance) {
    if (group.count == 0) return;
    repeat_last(group);
    samples(group);
    for (std::size_t i = 0; i < group.count; ++i)
      set(group, i, group.distance[i], radiance(group.emitter[i]),
          static_cast<float>(group.pdf[i] * group.probability[i]));
  }

  void finish_environment(const LightCode& code) {
    LightGroup& group = environment_;
    if (group.count == 0 || map_->map == nullptr || !map_->map->samples()) return;
    repeat_last(group);
    code.map_samples(map_->map->tables(), group);
    if (set_.environment_overlaps()) return set_by_direction(code, group);
    for (std::size_t i = 0; i < group.count; ++i)
      set(group, i, kFar, InteractionBlock::get(group.radiance, i),
          static_cast<float>(group.pdf[i] * group.probability[i]));
  }

  /// Samples of suns where rays meet other infinite light too.
  void finish_suns(const LightCode& code) {
    LightGroup& group = suns_;
    if (group.count == 0) return;
    repeat_last(group);
    for (std::size_t i = 0; i < group.count || i % PathBlock::kGroup != 0; ++i) {
      const auto& emitter = *static_cast<const Emitter*>(group.emitter[i]);
      InteractionBlock::put(group.direction, i,
                            sample_emitter(emitter, {}, {group.x[i], group.y[i]})->direction);
    }
    set_by_direction(code, group);
  }

  /// Sets samples with the sums of radiance and density over all infinite lights in their directions.
  void set_by_direction(const LightCode& code, const LightGroup& group) {
    EnvironmentValues values;
    LightPoint points[LightGroup::kMost];
    for (std::size_t i = 0; i < group.count; ++i) {
      const std::uint32_t k = group.entry[i];
      points[i] = {InteractionBlock::get(found_.position, k), InteractionBlock::get(c_.ng, k),
                   group.front_only[i]};
    }
    set_.environment_values(code.map, group.count, points,
                            {group.direction[0], group.direction[1], group.direction[2]}, values);
    for (std::size_t i = 0; i < group.count; ++i)
      set(group, i, kFar, InteractionBlock::get(values.radiance, i), values.pdf[i]);
  }

  static constexpr float kFar = std::numeric_limits<float>::infinity();

  const RenderContext& context_;
  const LightSet& set_;
  const InteractionBlock& found_;
  PathBlock& c_;
  const EnvironmentEmitter* map_ = nullptr;
  LightGroup rectangles_, spheres_, environment_, suns_;
};

}  // namespace

void sample_lights(const RenderContext& context, const InteractionBlock& found, const std::uint32_t* entry,
                   const bool* front_only, std::size_t count, PathBlock& c) {
  LightSampler sampler(context, found, c);
  sampler.add(entry, front_only, count);
  sampler.finish();
}

}  // namespace oktett
