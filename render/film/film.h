#pragma once
/// \file Sums the samples of a pixel and writes pixels to the picture.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/picture.h"
#include "render/render_options.h"
#include "render/transport/wavefront.h"

namespace oktett {

// ---- Layers of light groups in a picture: what the lights of one group alone would show.

/// Adds the planes light_NAME.R, light_NAME.G and light_NAME.B of each group, black, to a picture.
void add_light_planes(const std::vector<std::string>& names, Picture& picture);

/// The first of these planes; the number of all planes if there is none.
std::size_t first_light_plane(const Picture& picture);

/// Adds sample `i`, which is finite, to the sums of a pixel: red, green and blue of each group.
void add_to_layers(const SampleBatch& samples, std::size_t i, double* sums);

// ---- Shadow catchers.

/// Numbers of what the samples of a pixel see of shadow catchers, or sums of them: light that leaves the
/// catchers with all objects and without those that are no catchers, the background behind them times what
/// they cover, what they cover, and what they cover of a transparent background.
using CaughtLight = std::array<double, 11>;

/// The planes of the light that catchers receive with other objects over that without, weighted by what they
/// cover; 1 where there is none.
void add_catcher_planes(Picture& picture);
/// The first of them; the number of all planes if there is none.
std::size_t first_catcher_plane(const Picture& picture);

/// What sample `i` of the first half of `samples` sees of catchers, `bare` being that without other objects.
CaughtLight caught_light(const RenderContext& context, const SampleBatch& samples, const SampleBatch& bare,
                         std::size_t i);

/// Adds to a pixel that is written what its shadow catchers show. `planes`: as first_catcher_plane.
void write_caught(Picture& picture, std::size_t planes, std::size_t at, std::span<const double> sums,
                  std::uint32_t samples);

/// Writes the means over `samples` samples of a pixel to the planes from `first` on at place `at`.
void write_layers(Picture& picture, std::size_t first, std::size_t at, std::span<const double> sums,
                  std::uint32_t samples);

// ---- Pixels.

/// Sums over the samples of one pixel, added in the order of their numbers.
struct PixelSum {
  double color[3] = {}, square[3] = {};
  double alpha = 0;
  double depth = 0, normal[3] = {}, geometric_normal[3] = {}, position[3] = {}, albedo[3] = {}, uv[2] = {};
  std::uint32_t good = 0;  ///< samples without NaN and infinities; the others are left out
  std::uint32_t hits = 0;  ///< of the good samples, those that met a surface
  float nearest = 0;       ///< squared distance from the pixel's centre of the sample that gave the ids
  bool has_ids = false;
  std::uint32_t primitive = kNoId, object = kNoId;
};

/// Adds sample `i`; false if it is left out because it holds NaN or infinity.
bool add_to_pixel(PixelSum& pixel, const SampleBatch& samples, std::size_t i);

/// The plane that holds the number of samples of each pixel in adaptive sampling.
inline constexpr const char* kSampleCountPlane = "sampleCount.I";

/// Which planes a picture has, and where it lies in its frame.
struct FilmFormat {
  PixelWindow window;
  std::uint32_t full_width = 1, full_height = 1;
  bool data_layers = false;
  bool sample_counts = false;               ///< the plane kSampleCountPlane; only with data layers
  bool mattes = false;                      ///< the planes of add_matte_planes; only with data layers
  std::vector<std::string> light_groups{};  ///< of the planes of add_light_planes; only with data layers
  bool catchers = false;                    ///< sums of what shadow catchers show, see CaughtLight

  /// Sums of a pixel beside its PixelSum.
  std::size_t more_sums() const;
};
bool operator==(const FilmFormat& a, const FilmFormat& b);

/// That of a picture of `context`.
FilmFormat format_of(const RenderContext& context);

/// An empty picture with the planes of a render: black and transparent, Z infinite, all ids kNoId.
///
/// Beauty: R, G, B and A are means over the samples. A is the fraction covered. A background that gives light
/// counts as covering and a black one does not, so colours are always premultiplied by A. Data layers (if
/// `data_layers`) describe the first surface that each camera ray meets:
/// - Z is the distance along the view axis, not along the ray, as compositing programs expect; infinite where
///   there is no surface. P is the position in world space; u and v are the texture coordinates. All of them
///   are means over the samples that met a surface.
/// - N is the shading normal in world space as lights see it, with normal and bump maps, Ng the true normal
/// of
///   the surface; both point out of solids. Albedo is the base colour. All are means over all samples, with 0
///   for those that met nothing, as denoisers expect: at edges normals are shorter than 1.
/// - primID.I is the primitive in its geometry, geomID.I the object in the scene (as World counts them). They
///   are those of the sample nearest to the pixel's centre, never filtered.
/// - Variance is that of the pixel's mean, estimated from its samples; 0 with fewer than two.
/// - sampleCount.I, in adaptive sampling only, is the number of the pixel's samples.
/// Planes of mattes and of light groups follow.
Picture make_picture(const FilmFormat& format);

/// R, G, B and A of the pixels of a tile, in the order of their numbers. A tile without data layers is
/// gathered here and then copied to the picture row by row.
class TileColors {
 public:
  /// `count` pixels, which are set before the tile is copied.
  void begin(std::size_t count);
  /// Makes pixels black and transparent.
  void clear(std::size_t first, std::size_t count);
  /// Sets pixels `first`, `first` + 1, ... to the samples, one for each. Pixels whose sample holds NaN or
  /// infinity become black and transparent; returns their number.
  std::size_t set(std::size_t first, const SampleBatch& samples, Isa isa);
  /// Sets a pixel to the mean of its samples; black and transparent if all of them are bad.
  void set(std::size_t number, const PixelSum& sum);
  /// Copies the tile to the picture. `numbers` holds those of its pixels, row by row.
  void copy_to(Picture& picture, const FinishedTile& tile, const std::vector<std::uint32_t>& numbers) const;

 private:
  Column<float> plane_[4];
};

/// Writes R, G, B and A of a finished pixel of a picture without data layers, see write_pixel.
void write_color(Picture& picture, std::uint32_t x, std::uint32_t y, const PixelSum& pixel);

/// Writes all planes of a finished pixel, (x, y) counted in the picture. Threads may write different pixels
/// at the same time.
void write_pixel(Picture& picture, std::uint32_t x, std::uint32_t y, const PixelSum& pixel);

}  // namespace oktett
