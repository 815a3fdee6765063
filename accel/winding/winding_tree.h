#pragma once
/// \file A tree over oriented surfaces for winding numbers (Jacobson et al. 2013; Barill et al. 2018). A node
/// holds for each of its children what the child looks like from afar: the first three terms of its expansion
/// about a centre, and what bounds the rest. docs/numerics.md derives the bound. Data only; winding_tree.cpp
/// makes it, winding_walk.h sums it up.
///
/// Departs from Barill et al. 2018: what the expansion leaves out is bounded, the tree has eight children per
/// node in columns, and the terms are those of harmonic functions: 3 + 5 + 7 numbers instead of 3 + 9 + 27.

#include <cstdint>
#include <span>
#include <vector>

#include "core/transform.h"
#include "core/vec3.h"

namespace oktett {

/// Eight children in columns. Lengths are in the tree's own unit, see WindingTree::scale. Numbers of surfaces
/// are divided by 4 pi, so that sums are in turns. A child that is missing lies far away and has no area.
struct alignas(64) WindingNode {
  static constexpr int kWidth = 8;

  float center[3][kWidth];
  float reach[kWidth];          ///< no point of the child is farther from its centre
  float area[kWidth];           ///< of the child's surfaces, over 4 pi; rounded up, as the next one
  float spread[kWidth];         ///< at least the integral of the cubed distance from the centre, over 4 pi
  float dipole[3][kWidth];      ///< integral of the normal n
  float quadrupole[5][kWidth];  ///< that of n y, y from the centre: xx, yy, xy, xz, yz of its traceless part
  float octupole[7][kWidth];    ///< that of n y y, traceless: xxx, xyy, xxy, yyy, xxz, yyz, xyz
  /// A node, or a leaf: kLeaf plus the number of a group of triangles or of a part.
  std::uint32_t child[kWidth];

  static constexpr std::uint32_t kLeaf = 0x80000000u;
};

/// Up to eight triangles: [corner][axis][triangle]. Behind the last stand triangles without size.
struct alignas(64) WindingGroup {
  static constexpr int kSize = 8;

  float corner[3][3][kSize];
};

/// What a cluster of surfaces looks like from afar, about `center`; integrals over the surface with normal n,
/// y from the centre.
struct WindingMoments {
  Vec3d center;
  double reach = 0, area = 0;
  Vec3d first;                 ///< of y
  double second = 0;           ///< of |y|^2
  Vec3d dipole;                ///< of n
  double quadrupole[3][3]{};   ///< of n_i y_j
  double octupole[3][3][3]{};  ///< of n_i y_j y_k

  /// The same surfaces about another centre.
  WindingMoments about(const Vec3d& other) const;
  /// Adds surfaces about the same centre.
  void add(const WindingMoments& other);
  /// The image under a map. Mirrors keep the side that is outside. `scale`: its Affine::uniform_scale().
  WindingMoments moved(const Affine& m, double scale) const;
};

/// A tree over triangles or over parts. Node 0 is the root; there is none if the tree is empty.
struct WindingTree {
  double scale = 1;  ///< a power of two: the tree's coordinates over those of its structure
  std::vector<WindingNode> nodes;
  std::vector<WindingGroup> groups;  ///< empty in a tree over parts
  WindingMoments whole;              ///< of everything, in the space of the structure

  bool empty() const { return nodes.empty(); }
};

/// The corners of a triangle; counter-clockwise seen from outside.
struct WindingTriangle {
  Vec3f corner[3];
};

/// A tree over triangles, which are finite.
WindingTree make_winding_tree(std::span<const WindingTriangle> triangles);
/// A tree over parts, one in each leaf.
WindingTree make_winding_tree(std::span<const WindingMoments> parts);

}  // namespace oktett
