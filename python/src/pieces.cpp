#include "python/src/pieces.h"

#include <algorithm>

namespace oktett::python {
namespace {

constexpr std::size_t kTile = 8;
constexpr std::size_t kStrip = kPiece / kTile;  ///< columns of a piece of a picture
constexpr std::size_t kWidest = 32768;

/// Squared distance of two rays, as points in six dimensions.
float difference(const float* rows, std::size_t a, std::size_t b) {
  float sum = 0;
  for (int k = 0; k < 6; ++k) {
    const float d = rows[6 * a + k] - rows[6 * b + k];
    sum += d * d;
  }
  return sum;
}

/// The number of the first ray that is farther from the one before than eight usual steps, or 0.
std::size_t first_jump(const float* rows, std::size_t end) {
  float sum = 0;
  for (std::size_t i = 1; i < end; ++i) {
    const float step = difference(rows, i - 1, i);
    if (i >= kTile && step * static_cast<float>(i - 1) > 64 * sum) return i;
    sum += step;
  }
  return 0;
}

}  // namespace

std::size_t picture_width(const float* rows, std::size_t size) {
  // A picture of less than two rows of tiles gains nothing.
  if (size < 2 * kTile * kTile) return 0;
  const std::size_t width = first_jump(rows, std::min(size / (2 * kTile), kWidest) + 1);
  if (width == 0) return 0;
  constexpr std::size_t kSamples = 32;
  std::size_t alike = 0;
  for (std::size_t n = 0; n < kSamples; ++n) {
    // Not at the end of a row, and not in the last row.
    const std::size_t row = n * (size / width - 1) / kSamples, column = (n * 7919) % (width - 1);
    const std::size_t i = row * width + column, far = row * width + (column + width / 2) % width;
    const float step = difference(rows, i, i + 1);
    if (difference(rows, i, i + width) <= 16 * step && 8 * step <= difference(rows, i, far)) ++alike;
  }
  return alike >= kSamples - kSamples / 8 ? width : 0;
}

RayOrder::RayOrder(std::size_t size, std::size_t width) : size_(size), width_(width) {
  if (width == 0) {
    pieces_ = pieces_of(size);
    return;
  }
  across_ = (width + kStrip - 1) / kStrip;
  const std::size_t height = (size + width - 1) / width;
  pieces_ = across_ * ((height + kTile - 1) / kTile);
}

void RayOrder::piece(std::size_t k, std::vector<std::size_t>& places) const {
  places.clear();
  if (width_ == 0) {
    const std::size_t begin = k * kPiece, end = std::min(size_, begin + kPiece);
    for (std::size_t i = begin; i < end; ++i) places.push_back(i);
    return;
  }
  const std::size_t top = k / across_ * kTile, left = k % across_ * kStrip;
  const std::size_t right = std::min(width_, left + kStrip);
  for (std::size_t x = left; x < right; x += kTile)
    for (std::size_t y = top; y < top + kTile; ++y)
      for (std::size_t i = y * width_ + x; i < y * width_ + std::min(right, x + kTile) && i < size_; ++i)
        places.push_back(i);
}

}  // namespace oktett::python
