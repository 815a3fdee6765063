#include "io/pov/translate/mesh_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "io/pov/translate/meshes.h"

namespace oktett::pov {
namespace {

/// As many samples as pixels have if nothing is said.
constexpr std::uint32_t kUsualSamples = 4;
/// Most meshes of a camera, and distributions of POV-Ray by number with their names in scene files.
constexpr double kMostMeshes = 1024;
constexpr const char* kOrders[] = {"average", "sequence", "columns", "uv"};

class MeshCamera {
 public:
  MeshCamera(Context& context, const Block& block) : context_(context), tree_(context.tree), block_(block) {}

  Node make(double location_z, double direction_z) {
    Arguments a(context_, block_);
    read_numbers(a);
    const Node meshes = tree_.list(block_.where);
    std::uint32_t count = 0;
    bool smooth = false;
    while (!a.at_end()) {
      const Place where = a.where();
      if (const Block* const mesh = a.peek_block()) {
        a.take();
        // Further meshes than the first ones show nothing.
        if (count < shown_) add(*mesh, {}, meshes);
        ++count;
      } else if (a.take_word("smooth")) {
        if (!by_uv()) context_.fail(where, "'smooth' is for a mesh_camera of distribution 3");
        smooth = true;
      } else {
        context_.fail(where, "expected a mesh or 'smooth' in a mesh_camera");
      }
    }
    if (count == 0) context_.fail(block_.where, "a mesh_camera needs a mesh");
    if (distribution_ == 0 && count < rays_)
      context_.fail(block_.where, fmt::format("a mesh_camera of distribution 0 has a mesh for each ray of a "
                                              "pixel; expected {}, found {}",
                                              rays_, count));
    if (distribution_ == 0 && rays_ > kUsualSamples) context_.samples = std::bit_ceil(rays_);
    const Node mesh = tree_.map(block_.where);
    tree_.put(mesh, "meshes", meshes);
    tree_.put(mesh, "order", tree_.word(block_.where, kOrders[distribution_]));
    if (smooth) tree_.put(mesh, "smooth", tree_.flag(block_.where, true));
    // Without normals of their own POV-Ray's faces look to where their corners run clockwise.
    const bool behind = direction_z < 0;
    if (behind == smooth) tree_.put(mesh, "reverse", tree_.flag(block_.where, true));
    if (location_z != 0)
      tree_.put(mesh, "offset", tree_.number(block_.where, smooth ? location_z : -location_z));
    if (max_distance_ > 0) tree_.put(mesh, "max_distance", tree_.number(block_.where, max_distance_));
    const Node node = tree_.map(block_.where);
    tree_.put(node, "projection", tree_.word(block_.where, "mesh"));
    tree_.put(node, "mesh", mesh);
    return node;
  }

 private:
  bool by_uv() const { return distribution_ == 3; }

  void read_numbers(Arguments& a) {
    const Place where = a.where();
    const double rays = a.number("how many rays a pixel has"), kind = a.number("a distribution");
    if (!(rays >= 1 && rays <= kMostMeshes))
      context_.fail(
          where, fmt::format("a mesh_camera with {} rays per pixel cannot be meant; expected 1 to {}", rays,
                             kMostMeshes));
    if (!(kind >= 0 && kind < 4))
      context_.fail(where,
                    fmt::format("expected a distribution from 0 to 3 in a mesh_camera, found {}", kind));
    rays_ = static_cast<std::uint32_t>(rays), distribution_ = static_cast<std::uint32_t>(kind);
    if (distribution_ > 1 && rays_ != 1)
      context_.fail(where, fmt::format("a mesh_camera of distribution {} has 1 ray per pixel, found {}",
                                       distribution_, rays_));
    if (a.is_numbers()) max_distance_ = std::max(0.0, a.number("the greatest distance"));
    if (distribution_ == 0) shown_ = rays_;
    if (by_uv()) shown_ = 1;
  }

  /// Adds what `block` is, moved by `outer`.
  void add(const Block& block, const Moves& outer, Node meshes) {
    Arguments a(context_, block);
    const Block* const inner = a.peek_block();
    const bool declared = inner != nullptr && (inner->keyword == "mesh" || inner->keyword == "mesh2");
    if (declared)
      a.take();
    else if (!name_of(block, a))
      context_.fail(block.where, fmt::format("expected a mesh in a mesh_camera, found '{}'", block.keyword));
    Moves moves;
    while (!a.at_end())
      if (!take_moves(context_, a, moves)) a.take();
    moves.add(outer);
    if (declared) return add(*inner, moves, meshes);
    const Node item = tree_.map(block.where, "file", tree_.text(block.where, names_.at(&block)));
    if (const Node transform = moves_node(tree_, block.where, moves)) tree_.put(item, "transform", transform);
    Tree::push(meshes, item);
  }

  /// Gives the mesh of `block` a name, once however often it is used, and takes its arguments.
  bool name_of(const Block& block, Arguments& a) {
    if (block.keyword != "mesh" && block.keyword != "mesh2") return false;
    if (names_.contains(&block)) return true;
    const std::optional<MadeMesh> made = make_mesh(context_, a, MeshUse::camera);
    if (!made || made->parts.empty() || made->parts[0].mesh.empty()) return false;
    names_[&block] =
        add_mesh(context_, made->parts[0].mesh.finish(), block.name.empty() ? "camera" : block.name);
    return true;
  }

  Context& context_;
  Tree& tree_;
  const Block& block_;
  std::uint32_t rays_ = 1, distribution_ = 0;
  std::uint32_t shown_ = static_cast<std::uint32_t>(kMostMeshes);
  double max_distance_ = 0;
  std::map<const Block*, std::string> names_;
};

}  // namespace

Node mesh_camera_node(Context& context, const Block& block, double location_z, double direction_z) {
  return MeshCamera(context, block).make(location_z, direction_z);
}

}  // namespace oktett::pov
