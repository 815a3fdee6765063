#include "render/photon/trace_photons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "accel/accel.h"
#include "core/parallel.h"
#include "render/dispersion.h"
#include "render/light/emitter.h"
#include "render/path_surface.h"
#include "render/shading_point.h"

namespace oktett {

// ---- What solids and media do to photons: where these start in them, and how much light passes.

std::vector<DielectricStack> start_dielectrics(const RenderContext& context,
                                               std::span<const PhotonStart> starts) {
  std::vector<DielectricStack> dielectrics;
  if (!context.tracks_dielectrics) return dielectrics;
  dielectrics.resize(starts.size());
  if (!context.world->has_enclosing_solids) return dielectrics;
  std::map<std::uint32_t, std::size_t> firsts;  // by emitter
  RayBatch between;
  std::vector<std::pair<std::size_t, std::size_t>> others;  // with the first photon of the emitter
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Vec3f& place = starts[i].ray.origin;
    const auto [found, is_new] = firsts.try_emplace(starts[i].emitter, i);
    const std::size_t first = found->second;
    if (is_new) dielectrics[i] = dielectrics_at(context, place);
    const Ray way{starts[first].ray.origin, 0, place - starts[first].ray.origin, 1};
    if (way.direction == Vec3f{0, 0, 0})
      dielectrics[i] = dielectrics[first];
    else
      between.push_back(way), others.push_back({i, first});
  }
  if (others.empty()) return dielectrics;
  HitLists lists;
  all_hits(*context.world->accel, between.span(), lists, context.isa);
  for (std::uint32_t k = 0; k < others.size(); ++k)
    dielectrics[others[k].first] =
        dielectrics_behind(context, dielectrics[others[k].second], between[k], lists.of_ray(k));
  return dielectrics;
}

Color passing_media(const RenderContext& context, const DielectricStack& around, const MediumSegment& segment,
                    TrackingNumbers numbers) {
  const std::uint32_t medium = medium_in(*context.world, around, context.outer_medium);
  return medium == kNoId ? Color{1, 1, 1} : context.media[medium].transmittance(segment, numbers);
}

namespace {

/// Follows the light of one photon back to where it comes from.
Color reaching(const RenderContext& context, const PhotonStart& start, DielectricStack around,
               const TrackingNumbers& numbers) {
  Color light{1, 1, 1};
  Ray ray{start.ray.origin, 0, -start.ray.direction, std::numeric_limits<float>::infinity()};
  for (unsigned layer = 0; layer < kMostPassages; ++layer) {
    const Hit hit = closest_hit(*context.world->accel, ray, context.isa);
    if (context.tracks_dielectrics) {
      const double end = hit.valid() ? static_cast<double>(hit.t) : std::numeric_limits<double>::infinity();
      light = light * passing_media(context, around, {ray.origin, ray.direction, end}, numbers);
    }
    if (!hit.valid()) return light;
    const SurfaceInteraction s = surface_interaction(*context.world->accel, ray, hit);
    bool hidden = false;
    if (context.tracks_dielectrics) {
      const Boundary boundary =
          boundary_at(*context.world, around, s, !(dot(ray.direction, s.geometric_normal) > 0));
      around = boundary.behind, hidden = boundary.hidden;
    }
    if (!hidden) light = light * passing_holes(context, ray, hit, s);
    if (light == Color{0, 0, 0}) return light;
    ray.origin = offset_origin(s, ray.direction);
  }
  return {0, 0, 0};
}

}  // namespace

std::vector<Color> reaching_start(const RenderContext& context, std::span<const PhotonStart> starts,
                                  std::span<const DielectricStack> around,
                                  std::span<const TrackingNumbers> numbers) {
  std::vector<Color> light(starts.size(), Color{1, 1, 1});
  // Few scenes have anything in this way, and one look at all rays finds those.
  RayBatch outward;
  std::vector<std::size_t> distant;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!starts[i].distant) continue;
    outward.push_back({starts[i].ray.origin, 0, -starts[i].ray.direction});
    distant.push_back(i);
  }
  if (distant.empty()) return light;
  std::vector<std::uint8_t> meets(distant.size());
  any_hit(*context.world->accel, outward, meets, context.isa);
  for (std::size_t k = 0; k < distant.size(); ++k) {
    const std::size_t i = distant[k];
    if (!meets[k] && !context.tracks_dielectrics) continue;
    light[i] = reaching(context, starts[i], around.empty() ? DielectricStack{} : around[i], numbers[i]);
  }
  return light;
}

// ---- Photons on their way.

PhotonEnergy& PhotonEnergy::operator+=(const PhotonEnergy& other) {
  emitted += other.emitted, stored += other.stored, absorbed += other.absorbed;
  escaped += other.escaped, media += other.media, cut += other.cut;
  return *this;
}

namespace {

/// Photons that are traced together.
constexpr std::uint32_t kPhotonsTogether = 4096;
/// Bounces before Russian roulette begins.
constexpr unsigned kSureBounces = 3;

/// Photons in flight, in columns.
struct PhotonQueue {
  RayBatch rays;
  std::vector<std::uint32_t> number;
  std::vector<Color> power;
  std::vector<float> index_square;  ///< around the photon, relative to where it started
  std::vector<std::uint16_t> bounces;
  std::vector<float> distance;
  std::vector<DielectricStack> dielectrics;  ///< empty unless the scene tracks solids

  std::size_t size() const { return number.size(); }
  void clear() {
    rays.resize_uninitialized(0);
    number.clear(), power.clear(), index_square.clear(), bounces.clear(), distance.clear();
    dielectrics.clear();
  }
  void push_back(const Ray& ray, std::uint32_t photon, const Color& color, float square, unsigned bounce,
                 float way) {
    rays.push_back(ray);
    number.push_back(photon), power.push_back(color), index_square.push_back(square);
    bounces.push_back(static_cast<std::uint16_t>(bounce)), distance.push_back(way);
  }
};

/// The square of the index of refraction behind the surface over that before it, as a photon meets it.
float index_change(const ShadingPoint& p) {
  if (p.principled && p.principled->thin) return 1;
  const float ior = index_of_refraction(p);
  const float eta = p.front ? ior : 1 / ior;
  return eta * eta;
}

/// What makes following light forwards and backwards the same where shading and geometric normal differ
/// (Veach 1997, section 5.3): 1 where they do not.
float normals_factor(const ShadingPoint& p, const Vec3f& onward) {
  const float factor = std::abs(dot(onward, p.ng) * dot(p.direction, p.ns)) /
                       std::abs(dot(p.direction, p.ng) * dot(onward, p.ns));
  return std::isfinite(factor) ? factor : 0;
}

/// The photons [first, last) of a pass.
class PhotonChunk {
 public:
  PhotonChunk(const RenderContext& context, const PhotonSource& source, const PhotonPlan& plan,
              std::uint32_t pass)
      : context_(context), source_(source), plan_(plan), choices_(plan.seed, pass) {}

  void trace(std::uint32_t first, std::uint32_t last) {
    first_ = first;
    emit(first, last);
    const unsigned most_levels = plan_.depth + 1 + kMostPassages;
    for (level_ = 0; level_ < most_levels && queue_.size() > 0; ++level_) {
      next_.clear();
      follow();
      std::swap(queue_, next_);
    }
    for (const Color& power : queue_.power) energy_.cut += double{color_weight(power)};
    std::stable_sort(stored_.begin(), stored_.end(),
                     [](const Stored& a, const Stored& b) { return a.number < b.number; });
  }

  void append_to(TracedPhotons& all) const {
    for (const Stored& s : stored_) all.photons.push_back(s.photon);
    all.energy += energy_;
  }

 private:
  struct Stored {
    std::uint32_t number;
    Photon photon;
  };

  void emit(std::uint32_t first, std::uint32_t last) {
    const float share = 1 / static_cast<float>(plan_.photons);
    std::vector<PhotonStart> starts;
    std::vector<TrackingNumbers> numbers;
    for (std::uint32_t number = first; number < last; ++number) {
      const auto start = source_.emit(choices_.point(number, PhotonDecision::light).x,
                                      choices_.point(number, PhotonDecision::place),
                                      choices_.point(number, PhotonDecision::direction));
      light_groups_.push_back(start ? context_.sampled->group(start->emitter) : std::uint8_t{0});
      if (!start) continue;
      starts.push_back(*start), numbers.push_back(choices_.before_start(number));
      queue_.push_back(start->ray, number, start->power * share, 1, 0, 0);
      energy_.emitted += double{color_weight(queue_.power.back())};
    }
    queue_.dielectrics = start_dielectrics(context_, starts);
    const std::vector<Color> reaching = reaching_start(context_, starts, queue_.dielectrics, numbers);
    for (std::size_t i = 0; i < starts.size(); ++i) energy_.absorbed += attenuate(i, reaching[i]);
  }

  /// Leaves the part `passing` of the power of photon `i` and returns what it loses.
  double attenuate(std::size_t i, const Color& passing) {
    const Color before = queue_.power[i];
    queue_.power[i] = before * passing;
    return double{color_weight(before)} - double{color_weight(queue_.power[i])};
  }

  void follow() {
    hits_.resize_uninitialized(queue_.size());
    closest_hit(*context_.world->accel, queue_.rays.span(), hits_.span(), context_.isa);
    std::vector<std::uint32_t> met;
    for (std::uint32_t i = 0; i < queue_.size(); ++i) {
      if (context_.tracks_dielectrics) pass_media(i);
      if (hits_.item[i] == kNoId)
        energy_.escaped += double{color_weight(queue_.power[i])};
      else if (max_component(queue_.power[i]) > 0)
        met.push_back(i);
    }
    InteractionBlock found;
    for (std::size_t first = 0; first < met.size(); first += InteractionBlock::kMost) {
      const std::size_t count = std::min(InteractionBlock::kMost, met.size() - first);
      surface_interactions(*context_.world->accel, queue_.rays, hits_, std::span(met).subspan(first, count),
                           found, context_.isa);
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t i = met[first + k];
        arrive(i, shading_point(context_, queue_.rays[i], hits_[i], {queue_.distance[i], false}, found[k]));
      }
    }
  }

  /// A photon that a medium scatters is lost: paths find its light by themselves.
  void pass_media(std::uint32_t i) {
    const Ray ray = queue_.rays[i];
    const double end =
        hits_.item[i] == kNoId ? std::numeric_limits<double>::infinity() : static_cast<double>(hits_.t[i]);
    energy_.media +=
        attenuate(i, passing_media(context_, queue_.dielectrics[i], {ray.origin, ray.direction, end},
                                   choices_.in_media(queue_.number[i], level_)));
  }

  /// `around`: the solids that the photon is in from here on; null if the scene tracks none.
  void push(std::size_t i, const ShadingPoint& p, const Vec3f& direction, const Color& power,
            float index_square, unsigned bounces, const DielectricStack* around) {
    Ray ray;
    ray.origin = offset_origin(p.surface, direction), ray.direction = direction;
    next_.push_back(ray, queue_.number[i], power, index_square, bounces, queue_.distance[i] + p.t);
    if (around != nullptr) next_.dielectrics.push_back(*around);
  }

  /// Solids count as in shade_path.
  void arrive(std::size_t i, ShadingPoint p) {
    if (disperses(p)) {
      const float u = choices_.channel(queue_.number[i], level_);
      energy_.absorbed += attenuate(i, disperse(p, queue_.power[i], u));
    }
    if (!context_.tracks_dielectrics) return meet(i, p, nullptr, nullptr);
    const DielectricStack& before = queue_.dielectrics[i];
    const Boundary boundary =
        boundary_at(*context_.world, before, p.surface, p.front, index_of_refraction(p));
    if (boundary.hidden)
      return push(i, p, p.direction, queue_.power[i], queue_.index_square[i], queue_.bounces[i],
                  &boundary.behind);
    if (boundary.ior) set_index_of_refraction(p, *boundary.ior);
    meet(i, p, &before, &boundary.behind);
  }

  /// Keeps the photon at a surface and sends it on. `before` and `behind`: the solids on both sides.
  void meet(std::size_t i, const ShadingPoint& p, const DielectricStack* before,
            const DielectricStack* behind) {
    const std::uint32_t number = queue_.number[i];
    const Color power = queue_.power[i];
    const unsigned bounces = queue_.bounces[i];
    const float index_square = queue_.index_square[i];
    if (p.opacity < 1 && choices_.number(number, PhotonDecision::hole, level_) >= p.opacity)
      return push(i, p, p.direction, power, index_square, bounces, behind);

    const SurfaceBsdf bsdf(p);
    const bool stored = bounces > 0 && !bsdf.only_delta();
    if (stored)
      stored_.push_back({number,
                         {p.surface.position, power * (1 / index_square), pack_direction(p.direction),
                          static_cast<std::uint16_t>(bounces), light_groups_[number - first_]}});
    const auto ends = [&](const Color& rest) {
      (stored ? energy_.stored : energy_.absorbed) +=
          double{color_weight(power)} - double{color_weight(rest)};
    };
    const auto next = bsdf.sample(choices_.number(number, PhotonDecision::lobe, level_),
                                  choices_.point(number, PhotonDecision::scattering, level_));
    if (!next || !next->delta) return ends({});
    const float change = next->transmitted ? index_change(p) : 1;
    Color onward = power * next->weight * normals_factor(p, next->direction);
    ends(onward);
    if (bounces + 1 > plan_.depth) {
      energy_.cut += double{color_weight(onward)};
      return;
    }
    if (!survives(number, bounces + 1, power, onward)) return;
    push(i, p, next->direction, onward, index_square * change, bounces + 1,
         next->transmitted ? behind : before);
  }

  /// Russian roulette by the part of the photon's power that goes on.
  bool survives(std::uint32_t number, unsigned bounces, const Color& before, Color& power) const {
    const float rest = color_weight(power);
    if (!(rest > 0)) return false;
    if (bounces <= kSureBounces) return true;
    const float chance = std::min(1.0f, rest / color_weight(before));
    if (choices_.number(number, PhotonDecision::roulette, level_) >= chance) return false;
    power *= 1 / chance;
    return true;
  }

  const RenderContext& context_;
  const PhotonSource& source_;
  const PhotonPlan& plan_;
  PhotonChoices choices_;
  unsigned level_ = 0;
  std::uint32_t first_ = 0;                 ///< number of the first photon
  std::vector<std::uint8_t> light_groups_;  ///< of all photons
  PhotonQueue queue_, next_;
  HitBatch hits_;
  std::vector<Stored> stored_;
  PhotonEnergy energy_;
};

}  // namespace

TracedPhotons trace_photons(const RenderContext& context, const PhotonSource& source, const PhotonPlan& plan,
                            std::uint32_t pass) {
  TracedPhotons all;
  if (source.empty()) return all;
  const Chunks chunks(plan.photons, kPhotonsTogether);
  std::vector<PhotonChunk> parts(chunks.count, PhotonChunk(context, source, plan, pass));
  chunks.each(true, [&](std::size_t c, std::size_t begin, std::size_t end) {
    parts[c].trace(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
  });
  for (const PhotonChunk& part : parts) part.append_to(all);
  return all;
}

}  // namespace oktett
