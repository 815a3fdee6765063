#pragma once
#include "kernels/shapes/cell_tree.h"
namespace oktett {
struct BlobTreeElement { double iso; };
struct BlobTree {
  using Data = BlobTreeShape;
  using Pool = ExactPool<BlobTreeElement>;
  static constexpr int kMaxCrossings = 8;
  static void add(Pool&, const ExactShape&, const Affine&, std::uint32_t) {}
  template <int K, class D>
  static void crossings(const Pool&, const ExactCell&, const Line<D>&, const LineRange<D>&, const typename D::M&, Crossings<K, D>& out) { out.clear(); }
  static double value(const Pool&, std::size_t, int, const Vec3d&) { return 1; }
  static Vec3d gradient(const Pool&, std::size_t, int, const Vec3d&) { return {}; }
  static bool inside(const Pool&, std::size_t, const Vec3d&) { return false; }
  static void uv(const Pool&, std::size_t, int, const Vec3d&, Surface&) {}
};
}
