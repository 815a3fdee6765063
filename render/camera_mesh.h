#pragma once
/// \file Cameras whose rays start at the faces of meshes: pictures of what surfaces see, such as the light
/// that falls on them.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/description.h"
#include "core/mesh.h"
#include "core/ray.h"
#include "core/transform.h"

namespace oktett {

/// Which face a place of the picture has. Faces count from the upper left pixel in rows to the right, in the
/// order of their meshes.
enum class FaceOrder : std::uint8_t {
  average,   ///< each mesh has a face for each pixel; its samples take the meshes from left to right
  sequence,  ///< the faces of a mesh follow those of the one before
  columns,   ///< the meshes stand side by side, each with its part of the width, rounded down
  uv,  ///< the first face whose texture coordinates hold the place: u to the right, v up, both from 0 to 1
};

/// A mesh where a camera has it.
struct SeeingMesh {
  std::shared_ptr<const TriangleMesh> mesh;
  Affine transform;  ///< of its places from TriangleMesh::origin on; invertible
};

/// Meshes whose faces see. A ray starts in the middle of its face, or, by texture coordinates, at the place
/// that has those of the film point, and leaves along the normal on the front.
class CameraMesh {
 public:
  /// What holds for all faces.
  struct Settings {
    FaceOrder order = FaceOrder::average;
    bool smooth = false;      ///< by texture coordinates: along interpolated normals, where a face has some
    bool reverse = false;     ///< the other way
    double offset = 0;        ///< start so far away along the normal, which `reverse` does not turn
    double max_distance = 0;  ///< see no further; 0: without end

    void describe(auto& p) {
      p.choice("order", order,
               {{"average", FaceOrder::average},
                {"sequence", FaceOrder::sequence},
                {"columns", FaceOrder::columns},
                {"uv", FaceOrder::uv}},
               "which face a pixel has");
      p.field("smooth", smooth, "with `order: uv`: rays along interpolated normals");
      p.field("reverse", reverse, "rays leave on the back");
      p.field("offset", offset, "how far along the normal rays start");
      p.field("max_distance", max_distance, kNonNegative, "how far rays see; 0: without end");
    }
  };

  /// A film point of a film of some size.
  struct FilmPlace {
    double x, y;
    std::uint32_t width, height;
  };

  CameraMesh(std::vector<SeeingMesh> meshes, const Settings& settings);

  /// The ray of a film point, of unit direction, its start moved by `origin`; tmax is 0 where there is no
  /// face, or one without a normal.
  Ray ray(const FilmPlace& place, const Vec3d& origin) const;

  /// The middle of the box around all corners.
  const Vec3d& middle() const { return middle_; }
  std::size_t faces() const { return first_.back(); }

 private:
  /// The weights of the second and third corner of a face.
  struct FacePoint {
    std::size_t face;
    double u = 1.0 / 3, v = 1.0 / 3;
  };

  FacePoint point_at(const FilmPlace& place) const;
  FacePoint point_of_uv(double u, double v) const;
  void fill_grid();

  std::vector<SeeingMesh> meshes_;
  std::vector<Affine> inverses_;    ///< of the transforms
  std::vector<std::size_t> first_;  ///< the number of the first face of each mesh, and that of all faces
  Settings settings_;
  Vec3d middle_{0, 0, 0};
  /// The unit square of texture coordinates in cells, row by row: the faces of cell i are those from
  /// cell_begin_[i] on, in ascending order.
  std::size_t side_ = 0;
  std::vector<std::uint32_t> cell_begin_, cell_faces_;
};

}  // namespace oktett
