#pragma once
/// \file How the rays and points of an array are divided into tasks, and in which order rays are traced.

#include <cstddef>
#include <vector>

namespace oktett::python {

/// Rays or points of one task: their columns stay in the cache of a core.
inline constexpr std::size_t kPiece = 4096;

inline std::size_t pieces_of(std::size_t size) { return (size + kPiece - 1) / kPiece; }

/// How many rays a row of the picture has whose pixels `size` rays seem to be, row after row; 0 if they do
/// not look like a picture. `rows` holds six floats a ray. A guess from samples: at the end of a row, rays
/// jump; a ray is as close to the one a row later as to its neighbour, or nearly, and far from the one half a
/// row away.
std::size_t picture_width(const float* rows, std::size_t size);

/// Divides rays into pieces of at most kPiece. Those of a picture are divided into tiles of 8x8 pixels: rays
/// that are traced together then meet the same few nodes, which halves the time of camera rays.
class RayOrder {
 public:
  /// `width` 0: in the order of the array.
  RayOrder(std::size_t size, std::size_t width);

  std::size_t piece_count() const { return pieces_; }
  /// Replaces `places` by the numbers of the rays of piece `k`, in the order in which to trace them.
  void piece(std::size_t k, std::vector<std::size_t>& places) const;

 private:
  std::size_t size_, width_, pieces_;
  std::size_t across_ = 1;  ///< pieces beside each other in 8 rows of a picture
};

}  // namespace oktett::python
