#include "io/scene/pov_queries.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>

#include "accel/accel.h"
#include "accel/point_query.h"
#include "core/povray_noise.h"
#include "io/pov/internal_functions.h"
#include "io/pov/noise_functions.h"
#include "io/pov/translate/translate.h"
#include "io/scene/readers.h"
#include "render/geometry.h"
#include "render/shading_point.h"
#include "render/warp.h"

namespace oktett {

using pov::Block;
using pov::Element;

/// Elements of blocks that one object may have, and that all which are kept may have.
static constexpr std::uint64_t kMostElements = 20'000'000, kMostKept = 60'000'000;
/// Objects that are kept.
static constexpr std::size_t kMostObjects = 1000;
/// In POV-Ray as large as what has no bounds.
static constexpr double kEndless = 1e10;

struct PovQueries::Surfaces {
  World world;
  Vec3d origin;             ///< from which places in `world` count
  bool is_there = false;    ///< false: nothing is left of it
  bool negative = false;    ///< it stands for all but what is in the world
  pov::Extent extent;       ///< as its statements say it
  std::uint64_t cost = 10;  ///< steps of a question
};

/// A pigment or a pattern.
struct PovQueries::Look {
  Scene scene;
  Color color{0, 0, 0};  ///< multiplies the texture
  std::uint32_t texture = kNoId;
  double filter = 0, transmit = 0;
};

/// What is kept of a block.
struct PovQueries::Asked {
  BlockPointer block;
  std::uint64_t weight = 0, functions = 0;
  std::unique_ptr<Surfaces> seen, solid;
  std::unique_ptr<Look> look;
};

PovQueries::PovQueries() = default;
PovQueries::~PovQueries() = default;

namespace {

const std::shared_ptr<const Block>* block_in(const Element& element) {
  const auto* const block = std::get_if<std::shared_ptr<const Block>>(&element.value);
  return block != nullptr && *block != nullptr ? block : nullptr;
}

/// Steps of the functions in a block, where a function that is called counts each time, up to a bound.
std::uint64_t function_steps(const pov::Function& function, int depth) {
  constexpr std::uint64_t kMost = 1'000'000;
  std::uint64_t sum = function.nodes.size();
  for (const pov::FunctionNode& node : function.nodes)
    if (node.function != nullptr && depth < 8 && sum < kMost)
      sum += function_steps(*node.function, depth + 1);
  return std::min(sum, kMost);
}
std::uint64_t function_steps(const Block& block) {
  if (block.keyword == "texture" || block.keyword == "pigment" || block.keyword == "normal") return 0;
  std::uint64_t sum = 0;
  for (const Element& element : block.elements)
    if (const auto* const function = std::get_if<std::shared_ptr<const pov::Function>>(&element.value))
      if (*function != nullptr) sum += function_steps(**function, 0);
  return sum;
}

/// How much is in a block, where what is declared counts once: it is shown by instances, unless it is small.
void add_weight(const Block& block, std::unordered_set<const Block*>& seen, std::uint64_t& sum,
                std::uint64_t& functions) {
  constexpr std::uint64_t kInstance = 100;
  sum += 1 + block.elements.size();
  functions += function_steps(block);
  for (const Element& element : block.elements) {
    if (sum > kMostElements) return;
    const std::shared_ptr<const Block>* const inner = block_in(element);
    if (inner == nullptr) continue;
    if (!(*inner)->name.empty()) {
      sum += kInstance;
      if (!seen.insert(inner->get()).second) continue;
    }
    add_weight(**inner, seen, sum, functions);
  }
}

/// What a question of a structure costs: exact surfaces are solved along the ray.
std::uint64_t cost_of(const Scene& scene) {
  std::uint64_t exact = 0, combined = 0;
  const auto add = [&](const auto& self, const std::vector<Object>& objects) -> void {
    for (const Object& object : objects) {
      exact += std::holds_alternative<ExactShape>(object.shape);
      if (const auto* const combination = std::get_if<CsgShape>(&object.shape))
        combined += combination->operands->size(), self(self, *combination->operands);
    }
  };
  add(add, scene.objects);
  for (const Prototype& prototype : scene.prototypes) add(add, prototype.objects);
  return 20 + 10 * std::min<std::uint64_t>(exact, 10) + std::min<std::uint64_t>(combined, 1000) / 4;
}

Vec3d vector(const pov::ObjectQueries::Point& p) { return {p[0], p[1], p[2]}; }
pov::ObjectQueries::Point point(const Vec3d& v) { return {v.x, v.y, v.z}; }
bool is_finite(const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
Vec3f single(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Vec3d twice(const Vec3f& v) { return {v.x, v.y, v.z}; }

}  // namespace

PovQueries::Weight PovQueries::weight(const Block& block) {
  std::unordered_set<const Block*> seen;
  std::uint64_t sum = 0, functions = 0;
  add_weight(block, seen, sum, functions);
  if (sum > kMostElements)
    throw document_->error(block.where, "this object is asked, and has more than " +
                                            std::to_string(kMostElements) + " elements");
  return {sum, functions};
}

PovQueries::Asked& PovQueries::find(const BlockPointer& block) {
  if (const auto known = places_.find(block.get()); known != places_.end()) {
    asked_.splice(asked_.begin(), asked_, known->second);
    return asked_.front();
  }
  const auto [heavy, functions] = weight(*block);
  while (!asked_.empty() && (asked_.size() >= kMostObjects || weight_ + heavy > kMostKept)) {
    weight_ -= asked_.back().weight;
    places_.erase(asked_.back().block.get());
    asked_.pop_back();
  }
  asked_.emplace_front().block = block;
  asked_.front().weight = heavy, asked_.front().functions = functions;
  weight_ += heavy;
  places_[block.get()] = asked_.begin();
  steps_ += heavy / 4;
  return asked_.front();
}

void PovQueries::warn(const std::vector<Warning>& warnings) {
  for (const Warning& warning : warnings) {
    const auto is_same = [&](const Warning& other) { return to_string(other) == to_string(warning); };
    if (warnings_.size() < 100 && std::ranges::none_of(warnings_, is_same)) warnings_.push_back(warning);
  }
}

template <class Make>
void PovQueries::at_place(const Asked& asked, const Make& make) {
  try {
    make();
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw document_->error(asked.block->where, error.what());
  }
}

const PovQueries::Surfaces& PovQueries::surfaces(Asked& asked, bool as_solid) {
  std::unique_ptr<Surfaces>& kept = as_solid ? asked.solid : asked.seen;
  if (!kept) at_place(asked, [&] { kept = make_surfaces(asked, as_solid); });
  return *kept;
}

std::unique_ptr<PovQueries::Surfaces> PovQueries::make_surfaces(const Asked& asked, bool as_solid) {
  steps_ += 500 + asked.weight * 2;
  // What the object asks while it is made must not take the place of what is kept here.
  PovQueries others;
  others.begin(*document_);
  const pov::TranslatedObject object = pov::translate_object(*document_, asked.block, as_solid, &others);
  steps_ += others.take_steps();
  warn(object.scene.warnings);
  auto made = std::make_unique<Surfaces>();
  made->is_there = object.is_there, made->negative = object.negative, made->extent = object.extent;
  if (object.is_there) {
    const Scene scene = read_scene_tree(*object.scene.root, object.scene.meshes);
    BuildOptions options;
    options.quality = BuildQuality::fast;
    made->world = build_world(scene, options);
    made->origin = scene.origin;
    made->cost = cost_of(scene) + asked.functions / 4;
    steps_ += made->world.triangles;
  }
  return made;
}

std::optional<bool> PovQueries::inside(const BlockPointer& object, const Point& point) {
  const Surfaces& s = surfaces(find(object), true);
  steps_ += s.cost;
  const Vec3d p = vector(point) - s.origin;
  if (!s.is_there) return std::nullopt;
  return oktett::inside(*s.world.accel, single(p)) != s.negative;
}

std::optional<pov::ObjectQueries::Hit> PovQueries::trace(const BlockPointer& object, const Point& origin,
                                                         const Point& direction) {
  const Surfaces& s = surfaces(find(object), false);
  steps_ += s.cost;
  Hit answer;
  const Vec3d from = vector(origin) - s.origin, way = vector(direction);
  const double size = length(way);
  if (!s.is_there || !is_finite(from) || !std::isfinite(size) || !(size > 0)) return answer;
  // What lies this near is where the ray begins.
  const double start = 1e-6 + 4e-7 * max_component(abs(from));
  Ray ray;
  ray.origin = single(from), ray.direction = single(way / size);
  ray.tmin = static_cast<float>(start);
  const oktett::Hit hit = closest_hit(*s.world.accel, ray);
  if (!hit.valid()) return answer;
  const SurfaceInteraction surface = surface_interaction(*s.world.accel, ray, hit);
  const Vec3d unit = way / size;
  answer.found = true;
  answer.point = oktett::point(vector(origin) + unit * dot(twice(surface.position) - from, unit));
  Vec3d normal = twice(surface.shading_normal);
  // The front of a flat triangle is the one that the left hand finds, as POV-Ray has it.
  const TriangleMesh* const mesh = mesh_point(*s.world.accel, hit).mesh;
  if (s.negative != (mesh != nullptr && mesh->normals.empty())) normal = normal * -1.0;
  answer.normal = oktett::point(normal / length(normal));
  return answer;
}

std::optional<std::pair<pov::ObjectQueries::Point, pov::ObjectQueries::Point>> PovQueries::extent(
    const BlockPointer& object) {
  const Surfaces& s = surfaces(find(object), false);
  steps_ += s.cost;
  const Box box = s.is_there ? s.world.bounds : Box{};
  const bool endless = s.negative || (s.is_there && (stats(*s.world.accel).unbounded > 0 || box.empty()));
  if (endless) return {{{-kEndless, -kEndless, -kEndless}, {kEndless, kEndless, kEndless}}};
  if (box.empty()) return {{{0, 0, 0}, {0, 0, 0}}};
  // The box here is rounded to floats. Where its statements say the same, or more, they are exact.
  Vec3d lo = twice(box.lo) + s.origin, hi = twice(box.hi) + s.origin;
  for (int k = 0; k < 3; ++k) {
    const double small = 1e-6 * std::max({1.0, std::abs(lo[k]), std::abs(hi[k])});
    if (s.extent.lo[k] > lo[k] - small && s.extent.lo[k] <= hi[k]) lo[k] = s.extent.lo[k];
    if (s.extent.hi[k] < hi[k] + small && s.extent.hi[k] >= lo[k]) hi[k] = s.extent.hi[k];
  }
  return {{oktett::point(lo), oktett::point(hi)}};
}

/// The colour of a pattern's value: black for 0, white for 1.
static std::shared_ptr<const Block> pigment_of_pattern(const Block& pattern) {
  constexpr std::string_view kFew[] = {"checker", "brick", "hexagon"};
  auto pigment = std::make_shared<Block>();
  pigment->keyword = "pigment", pigment->where = pattern.where;
  const auto grey = [&](double value) {
    return Element{pattern.where, pov::Numbers{{value, value, value, 0, 0}, 5, true}};
  };
  const auto entry = [&](double value) -> std::shared_ptr<const Block> {
    auto block = std::make_shared<Block>();
    block->keyword = "[", block->where = pattern.where;
    block->elements = {{pattern.where, pov::Numbers{{value}, 1, false}}, grey(value)};
    return block;
  };
  bool few = false;
  for (const Element& element : pattern.elements) {
    pigment->elements.push_back(element);
    const auto* const word = std::get_if<pov::Word>(&element.value);
    if (word == nullptr || few || std::ranges::find(kFew, word->text) == std::end(kFew)) continue;
    few = true;
    if (word->text == "hexagon")
      for (const double value : {0.0, 0.5, 1.0}) pigment->elements.push_back(grey(value));
    else
      for (const double value : {0.0, 1.0}) pigment->elements.push_back(grey(value));
  }
  if (few) return pigment;
  auto map = std::make_shared<Block>();
  map->keyword = "color_map", map->where = pattern.where;
  map->elements = {{pattern.where, entry(0)}, {pattern.where, entry(1)}};
  pigment->elements.push_back({pattern.where, std::shared_ptr<const Block>(map)});
  return pigment;
}

const PovQueries::Look& PovQueries::look(Asked& asked) {
  if (!asked.look) at_place(asked, [&] { asked.look = make_look(asked); });
  return *asked.look;
}

std::unique_ptr<PovQueries::Look> PovQueries::make_look(const Asked& asked) {
  steps_ += 500 + asked.weight * 2;
  const bool is_pigment = asked.block->keyword == "pigment";
  const pov::TranslatedScene translated =
      pov::translate_look(*document_, is_pigment ? asked.block : pigment_of_pattern(*asked.block));
  warn(translated.warnings);
  auto made = std::make_unique<Look>();
  made->scene = read_scene_tree(*translated.root, translated.meshes);
  const Scene& scene = made->scene;
  if (!scene.objects.empty() && scene.objects[0].material < scene.materials.size()) {
    const Material& material = scene.materials[scene.objects[0].material];
    // Of what lets light pass, the colour is that of the rest.
    const float left = 1 - material.transparency;
    made->color = left > 0 ? material.color / left : material.filter.value_or(material.color);
    made->texture = material.color_texture;
    made->transmit = material.transparency;
  }
  return made;
}

std::optional<std::array<double, 5>> PovQueries::pigment(const BlockPointer& block, const Point& point) {
  const Look& l = look(find(block));
  steps_ += 20;
  TexturePlace place{};
  place.position = vector(point);
  const Color color = texture_color(Textures{l.scene.textures, nullptr}, l.texture, place);
  return {{color.x * l.color.x, color.y * l.color.y, color.z * l.color.z, l.filter, l.transmit}};
}

std::optional<double> PovQueries::pattern(const BlockPointer& block, const Point& point) {
  const std::optional<std::array<double, 5>> color = pigment(block, point);
  if (!color) return std::nullopt;
  const bool has_three = std::ranges::any_of(block->elements, [](const Element& element) {
    const auto* const word = std::get_if<pov::Word>(&element.value);
    return word != nullptr && word->text == "hexagon";
  });
  return has_three ? 2 * (*color)[0] : (*color)[0];
}

NoiseGenerator PovQueries::noise_generator() {
  if (document_->statements.size() != statements_seen_ || document_->version != version_seen_) {
    statements_seen_ = document_->statements.size(), version_seen_ = document_->version;
    noise_generator_ = pov::noise_generator_of(*document_);
  }
  return noise_generator_;
}

std::optional<double> PovQueries::internal(std::uint32_t number, std::span<const double> arguments) {
  steps_ += 20;
  if ((number == pov::kNoiseFunction || number == pov::kNoiseGeneratorFunction) && arguments.size() >= 3)
    return povray_noise({arguments[0], arguments[1], arguments[2]},
                        arguments.size() > 3 ? pov::noise_generator_named(arguments[3]) : noise_generator());
  return pov::internal_value(number, arguments);
}

std::optional<pov::ObjectQueries::Point> PovQueries::turbulence(double lambda, double omega, int octaves,
                                                                const Point& point) {
  PatternTurbulence turbulence;
  turbulence.amount = {1, 1, 1}, turbulence.generator = NoiseGenerator::povray_2;
  turbulence.octaves = static_cast<std::uint32_t>(std::clamp(octaves, 1, 10));
  turbulence.lambda = lambda, turbulence.omega = omega;
  steps_ += 10 * turbulence.octaves;
  const Vec3d p = vector(point);
  return oktett::point(displaced(turbulence, p) - p);
}

}  // namespace oktett
