/// \file The first rays of a wavefront: where samples pass the film and the lens.

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "core/random.h"
#include "render/sampling/owen_sobol.h"
#include "render/transport/integrators.h"
#include "render/transport/render_code.h"
#include "render/transport/sample_dimensions.h"
#include "render/transport/wavefront.h"

namespace oktett {
namespace {

std::uint64_t key_of(const RenderContext& context, const WavefrontPixel& pixel) {
  return pixel_key(context.settings.seed, static_cast<std::uint64_t>(pixel.y) * context.full_width + pixel.x);
}

/// Places the only sample of each pixel at its centre.
void centre_samples(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                    Wavefront& wavefront) {
  SampleBatch& s = wavefront.samples;
  const std::size_t count = pixels.size();
  for (std::size_t i = 0; i < count; ++i) {
    wavefront.film_x[i] = pixels[i].x + 0.5, wavefront.film_y[i] = pixels[i].y + 0.5;
    s.pixel[i] = pixels[i].number;
  }
  std::fill_n(s.number.data(), count, 0u);
  std::fill_n(s.offset.data(), count, Vec2f{0, 0});
  if (traits(context.settings.kind).random_numbers)
    for (std::size_t i = 0; i < count; ++i) s.key[i] = key_of(context, pixels[i]);
}

/// Places samples [first, last) of each pixel by the filter.
void spread_samples(const RenderContext& context, std::span<const WavefrontPixel> pixels, std::uint32_t first,
                    std::uint32_t last, Wavefront& wavefront) {
  SampleBatch& s = wavefront.samples;
  const bool square = context.filter.is_pixel();
  std::size_t i = 0;
  for (const WavefrontPixel& pixel : pixels) {
    const std::uint64_t key = key_of(context, pixel);
    render_code(context.isa)
        .sobol_points(first, last, sequence_key(key, dimension(Decision::film)), wavefront.film_x.data() + i,
                      wavefront.film_y.data() + i);
    for (std::uint32_t number = first; number < last; ++number, ++i) {
      SquareSample at{wavefront.film_x[i], wavefront.film_y[i]};
      if (!square) at = {context.filter.offset(at.x) + 0.5, context.filter.offset(at.y) + 0.5};
      wavefront.film_x[i] = pixel.x + at.x, wavefront.film_y[i] = pixel.y + at.y;
      s.pixel[i] = pixel.number, s.number[i] = number, s.key[i] = key;
      s.offset[i] = {static_cast<float>(at.x - 0.5), static_cast<float>(at.y - 0.5)};
    }
  }
}

/// Places samples [first, last) of each pixel on the lens.
void spread_over_lens(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                      std::uint32_t first, std::uint32_t last, Wavefront& wavefront) {
  const std::size_t count = wavefront.samples.size();
  wavefront.lens_x.resize_uninitialized(count), wavefront.lens_y.resize_uninitialized(count);
  std::size_t i = 0;
  for (const WavefrontPixel& pixel : pixels) {
    render_code(context.isa)
        .sobol_points(first, last, sequence_key(key_of(context, pixel), kLensDimension),
                      wavefront.lens_x.data() + i, wavefront.lens_y.data() + i);
    i += last - first;
  }
}

/// The lens is cut into so many parts along each edge of its square.
constexpr int kLensEdge = 4;

/// Which part of the lens each sample passes.
Column<std::uint8_t> parts_of_lens(const Wavefront& wavefront) {
  const std::size_t count = wavefront.samples.size();
  const double *x = wavefront.lens_x.data(), *y = wavefront.lens_y.data();
  Column<std::uint8_t> part;
  part.resize_uninitialized(count);
  for (std::size_t i = 0; i < count; ++i)
    part[i] = static_cast<std::uint8_t>(static_cast<int>(y[i] * kLensEdge) * kLensEdge +
                                        static_cast<int>(x[i] * kLensEdge));
  return part;
}

/// Sorts the camera rays by the part of the lens that they leave, and numbers their samples. Neighbouring
/// pixels' rays from one part keep closer together than a pixel's rays from the whole lens, so fewer rays
/// leave their packets.
void sort_by_lens(Wavefront& wavefront) {
  const Column<std::uint8_t> part = parts_of_lens(wavefront);
  std::array<std::uint32_t, kLensEdge * kLensEdge + 1> first{};
  for (const std::uint8_t p : part) ++first[p + 1];
  for (std::size_t p = 1; p < first.size(); ++p) first[p] += first[p - 1];
  Column<std::uint32_t>& sample = wavefront.rays.sample;
  for (std::size_t i = 0; i < part.size(); ++i) sample[first[part[i]]++] = static_cast<std::uint32_t>(i);
  Column<float> sorted;
  for (Column<float>* parts : {wavefront.rays.rays.origin, wavefront.rays.rays.direction})
    for (int k = 0; k < 3; ++k) {
      sorted.resize_uninitialized(part.size());
      for (std::size_t i = 0; i < part.size(); ++i) sorted[i] = parts[k][sample[i]];
      std::swap(sorted, parts[k]);
    }
}

/// Chooses the points of area lights for samples [first, last) of each pixel.
void choose_patterns(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                     std::uint32_t first, std::uint32_t last, SampleBatch& samples) {
  samples.pattern.resize_uninitialized(samples.size());
  std::size_t i = 0;
  for (const WavefrontPixel& pixel : pixels)
    for (std::uint32_t number = first; number < last; ++number)
      samples.pattern[i++] = context.area_lights.pattern(pixel.x, pixel.y, number);
}

}  // namespace

void camera_rays(const CameraFrame& camera, const FilmPoints& points, RayBatch& rays, Isa isa) {
  const std::size_t count = rays.size();
  const Ray like;
  std::fill_n(rays.tmin.data(), count, like.tmin);
  std::fill_n(rays.tmax.data(), count, like.tmax);
  if (camera.lens_radius > 0) return render_code(isa).lens_rays(camera, points, rays);
  if (camera.projection != Projection::perspective) {
    for (std::size_t i = 0; i < count; ++i) rays.set(i, camera_ray(camera, points.x[i], points.y[i]));
    return;
  }
  const Vec3f origin(camera.origin);
  for (int k = 0; k < 3; ++k) std::fill_n(rays.origin[k].data(), count, origin[k]);
  float* const directions[3] = {rays.direction[0].data(), rays.direction[1].data(), rays.direction[2].data()};
  render_code(isa).view_directions(
      {camera.corner, camera.per_pixel_x, camera.per_pixel_y},
      {points.x.data(), points.y.data(), count, {directions[0], directions[1], directions[2]}});
}

void start_wavefront(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                     std::uint32_t first, std::uint32_t last, Wavefront& wavefront) {
  const std::size_t count = pixels.size() * (last - first);
  wavefront.level = 0;
  wavefront.whole_pixels = last - first == context.settings.samples;
  wavefront.next.clear();
  const bool path = traits(context.settings.kind).traces_paths;
  const std::size_t lights = context.lights.size() + context.area_lights.samples;
  wavefront.shadows.resize(path ? kAreaQueue + 1 : std::max<std::size_t>(1, lights));
  wavefront.film_x.resize_uninitialized(count), wavefront.film_y.resize_uninitialized(count);
  wavefront.samples.resize_uninitialized(count, context.data_layers);
  wavefront.rays.resize_uninitialized(count);
  if (context.settings.samples == 1 && first == 0)
    centre_samples(context, pixels, wavefront);
  else
    spread_samples(context, pixels, first, last, wavefront);
  if (!context.area_lights.empty()) choose_patterns(context, pixels, first, last, wavefront.samples);
  if (context.camera.lens_radius > 0) spread_over_lens(context, pixels, first, last, wavefront);
  camera_rays(context.camera, {wavefront.film_x, wavefront.film_y, &wavefront.lens_x, &wavefront.lens_y},
              wavefront.rays.rays, context.isa);
  // With fewer samples, those of one part of the lens lie too far apart on the film.
  if (context.camera.lens_radius > 0 && last - first >= kLensEdge * kLensEdge)
    sort_by_lens(wavefront);
  else
    std::iota(wavefront.rays.sample.begin(), wavefront.rays.sample.end(), 0u);
  wavefront.counts.camera += count;
}

}  // namespace oktett
