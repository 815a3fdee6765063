#include "bench/meadow.h"

#include <cmath>

#include "core/random.h"

namespace oktett::bench {
namespace {

constexpr std::size_t kModels = 61, kTriangles = 1'100'000;
constexpr double kShown = 19'500'000.0 / 4000;  // triangles of a plant, on average
constexpr double kSmallest = 800;               // triangles of the smallest model, about

struct Plan {
  std::size_t triangles = 0, plants = 0;
};

/// The x in [lo, hi] with f(x) = value; f must grow.
template <class F>
double solve(double lo, double hi, double value, const F& f) {
  for (int i = 0; i < 100; ++i) {
    const double mid = 0.5 * (lo + hi);
    (f(mid) < value ? lo : hi) = mid;
  }
  return 0.5 * (lo + hi);
}

/// Sizes of the models in geometric progression; smaller models get more plants, so that all sums are right.
std::vector<Plan> plan_models(double count) {
  const auto size = [](double ratio, std::size_t i) {
    return kSmallest * std::pow(ratio, static_cast<double>(i));
  };
  const double ratio = solve(1, 2, kTriangles, [&](double r) {
    double sum = 0;
    for (std::size_t i = 0; i < kModels; ++i) sum += size(r, i);
    return sum;
  });
  std::vector<Plan> models(kModels);
  for (std::size_t i = 0; i < kModels; ++i)
    models[i].triangles = 2 * static_cast<std::size_t>(std::lround(size(ratio, i) / 2));
  const auto plants = [&](double power, std::size_t i) {
    double sum = 0;
    for (const Plan& m : models) sum += std::pow(static_cast<double>(m.triangles), power);
    return count * std::pow(static_cast<double>(models[i].triangles), power) / sum;
  };
  const double power = solve(-2, 1, kShown * count, [&](double p) {
    double sum = 0;
    for (std::size_t i = 0; i < kModels; ++i) sum += plants(p, i) * static_cast<double>(models[i].triangles);
    return sum;
  });
  double wanted = 0;
  std::size_t given = 0;
  for (std::size_t i = 0; i < kModels; ++i) {
    wanted += plants(power, i);
    models[i].plants = static_cast<std::size_t>(std::lround(wanted)) - given;
    given += models[i].plants;
  }
  return models;
}

PlantKind kind_of(std::size_t model) {
  constexpr PlantKind kSmall[] = {PlantKind::grass, PlantKind::flower, PlantKind::fern};
  if (model < 24) return kSmall[model % 3];
  if (model < 40) return PlantKind::bush;
  return model % 3 == 0 ? PlantKind::conifer : PlantKind::tree;
}

}  // namespace

Meadow make_meadow(std::size_t plants) {
  Meadow meadow;
  const std::vector<Plan> plans = plan_models(static_cast<double>(plants));
  std::uint32_t count = 0;
  const std::uint64_t key = mix_bits(17);
  const auto random = [&] { return static_cast<double>(random_float(key, 0, count++)); };
  for (std::size_t i = 0; i < plans.size(); ++i) {
    meadow.kinds.push_back(kind_of(i));
    meadow.models.push_back(make_plant(kind_of(i), plans[i].triangles, static_cast<std::uint32_t>(i)));
    const bool tall = i >= 40;
    for (std::size_t k = 0; k < plans[i].plants; ++k) {
      // As wide as what the camera sees at that distance.
      const double near = tall ? 14 : 3,
                   depth = near + (tall ? 50 : 34) * (tall ? random() : std::pow(random(), 1.3));
      const double x = (2 * random() - 1) * (3 + 0.65 * depth), size = 0.8 + 0.4 * random();
      const double degrees = 360 * random(), height = size * (0.9 + 0.2 * random());
      meadow.plants.push_back({i, {size, height, size}, {x, 0, 27 - depth}, degrees});
    }
  }
  return meadow;
}

}  // namespace oktett::bench
