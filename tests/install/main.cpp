// Rays against a square and a sphere, and a picture of one pixel, through the library's public headers alone.
// The lines between the two marks are the example of README.md.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

#include "accel/accel.h"
#include "io/image/image.h"

namespace {

void expect(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "failed: %s\n", what);
  std::exit(1);
}

/// `count` elements from anywhere, as a column of the library.
template <class T>
oktett::Column<T> column(std::span<const T> elements) {
  oktett::Column<T> result(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) result[i] = elements[i];
  return result;
}

}  // namespace

int main(int count, char** arguments) {
  expect(count == 2, "expected the name of an EXR file to write");
  const oktett::Vec3f corners[] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  oktett::TriangleMesh mesh;
  mesh.positions = column<oktett::Vec3f>(corners);
  mesh.indices = column<std::uint32_t>(triangles);

  // example
  std::vector<oktett::Geometry> things(2);
  things[0].shape = oktett::MeshGeometry{&mesh};
  things[1].shape = oktett::SpheresShape{{{{4, 0, 0}, 1.0}}};
  const auto accel = oktett::build_accel(things);

  oktett::RayBatch rays;
  for (int i = 0; i < 8; ++i) rays.push_back({{i - 2.5f, 0.25f, 5}, 0, {0, 0, -1}, 100});
  oktett::HitBatch hits;
  hits.resize_uninitialized(rays.size());
  oktett::closest_hit(*accel, rays.span(), hits.span(), oktett::default_isa());
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (hits[i].valid()) std::printf("ray %zu meets item %u at t = %g\n", i, hits[i].item, hits[i].t);
  // end of the example

  std::vector<std::uint8_t> occluded(rays.size());
  for (const oktett::Isa isa : oktett::available_isas()) {
    oktett::closest_hit(*accel, rays.span(), hits.span(), isa);
    oktett::any_hit(*accel, rays.span(), occluded.data(), isa);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const float x = rays[i].origin.x;
      const bool on_square = std::abs(x) < 1, on_sphere = std::abs(x - 4) < 1;
      expect(hits[i].valid() == (on_square || on_sphere), "hit or miss");
      expect(occluded[i] == hits[i].valid(), "any_hit agrees with closest_hit");
      if (on_square) expect(hits[i].t == 5 && hits[i].item < 2, "the square is five away");
      if (!on_sphere) continue;
      const float t = 5 - std::sqrt(1 - 0.0625f - (x - 4) * (x - 4));
      expect(hits[i].item == 2 && std::abs(hits[i].t - t) < 1e-5f, "the sphere is as far as it is");
    }
    std::vector<oktett::Hit> all;
    oktett::all_hits(*accel, rays[6], all, isa);
    expect(all.size() == 2, "a ray enters the sphere and leaves it");
  }

  oktett::closest_hit(*accel, rays.span(), hits.span(), oktett::Isa::scalar);
  const oktett::SurfaceInteraction s = oktett::surface_interaction(*accel, rays[2], hits[2]);
  expect(s.geometric_normal == oktett::Vec3f{0, 0, 1} && s.geometry == 0, "the square looks along z");

  oktett::Picture picture;
  picture.width = picture.height = 1;
  for (const char* name : {"R", "G", "B"})
    picture.planes.push_back({name, oktett::PlaneType::half_float, oktett::Column<float>(1, 0.5f), {}});
  oktett::write_image(arguments[1], picture);
  expect(oktett::read_image(arguments[1]).find("G")->values[0] == 0.5f,
         "a picture is read as it was written");
}
