#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/povray_scene.h"
#include "bench/program.h"
#include "bench/terrain.h"
#include "kernels/heights/height_grid.h"

namespace oktett::bench {

namespace {

constexpr double kSide = 24, kTall = 5;
/// The colour tells which square of a chequered pattern was hit. Squares along a side:
constexpr double kSquares = 512;

/// A PGM picture. POV-Ray reads it from the bottom up.
std::string pgm_text(const Column<std::uint16_t>& heights, std::uint32_t n) {
  std::string text = fmt::format("P5\n{} {}\n65535\n", n, n);
  for (std::uint32_t row = n; row-- > 0;)
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint16_t h = heights[column + std::size_t{row} * n];
      text += {static_cast<char>(h >> 8), static_cast<char>(h & 255)};
    }
  return text;
}

std::uint32_t square_at(long double x, long double z) {
  const auto whole = [](long double p) { return static_cast<long long>(std::floor(p / kSide * kSquares)); };
  return 1 + static_cast<std::uint32_t>((whole(x) + whole(z)) & 1);
}

/// Where a ray first meets the triangles, testing every cell that it passes over.
class Oracle {
 public:
  explicit Oracle(std::shared_ptr<const HeightGrid> grid)
      : grid_(std::move(grid)), cells_(static_cast<int>(grid_->columns()) - 1) {}

  std::uint32_t operator()(const Ray& ray) const {
    const long double per_unit = cells_ / static_cast<long double>(kSide), tall = kTall / 65535.0L;
    const auto grid = [&](long double v) { return v * per_unit; };
    const Vec3l o{grid(ray.origin.x) + cells_ / 2.0L, ray.origin.y / tall,
                  grid(ray.origin.z) + cells_ / 2.0L};
    const Vec3l d{grid(ray.direction.x), ray.direction.y / tall, grid(ray.direction.z)};
    const int x = d.x < 0 ? -1 : 1, z = d.z < 0 ? -1 : 1;
    const auto meet = [](long double line, long double from, long double by) {
      return by == 0 ? HUGE_VALL : (line - from) / by;
    };
    long double t = 0;
    for (const auto& [from, by] : {std::pair{o.x, d.x}, {o.z, d.z}})
      if (from < 0 || from > cells_) t = std::max(t, meet(by < 0 ? cells_ : 0, from, by));
    const auto cell = [&](long double p) {
      return std::clamp(static_cast<int>(std::floor(p)), 0, cells_ - 1);
    };
    int i = cell(o.x + t * d.x), j = cell(o.z + t * d.z);
    while (i >= 0 && i < cells_ && j >= 0 && j < cells_) {
      const long double hit = in_cell(o, d, i, j);
      if (hit < HUGE_VALL)
        return square_at(ray.origin.x + hit * ray.direction.x, ray.origin.z + hit * ray.direction.z);
      const long double tx = meet(x > 0 ? i + 1 : i, o.x, d.x), tz = meet(z > 0 ? j + 1 : j, o.z, d.z);
      (tx < tz ? i : j) += tx < tz ? x : z;
    }
    return 0;
  }

 private:
  long double in_cell(const Vec3l& o, const Vec3l& d, int i, int j) const {
    const auto at = [&](int x, int z) -> long double {
      return grid_->at(static_cast<std::uint32_t>(i + x), static_cast<std::uint32_t>(j + z));
    };
    const long double a = at(0, 0), b = at(1, 0), c = at(0, 1), e = at(1, 1), x = o.x - i, z = o.z - j;
    long double first = HUGE_VALL;
    const auto face = [&](long double h, long double by_x, long double by_z, bool low) {
      const long double t = (h + by_x * x + by_z * z - o.y) / (d.y - by_x * d.x - by_z * d.z);
      const long double u = x + t * d.x, v = z + t * d.z, slack = 1e-12L;
      if (t > 0 && u >= -slack && v >= -slack && u <= 1 + slack && v <= 1 + slack &&
          (low ? u + v <= 1 + slack : u + v >= 1 - slack))
        first = std::min(first, t);
    };
    face(a, b - a, c - a, true);
    face(c + b - e, e - c, e - b, false);
    return first;
  }

  std::shared_ptr<const HeightGrid> grid_;
  int cells_;
};

}  // namespace

Field make_terrain_field(std::uint32_t width, std::uint32_t height, const std::string& directory) {
  Field field{empty_field(width, height), field_head(false), field_head(true), {}, {}, {}};
  Column<std::uint16_t> heights = terrain(kTerrainSide);
  write_text(directory + "/terrain.pgm", pgm_text(heights, kTerrainSide));
  const auto text = [](const std::string& pigment) {
    return fmt::format(
        "height_field {{ pgm \"terrain.pgm\" gamma 1.0 scale <{0}, {1}, {0}> translate <{2}, 0, {2}> pigment "
        "{{ {3} }} }}\n",
        kSide, kTall, -kSide / 2, pigment);
  };
  field.pov += text("rgb <0.6, 0.55, 0.4>");
  field.pov_ids += text(fmt::format("checker {}, {} scale <{}, 1000, {}> translate <0, -500, 0>", id_color(1),
                                    id_color(2), kSide / kSquares, kSide / kSquares));
  HeightFieldShape shape;
  shape.grid =
      HeightGrid::from_words(kTerrainSide, kTerrainSide, std::move(heights), HeightInterpolation::triangles);
  shape.size = {kSide, kTall, kSide};
  field.right = Oracle(shape.grid);
  field.id = [](const SurfaceInteraction& s) { return square_at(s.position.x, s.position.z); };
  Object& object = field.scene.objects.emplace_back();
  object.shape = ExactShape{shape};
  object.material = 0;
  field.scene.materials.push_back(field_material({0.6f, 0.55f, 0.4f}));
  return field;
}

}  // namespace oktett::bench
