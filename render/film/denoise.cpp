/// \file Non-local means by Rousselle, Knaus and Zwicker (2012), whose distance of colours takes away what
/// noise alone explains, with weights by features as in Rousselle, Manzi and Zwicker (2013): albedo, normal
/// and depth. It departs from them in that colours are divided by the albedo before, so that textures stay
/// sharp, that features count as free of noise, and that one pass serves, without a choice among several
/// strengths.

#include "render/film/denoise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"

namespace oktett {
namespace {

constexpr int kTile = 64;
/// Added to the albedo that colours are divided by.
constexpr float kLeastAlbedo = 0.05f;
/// Half the width over which the estimate of the variance is smoothed.
constexpr int kVarianceReach = 2;
/// Squares of differences of features below which they count as alike, and the factor k_f^2 of the paper.
constexpr float kFeatureFloor = 2e-3f, kFeatureScale = 0.36f;
/// Nothing is nearer to 0 than a rounded colour.
constexpr float kLeastVariance = 1e-12f;

/// A picture in planes without gaps, read beyond its border as if the border went on.
struct SamplePlane {
  int width = 0, height = 0;
  std::vector<float> values;

  SamplePlane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * width + std::clamp(x, 0, width - 1);
  }
  float operator()(int x, int y) const { return values[index(x, y)]; }
};

/// All that the filter looks at.
struct Input {
  int width, height;
  std::vector<SamplePlane> color, variance;  ///< of three channels, divided by the albedo
  std::vector<SamplePlane> features;  ///< those, and the factor that makes their differences comparable:
  std::vector<SamplePlane> feature_scales;  ///< 1 / (k^2 max(floor, squared gradient))
  std::vector<float> albedo[3];             ///< what colours were divided by
};

const Column<float>& plane_of(const Picture& picture, const std::string& name) {
  const PicturePlane* plane = picture.find(name);
  if (plane == nullptr) throw Error("the picture cannot be denoised: it has no plane " + name);
  return plane->values;
}

float finite(float v) { return std::isfinite(v) ? v : 0; }

/// Means over squares, rows first, in a fixed order.
void smooth(SamplePlane& plane, int reach) {
  const float share = 1 / static_cast<float>(2 * reach + 1);
  for (const bool rows : {true, false}) {
    SamplePlane from = plane;
    tbb::parallel_for(0, plane.height, [&](int y) {
      for (int x = 0; x < plane.width; ++x) {
        float sum = 0;
        for (int k = -reach; k <= reach; ++k) sum += rows ? from(x + k, y) : from(x, y + k);
        plane.values[plane.index(x, y)] = sum * share;
      }
    });
  }
}

void add_feature(SamplePlane feature, Input& input) {
  SamplePlane scale(input.width, input.height);
  for (int y = 0; y < input.height; ++y)
    for (int x = 0; x < input.width; ++x) {
      // Of the two one-sided differences the smaller: the other may lead over an edge.
      const auto slope = [&](int dx, int dy) {
        const float here = feature(x, y);
        return std::min(std::abs(feature(x + dx, y + dy) - here), std::abs(feature(x - dx, y - dy) - here));
      };
      const float across = slope(1, 0), down = slope(0, 1);
      scale.values[scale.index(x, y)] =
          1 / (kFeatureScale * std::max(kFeatureFloor, across * across + down * down));
    }
  input.features.push_back(std::move(feature));
  input.feature_scales.push_back(std::move(scale));
}

Input read_input(const Picture& picture) {
  const int w = static_cast<int>(picture.width), h = static_cast<int>(picture.height);
  Input input{w, h, {}, {}, {}, {}, {}};
  const std::size_t size = static_cast<std::size_t>(w) * h;
  for (int k = 0; k < 3; ++k) {
    const std::string channel(1, "RGB"[k]), axis(1, "XYZ"[k]);
    const Column<float>&color = plane_of(picture, channel),
          &variance = plane_of(picture, "Variance." + channel),
          &albedo = plane_of(picture, "Albedo." + channel), &normal = plane_of(picture, "N." + axis);
    SamplePlane c(w, h), v(w, h), a(w, h), n(w, h);
    input.albedo[k].resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      const float divisor = input.albedo[k][i] = std::max(0.0f, finite(albedo[i])) + kLeastAlbedo;
      c.values[i] = finite(color[i]) / divisor;
      v.values[i] = std::max(0.0f, finite(variance[i])) / (divisor * divisor);
      a.values[i] = finite(albedo[i]), n.values[i] = finite(normal[i]);
    }
    smooth(v, kVarianceReach);
    input.color.push_back(std::move(c)), input.variance.push_back(std::move(v));
    add_feature(std::move(a), input), add_feature(std::move(n), input);
  }
  // Depth counts in parts of itself; what is infinitely far has 0.
  const Column<float>& depth = plane_of(picture, "Z");
  SamplePlane nearness(w, h);
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < size; ++i)
    if (depth[i] > 0) nearest = std::min(nearest, depth[i]);
  for (std::size_t i = 0; i < size; ++i)
    nearness.values[i] = depth[i] > 0 && std::isfinite(depth[i]) ? nearest / depth[i] : 0;
  add_feature(std::move(nearness), input);
  return input;
}

/// Falls from 1 at 0 like e^-x: (1 + x / 16)^-16.
float falling(float x) {
  float t = 1 + x * (1.0f / 16);
  for (int k = 0; k < 4; ++k) t *= t;
  return 1 / t;
}

/// Filters the pixels of one tile.
class TileFilter {
 public:
  TileFilter(const Input& input, const DenoiseOptions& options, int x0, int y0)
      : in_(input),
        options_(options),
        x0_(x0),
        y0_(y0),
        width_(std::min(kTile, input.width - x0)),
        height_(std::min(kTile, input.height - y0)),
        stride_(width_ + 2 * options.patch),
        weight_(static_cast<std::size_t>(width_) * height_) {
    for (auto& channel : sum_) channel.resize(weight_.size());
    distance_.resize(static_cast<std::size_t>(stride_) * (height_ + 2 * options.patch));
    rows_.resize(static_cast<std::size_t>(width_) * (height_ + 2 * options.patch));
  }

  void run() {
    for (int dy = -options_.window; dy <= options_.window; ++dy)
      for (int dx = -options_.window; dx <= options_.window; ++dx) add_offset(dx, dy);
  }

  void write(Picture& picture) const {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
        const std::size_t to = in_.color[0].index(x0_ + x, y0_ + y);
        float noise = 0;
        for (const SamplePlane& v : in_.variance) noise += v.values[to];
        if (noise == 0) continue;
        for (int k = 0; k < 3; ++k)
          picture.find(std::string(1, "RGB"[k]))->values[to] = sum_[k][at] / weight_[at] * in_.albedo[k][to];
      }
  }

 private:
  /// Adds the pixels that stand (dx, dy) away, each by its weight.
  void add_offset(int dx, int dy) {
    find_distances(dx, dy);
    const int p = options_.patch;
    const float share = 1 / static_cast<float>((2 * p + 1) * (2 * p + 1));
    for (int y = 0; y < height_ + 2 * p; ++y)
      for (int x = 0; x < width_; ++x) {
        float sum = 0;
        for (int k = 0; k <= 2 * p; ++k) sum += distance_[static_cast<std::size_t>(y) * stride_ + x + k];
        rows_[static_cast<std::size_t>(y) * width_ + x] = sum;
      }
    for (int y = 0; y < height_; ++y) {
      const int qy = y0_ + y + dy;
      if (qy < 0 || qy >= in_.height) continue;
      for (int x = 0; x < width_; ++x) {
        const int qx = x0_ + x + dx;
        if (qx < 0 || qx >= in_.width) continue;
        float sum = 0;
        for (int k = 0; k <= 2 * p; ++k) sum += rows_[static_cast<std::size_t>(y + k) * width_ + x];
        const std::size_t here = in_.color[0].index(x0_ + x, y0_ + y), there = in_.color[0].index(qx, qy);
        const float weight = falling(std::max(std::max(0.0f, sum * share), feature_distance(here, there)));
        const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
        weight_[at] += weight;
        for (int k = 0; k < 3; ++k) sum_[k][at] += weight * in_.color[k].values[there];
      }
    }
  }

  /// The distances of single pixels of the tile and of a rim as wide as the patch.
  void find_distances(int dx, int dy) {
    const int p = options_.patch;
    const float scale = options_.strength * options_.strength;
    for (int y = -p; y < height_ + p; ++y)
      for (int x = -p; x < width_ + p; ++x) {
        const std::size_t here = in_.color[0].index(x0_ + x, y0_ + y),
                          there = in_.color[0].index(x0_ + x + dx, y0_ + y + dy);
        float sum = 0;
        for (int k = 0; k < 3; ++k) {
          const float difference = in_.color[k].values[here] - in_.color[k].values[there];
          const float vp = in_.variance[k].values[here], vq = in_.variance[k].values[there];
          sum += (difference * difference - (vp + std::min(vp, vq))) / (kLeastVariance + scale * (vp + vq));
        }
        distance_[static_cast<std::size_t>(y + p) * stride_ + (x + p)] = sum * (1.0f / 3);
      }
  }

  float feature_distance(std::size_t here, std::size_t there) const {
    float greatest = 0;
    for (std::size_t f = 0; f < in_.features.size(); ++f) {
      const float difference = in_.features[f].values[here] - in_.features[f].values[there];
      greatest = std::max(greatest, difference * difference * in_.feature_scales[f].values[here]);
    }
    return greatest;
  }

  const Input& in_;
  const DenoiseOptions& options_;
  int x0_, y0_, width_, height_, stride_;
  std::vector<float> weight_, sum_[3];
  std::vector<float> distance_, rows_;  ///< of the offset in hand
};

}  // namespace

void denoise(Picture& picture, const DenoiseOptions& options) {
  const Input input = read_input(picture);
  for (const char* channel : {"R", "G", "B"}) {
    PicturePlane noisy = *picture.find(channel);
    noisy.name = std::string("Noisy.") + channel;
    picture.planes.push_back(std::move(noisy));
  }
  const int columns = (input.width + kTile - 1) / kTile, rows = (input.height + kTile - 1) / kTile;
  tbb::parallel_for(0, columns * rows, [&](int i) {
    TileFilter filter(input, options, i % columns * kTile, i / columns * kTile);
    filter.run();
    filter.write(picture);
  });
}

}  // namespace oktett
