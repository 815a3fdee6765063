#include "verify/oracles/random_scene.h"

#include <fmt/format.h>

#include <utility>

#include "core/random.h"
#include "verify/oracles/known_shapes.h"

namespace oktett {
namespace {

class SceneMaker {
 public:
  explicit SceneMaker(std::uint64_t number) : random_(mix_bits(number + kGoldenBits)) {}

  Scene make() {
    const double kind = random_.unit();
    if (kind < 0.15) around_ = Affine::translation({148376, 1234, -223423});
    if (kind > 0.7) {
      const double size = random_.magnitude(-9, 9);
      around_ = Affine::scaling({size, size, size});
    }
    const int prototypes = static_cast<int>(random_.unit() * 4);
    for (int i = 0; i < prototypes; ++i) add_prototype();
    const int count = 1 + static_cast<int>(random_.magnitude(0, 1.1));
    while (std::ssize(scene_.objects) < count) add_object();
    return std::move(scene_);
  }

 private:
  int pick(std::size_t n) { return static_cast<int>(random_.unit() * static_cast<double>(n)); }

  Affine place(double size) {
    const double s = size * random_.magnitude(-0.7, 0.3);
    return Affine::translation(random_.vector() * size) * Affine::scaling({s, s, s}) * random_turn(random_);
  }

  /// Any shape, or one with an inside.
  Object shape(bool solid) {
    Object object;
    for (;;) {
      const auto kind = static_cast<std::size_t>(pick(known_kinds().size()));
      const std::uint64_t number = random_.bits() >> 24;
      KnownShape known = draw_known_shape(kind, number);
      if (solid && !known.is_solid() && known_kinds()[kind] != "closed_mesh") continue;
      object.shape = std::move(known.shape);
      object.name = known_name(kind, number);
      return object;
    }
  }

  Object combination(int depth) {
    auto operands = std::make_shared<std::vector<Object>>();
    const int count = 2 + pick(2);
    for (int i = 0; i < count; ++i) {
      operands->push_back(depth < 2 && random_.unit() < 0.3 ? combination(depth + 1) : shape(true));
      operands->back().transform = place(0.5);
    }
    constexpr CsgOp kOps[] = {CsgOp::unite, CsgOp::intersect, CsgOp::subtract};
    Object object;
    object.shape = CsgShape{kOps[pick(3)], std::move(operands)};
    return object;
  }

  Object instance() {
    Object object;
    object.shape = InstanceShape{static_cast<std::uint32_t>(pick(scene_.prototypes.size()))};
    return object;
  }

  Object any() {
    const double kind = random_.unit();
    if (kind < 0.2 && !scene_.prototypes.empty()) return instance();
    return kind < 0.3 ? combination(0) : shape(false);
  }

  void add_prototype() {
    Prototype prototype{fmt::format("prototype {}", scene_.prototypes.size() + 1), {}};
    const int count = 1 + pick(3);
    for (int i = 0; i < count; ++i) {
      prototype.objects.push_back(any());
      prototype.objects.back().transform = place(1);
    }
    scene_.prototypes.push_back(std::move(prototype));
  }

  void add_object() {
    if (!scene_.prototypes.empty() && random_.unit() < 0.05) {
      // So many in a row become a list of instances.
      for (int i = 0; i < 70; ++i) {
        scene_.objects.push_back(instance());
        scene_.objects.back().transform = around_ * place(2);
      }
    }
    scene_.objects.push_back(any());
    scene_.objects.back().transform = around_ * place(1.5);
  }

  CaseRandom random_;
  Affine around_;
  Scene scene_;
};

}  // namespace

Scene draw_scene(std::uint64_t number) { return SceneMaker(number).make(); }

}  // namespace oktett
