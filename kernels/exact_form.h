#pragma once
/// \file What describes an exact surface: one that is found by solving an equation along the ray. Each in its
/// own space; any affine transform may follow.

#include <variant>

#include "kernels/exact/blob_data.h"
#include "kernels/exact/blobtree_data.h"
#include "kernels/exact/cone_data.h"
#include "kernels/exact/cylinder_data.h"
#include "kernels/exact/implicit_data.h"
#include "kernels/exact/lathe_data.h"
#include "kernels/exact/metaballs_data.h"
#include "kernels/exact/normal_method.h"
#include "kernels/exact/polyhedron_data.h"
#include "kernels/exact/polynomial_data.h"
#include "kernels/exact/quadric_data.h"
#include "kernels/exact/revolution_data.h"
#include "kernels/exact/superquadric_data.h"
#include "kernels/exact/torus_data.h"
#include "kernels/fractals/ifs_data.h"
#include "kernels/fractals/julia_data.h"
#include "kernels/fractals/menger_data.h"
#include "kernels/fractals/sphereflake_data.h"
#include "kernels/fractals/terrain_data.h"
#include "kernels/heights/height_field_data.h"

namespace oktett {

/// What describes one exact surface; in the order of ExactShapes (exact_shapes.h).
using ExactForm = std::variant<TorusShape, CylinderShape, ConeShape, PolyhedronShape, QuadricShape,
                               PolynomialShape, BlobShape, RevolutionShape, LatheShape, SuperquadricShape,
                               MetaballsShape, BlobTreeShape, ImplicitShape, SphereflakeShape, MengerShape,
                               IfsShape, JuliaShape, TerrainShape, HeightFieldShape>;

struct ExactShape {
  ExactForm form;
  NormalMethod normals = NormalMethod::gradient;
};

}  // namespace oktett
