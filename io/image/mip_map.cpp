#include "io/image/mip_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/color.h"

namespace oktett {

/// Two neighbours along an axis, and how far a place is on the way from the first to the second.
struct MipMap::Neighbours {
  std::uint32_t first, second;
  float fraction;
};

namespace {

/// The longer axis of a patch counts as at most this many times its shorter axis, so that look-ups end.
constexpr float kMostPoints = 16;

template <std::size_t N>
std::array<float, N> mix(const std::array<float, N>& a, const std::array<float, N>& b, float fraction) {
  std::array<float, N> result;
  for (std::size_t c = 0; c < N; ++c) result[c] = a[c] + (b[c] - a[c]) * fraction;
  return result;
}

/// What of one axis a pixel of the next level covers.
struct Cover {
  std::uint32_t begin, end;   ///< the pixels
  std::uint32_t first, last;  ///< how much of the outer ones, in parts of the next level's size
  std::uint32_t whole;        ///< such parts of a whole pixel

  float weight(std::uint32_t i) const {
    return static_cast<float>(i == begin ? first : i + 1 == end ? last : whole);
  }
};

/// Pixel `i` of `next`, which are as long as `size` pixels together.
Cover cover(std::uint32_t i, std::uint32_t size, std::uint32_t next) {
  const std::uint64_t from = std::uint64_t{i} * size, to = from + size;
  const std::uint64_t begin = from / next, end = (to + next - 1) / next;
  const auto part = [&](std::uint64_t pixel) {
    return static_cast<std::uint32_t>(std::min(to, (pixel + 1) * next) - std::max(from, pixel * next));
  };
  return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), part(begin), part(end - 1),
          next};
}

}  // namespace

MipMap::Neighbours MipMap::neighbours(float place, std::uint32_t size, TextureWrap wrap) {
  if (wrap == TextureWrap::repeat) place -= std::floor(place);
  if (wrap == TextureWrap::mirror) place -= 2 * std::floor(0.5f * place);
  const float x = place * static_cast<float>(size) - 0.5f;
  const float whole = std::floor(x);
  const auto first = static_cast<std::int32_t>(whole), count = static_cast<std::int32_t>(size);
  const auto wrapped = [&](std::int32_t i) {
    if (wrap == TextureWrap::clamp) return std::clamp(i, 0, count - 1);
    if (wrap == TextureWrap::repeat) return i < 0 ? i + count : i >= count ? i - count : i;
    // The image, then its mirror image, again and again.
    const std::int32_t in_pair = i < 0 ? -1 - i : i >= 2 * count ? i - 2 * count : i;
    return in_pair < count ? in_pair : 2 * count - 1 - in_pair;
  };
  return {static_cast<std::uint32_t>(wrapped(first)), static_cast<std::uint32_t>(wrapped(first + 1)),
          x - whole};
}

MipMap::MipMap(TexelImage image)
    : bytes_(std::move(image.bytes)),
      colors_(image.colors),
      alpha_(image.alpha),
      byte_channels_(static_cast<std::uint32_t>(image.channels())) {
  // Grey light has no primaries, and no 8-bit file says which it means.
  const bool converts = image.encoding.to_rec709.has_value() && colors_ == 3 && bytes_.empty();
  const bool is_linear = image.encoding.curve == TransferCurve::linear && !converts;
  stored_at_ = is_linear ? 0 : colors_;
  float_channels_ = stored_at_ + byte_channels_;
  for (std::size_t v = 0; v < 256; ++v) {
    stored_of_byte_[v] = static_cast<float>(v) / 255.0f;
    linear_of_byte_[v] = decode(image.encoding, stored_of_byte_[v]);
  }
  std::size_t numbers = 0;
  for (std::uint32_t width = image.width, height = image.height;;) {
    levels_.push_back({width, height, numbers});
    if (!in_bytes(levels_.size() - 1)) numbers += std::size_t{width} * height * float_channels_;
    if (width == 1 && height == 1) break;
    width = std::max(width / 2, 1u);
    height = std::max(height / 2, 1u);
  }
  floats_.resize_uninitialized(numbers);
  if (bytes_.empty()) {
    const float* in = image.floats.data();
    float* out = floats_.data();
    for (std::size_t i = 0; i < std::size_t{image.width} * image.height; ++i) {
      for (std::uint32_t c = 0; c < stored_at_; ++c) *out++ = decode(image.encoding, in[c]);
      if (converts) {
        const Color light = transformed(*image.encoding.to_rec709, {out[-3], out[-2], out[-1]});
        for (int c = 0; c < 3; ++c) out[c - 3] = light[c];
      }
      for (std::uint32_t c = 0; c < byte_channels_; ++c) *out++ = *in++;
    }
    image.floats.clear();
  }
  for (std::size_t level = 1; level < levels_.size(); ++level) halve(level);
}

/// The numbers of row `y` as in levels of floats.
void MipMap::expand_row(std::size_t level, std::uint32_t y, float* row) const {
  const std::size_t width = levels_[level].width;
  if (!in_bytes(level)) {
    const float* const from = floats_.data() + levels_[level].offset + y * width * float_channels_;
    std::copy(from, from + width * float_channels_, row);
    return;
  }
  const std::uint8_t* in = bytes_.data() + y * width * byte_channels_;
  for (std::size_t x = 0; x < width; ++x, in += byte_channels_) {
    for (std::uint32_t c = 0; c < stored_at_; ++c) *row++ = linear_of_byte_[in[c]];
    for (std::uint32_t c = 0; c < byte_channels_; ++c) *row++ = stored_of_byte_[in[c]];
  }
}

/// Makes `level` of the one above.
void MipMap::halve(std::size_t level) {
  const Level above = levels_[level - 1], here = levels_[level];
  const std::size_t channels = float_channels_, row_size = above.width * channels;
  tbb::parallel_for(std::uint32_t{0}, here.height, [&](std::uint32_t y) {
    std::vector<float> row(row_size);
    std::vector<double> sums(row_size);
    const Cover rows = cover(y, above.height, here.height);
    for (std::uint32_t i = rows.begin; i < rows.end; ++i) {
      expand_row(level - 1, i, row.data());
      const double weight = rows.weight(i);
      for (std::size_t k = 0; k < row_size; ++k) sums[k] += weight * static_cast<double>(row[k]);
    }
    const double area = static_cast<double>(above.width) * static_cast<double>(above.height);
    float* out = floats_.data() + here.offset + y * here.width * channels;
    for (std::uint32_t x = 0; x < here.width; ++x) {
      const Cover columns = cover(x, above.width, here.width);
      for (std::size_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (std::uint32_t i = columns.begin; i < columns.end; ++i)
          sum += static_cast<double>(columns.weight(i)) * sums[i * channels + c];
        *out++ = static_cast<float>(sum / area);
      }
    }
  });
}

template <std::size_t N>
std::array<float, N> MipMap::texel(std::size_t level, std::uint32_t x, std::uint32_t y,
                                   const Channels& channels) const {
  const std::size_t pixel = std::size_t{y} * levels_[level].width + x;
  std::array<float, N> result;
  if (in_bytes(level)) {
    const std::uint8_t* const in = bytes_.data() + pixel * byte_channels_ + channels.in_bytes;
    for (std::size_t c = 0; c < N; ++c) result[c] = channels.of_byte[in[c]];
  } else {
    const float* const in =
        floats_.data() + levels_[level].offset + pixel * float_channels_ + channels.in_floats;
    for (std::size_t c = 0; c < N; ++c) result[c] = in[c];
  }
  return result;
}

template <std::size_t N>
std::array<float, N> MipMap::bilinear(std::size_t level, float s, float t, TextureLookup lookup,
                                      const Channels& channels) const {
  const Neighbours x = neighbours(s, levels_[level].width, lookup.u),
                   y = neighbours(t, levels_[level].height, lookup.v);
  const auto row = [&](std::uint32_t i) {
    return mix(texel<N>(level, x.first, i, channels), texel<N>(level, x.second, i, channels), x.fraction);
  };
  return mix(row(y.first), row(y.second), y.fraction);
}

/// The pixel of the image that (s, t) is in.
template <std::size_t N>
std::array<float, N> MipMap::nearest(float s, float t, TextureLookup lookup, const Channels& channels) const {
  const auto pixel = [](float place, std::uint32_t size, TextureWrap wrap) {
    const Neighbours n = neighbours(place, size, wrap);
    return n.fraction < 0.5f ? n.first : n.second;
  };
  return texel<N>(0, pixel(s, levels_[0].width, lookup.u), pixel(t, levels_[0].height, lookup.v), channels);
}

/// At (s, t), in levels whose pixels are as large as `size` pixels of the image, which is at least 1.
template <std::size_t N>
std::array<float, N> MipMap::trilinear(float size, float s, float t, TextureLookup lookup,
                                       const Channels& channels) const {
  // size = 2^level * (1 + fraction)
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(size);
  const std::size_t level = (bits >> 23) - 127, last = levels_.size() - 1;
  if (level >= last) return bilinear<N>(last, s, t, lookup, channels);
  const float fraction = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u) - 1;
  const std::array<float, N> fine = bilinear<N>(level, s, t, lookup, channels);
  return fraction > 0 ? mix(fine, bilinear<N>(level + 1, s, t, lookup, channels), fraction) : fine;
}

template <std::size_t N>
std::array<float, N> MipMap::filtered(const TexturePatch& p, TextureLookup lookup,
                                      const Channels& channels) const {
  // The axes of the ellipse J x of all |x| = 1 are the singular vectors of J, in pixels of the image.
  const auto width = static_cast<float>(levels_[0].width), height = static_cast<float>(levels_[0].height);
  const float sx = p.dsdx * width, sy = p.dsdy * width, tx = p.dtdx * height, ty = p.dtdy * height;
  const float ss = sx * sx + sy * sy, st = sx * tx + sy * ty, tt = tx * tx + ty * ty;
  const float half = (ss - tt) * 0.5f, root = std::sqrt(half * half + st * st);
  const float longer = std::sqrt((ss + tt) * 0.5f + root);
  if (!(longer > 1)) {
    if (lookup.magnified == TextureFilter::nearest) return nearest<N>(p.s, p.t, lookup, channels);
    return bilinear<N>(0, p.s, p.t, lookup, channels);
  }
  const float shorter = std::max({std::abs(sx * ty - sy * tx) / longer, longer / kMostPoints, 1.0f});
  // A circle is one point, although its axes are rounded.
  const int points = static_cast<int>(std::ceil(longer / shorter - 0.01f));
  float s = half >= 0 ? half + root : st, t = half >= 0 ? st : root - half;
  const float length = std::sqrt(s * s + t * t);
  if (points <= 1 || !(length > 0)) return trilinear<N>(shorter, p.s, p.t, lookup, channels);
  s = s / length * longer / width;
  t = t / length * longer / height;
  const auto count = static_cast<float>(points);
  std::array<float, N> sum{};
  for (int i = 0; i < points; ++i) {
    const float at = (static_cast<float>(i) + 0.5f) / count - 0.5f;
    const std::array<float, N> point = trilinear<N>(shorter, p.s + at * s, p.t + at * t, lookup, channels);
    for (std::size_t c = 0; c < N; ++c) sum[c] += point[c];
  }
  for (float& v : sum) v /= count;
  return sum;
}

Color MipMap::colors(const TexturePatch& patch, TextureLookup lookup, const Channels& channels) const {
  if (colors_ == 1) {
    const float grey = filtered<1>(patch, lookup, channels)[0];
    return {grey, grey, grey};
  }
  const std::array<float, 3> rgb = filtered<3>(patch, lookup, channels);
  return {rgb[0], rgb[1], rgb[2]};
}

Color MipMap::color(const TexturePatch& patch, TextureLookup lookup) const {
  return colors(patch, lookup, {0, 0, linear_of_byte_.data()});
}

Color MipMap::stored(const TexturePatch& patch, TextureLookup lookup) const {
  return colors(patch, lookup, {0, stored_at_, stored_of_byte_.data()});
}

float MipMap::channel(ImageChannel channel, const TexturePatch& patch, TextureLookup lookup) const {
  if (channel == ImageChannel::luminance && colors_ == 3) return luminance(stored(patch, lookup));
  auto place = static_cast<std::uint32_t>(channel);
  if (channel == ImageChannel::alpha) {
    if (!alpha_) return 1;
    place = colors_;
  } else if (colors_ == 1) {
    place = 0;
  }
  return filtered<1>(patch, lookup, {place, stored_at_ + place, stored_of_byte_.data()})[0];
}

}  // namespace oktett
