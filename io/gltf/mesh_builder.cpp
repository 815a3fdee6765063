#include "io/gltf/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "io/gltf/carried.h"
#include "io/gltf/gltf_file.h"
#include "io/gltf/packed.h"
#include "io/mesh/reading.h"

namespace oktett {
namespace {

constexpr std::uint64_t kMostElements = 0xfffffffeu;
/// An accessor with so many elements for each corner of a mesh is not read as a whole.
constexpr std::uint64_t kRareUse = 4;

/// The columns that a mesh reads.
enum Role : std::size_t { kPositions, kNormals, kUvs, kTangents, kSecondUvs, kRoles };
/// Those that the corners of triangles have indices into, and those beside them that have an element for each
/// of theirs.
constexpr Role kLeaders[] = {kPositions, kNormals, kUvs};
constexpr Role kFollower[] = {kRoles, kTangents, kSecondUvs};

/// A primitive that is shown.
struct Part {
  const GltfPrimitive* primitive = nullptr;
  std::string name;
  bool has[kRoles] = {};
  std::uint32_t accessor[kRoles] = {kNoId, kNoId, kNoId, kNoId, kNoId};  ///< kNoId: of this part alone
  GltfElements elements[kRoles];
  std::uint64_t base[kRoles] = {};  ///< of its elements in the columns of the mesh
  bool is_indexed = false;
  GltfElements indices;
  std::uint64_t corners = 0, first_triangle = 0, triangles = 0;
  std::uint16_t slot = 0;
  const DracoMesh* draco = nullptr;
  bool picks = false;  ///< reads only the elements that its corners name
  GltfCarrier carrier{};
};

/// Elements without gaps in memory.
GltfElements elements_of(const std::string& name, const void* data, std::uint64_t count,
                         std::uint32_t components, GltfNumber number = GltfNumber::float32) {
  GltfElements e;
  e.name = name, e.data = static_cast<const char*>(data), e.count = count;
  e.components = components, e.number = number, e.stride = bytes_of(number) * components;
  return e;
}

/// The building of one mesh.
class Build {
 public:
  Build(GltfAccessors& accessors, std::uint32_t number, const GltfChoice& choice, const GltfBending* bending,
        std::vector<std::string>& warnings)
      : accessors_(accessors),
        file_(accessors.file()),
        number_(number),
        choice_(choice),
        strokes_(choice.strokes),
        bending_(bending),
        warnings_(warnings) {}

  /// Finds out how large the mesh will be and returns its bytes.
  std::uint64_t measure() {
    find_parts();
    choose_slots();
    find_rare_uses();
    std::uint64_t bytes = 0, triangles = 0;
    for (Part& part : parts_) {
      part.first_triangle = triangles;
      triangles += part.triangles;
    }
    bytes += 12 * triangles * (1u + (any(kNormals) ? 1u : 0u) + (any(kUvs) ? 1u : 0u));
    for (const Part& part : parts_)
      for (std::size_t role = 0; role < kRoles; ++role)
        if (part.has[role]) bytes += 16 * (part.picks ? part.corners : part.elements[role].count);
    check_limit(file_.path(), triangles, "triangles", kMostElements);
    triangles_ = triangles;
    plan_attributes();
    return bytes + join_->bytes();
  }

  GltfBuiltMesh run() {
    out_.mesh.indices.resize_uninitialized(3 * triangles_);
    for (Part& part : parts_) read_corners(part);
    for (const Role role : kLeaders) place(role);
    read_columns();
    if (bending_ != nullptr)
      for (const Part& part : parts_) bend(part);
    fill_indices();
    for (Part& part : parts_) part.carrier.base = part.base[kPositions];
    join_->fill(file_, out_.mesh);
    fill_slots();
    return std::move(out_);
  }

 private:
  bool any(std::size_t role) const {
    return std::ranges::any_of(parts_, [role](const Part& part) { return part.has[role]; });
  }

  void find_parts() {
    const GltfMesh& mesh = file_.model().meshes[number_];
    std::size_t unplaced = 0;
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
      const GltfPrimitive& primitive = mesh.primitives[i];
      const std::string name =
          "meshes[" + std::to_string(number_) + "].primitives[" + std::to_string(i) + "]";
      if (primitive.has_strokes() != strokes_ || (strokes_ && primitive.material != choice_.material))
        continue;
      if (primitive.mode > GltfPrimitive::kFan) continue;  // has been told
      if (primitive.attributes.positions == kNoId) {
        ++unplaced;
        continue;
      }
      Part& part = parts_.emplace_back();
      part.primitive = &primitive, part.name = name;
      if (primitive.draco_view != kNoId && (can_unpack_draco() || !has_plain_data(primitive)))
        find_draco(part);
      else
        find_plain(part);
      note_missing_uvs(part);
      count_corners(part);
    }
    const std::string where = "meshes[" + std::to_string(number_) + "]: ";
    if (unplaced > 0) warnings_.push_back(where + "primitives without an attribute POSITION are skipped");
  }

  /// The sets of texture coordinates that the primitive's material shows; nothing for one that it has not.
  UvSets uv_sets(const GltfPrimitive& primitive) const {
    UvSets sets;
    if (primitive.material != kNoId) sets = gltf_uv_sets(file_.model().materials[primitive.material]);
    if (sets.first == kNoId) sets.first = 0;
    return sets;
  }

  bool has_plain_data(const GltfPrimitive& primitive) const {
    return file_.model().accessors[primitive.attributes.positions].view != kNoId;
  }

  /// The accessors or Draco's numbers of what the part reads, by role.
  std::array<std::uint32_t, kRoles> roles_of(const GltfPrimitive& primitive, const GltfAttributes& a) const {
    // Balls and capsules have normals and texture coordinates of their own.
    if (strokes_) return {a.positions, kNoId, kNoId, kNoId, kNoId};
    const auto [first, second] = uv_sets(primitive);
    std::array<std::uint32_t, kRoles> roles{a.positions, a.normals, a.uv_set(first), kNoId, kNoId};
    const bool bends_normals =
        primitive.material != kNoId && has_tangents(file_.model().materials[primitive.material]);
    if (bends_normals && a.normals != kNoId) roles[kTangents] = a.tangents;
    if (second != kNoId && roles[kUvs] != kNoId) roles[kSecondUvs] = a.uv_set(second);
    return roles;
  }

  void note_missing_uvs(const Part& part) {
    const std::uint32_t material = part.primitive->material;
    if (material == kNoId) return;
    const auto [first, second] = gltf_uv_sets(file_.model().materials[material]);
    if (strokes_) {
      if (first != kNoId)
        warnings_.push_back(part.name + ": textures lie around its points and lines, not by TEXCOORD");
      return;
    }
    for (const std::uint32_t set : {first, second})
      if (set != kNoId && part.primitive->attributes.uv_set(set) == kNoId)
        warnings_.push_back(part.name + ": has no TEXCOORD_" + std::to_string(set) +
                            ", by which its material shows textures");
  }

  void find_plain(Part& part) {
    const std::array<std::uint32_t, kRoles> roles = roles_of(*part.primitive, part.primitive->attributes);
    for (std::size_t role = 0; role < kRoles; ++role) {
      if (roles[role] == kNoId) continue;
      part.has[role] = true, part.accessor[role] = roles[role];
      part.elements[role] = accessors_.elements(roles[role]);
    }
    for (const GltfCarried& carried : part.primitive->attributes.carried) {
      const GltfAccessor& accessor = file_.model().accessors[carried.number];
      if (accessor.is_matrix || !accessor.problem.empty())
        warn_of(part, carried.name, "expected up to four numbers for each vertex");
      else
        carry(part, {carried.name, carried.is_color, carried.number, accessors_.elements(carried.number)});
    }
    if (part.primitive->indices == kNoId) return;
    part.is_indexed = true;
    part.indices = accessors_.elements(part.primitive->indices);
  }

  void find_draco(Part& part) {
    const GltfView& view = file_.model().views[part.primitive->draco_view];
    const std::string_view bytes = file_.bytes(view.range, part.name);
    const std::array<std::uint32_t, kRoles> roles =
        roles_of(*part.primitive, part.primitive->draco_attributes);
    const GltfAttributes& attributes = part.primitive->draco_attributes;
    const std::vector<GltfCarried>& packed = attributes.carried;
    const std::array<std::uint32_t, kRoles> accessors = roles_of(*part.primitive, part.primitive->attributes);
    std::array<bool, kRoles> normalized{};
    for (std::size_t role = 0; role < kRoles; ++role)
      normalized[role] = accessors[role] != kNoId && file_.model().accessors[accessors[role]].normalized;
    DracoMesh& mesh =
        draco_.emplace_back(unpack_draco(file_, bytes, roles, normalized, attributes, part.name));
    for (std::size_t role = 0; role < kRoles; ++role) {
      const std::vector<float>& numbers = mesh.numbers[role];
      if (role != kPositions && numbers.empty()) continue;
      part.has[role] = true;
      part.elements[role] = elements_of(part.name, numbers.data(), mesh.vertices,
                                        static_cast<std::uint32_t>(kDracoSizes[role]));
    }
    part.draco = &mesh, part.is_indexed = true;
    part.indices = elements_of(part.name, mesh.indices.data(), mesh.indices.size(), 1, GltfNumber::uint32);
    for (std::size_t i = 0; i < packed.size(); ++i) carry_packed(part, packed[i], mesh.carried[i]);
    for (const GltfCarried& beside : part.primitive->attributes.carried)
      if (std::ranges::find(packed, beside.name, &GltfCarried::name) == packed.end())
        warn_of(part, beside.name, "it stands beside Draco's data");
  }

  /// Whether whole numbers are parts of the greatest one, says the accessor.
  void carry_packed(Part& part, const GltfCarried& packed, const DracoMesh::Carried& numbers) {
    GltfCarriedValues values{packed.name, packed.is_color};
    values.elements = elements_of(part.name, numbers.bytes.data(), part.draco->vertices, numbers.components,
                                  numbers.number);
    values.elements.normalized = numbers.normalized;
    const std::vector<GltfCarried>& named = part.primitive->attributes.carried;
    const auto found = std::ranges::find(named, packed.name, &GltfCarried::name);
    if (found != named.end()) values.elements.normalized = file_.model().accessors[found->number].normalized;
    carry(part, std::move(values));
  }

  void carry(Part& part, GltfCarriedValues values) {
    const std::string why = why_not_carried(values, part.elements[kPositions].count);
    if (why.empty())
      part.carrier.values.push_back(std::move(values));
    else
      warn_of(part, values.name, why);
  }

  void warn_of(const Part& part, const std::string& name, const std::string& why) {
    warnings_.push_back(part.name + ": the attribute " + quote_name(name) + " is not read: " + why);
  }

  void count_corners(Part& part) {
    const std::uint64_t vertices = part.elements[kPositions].count;
    check_limit(file_.path(), vertices, "vertices", kMostElements);
    for (std::size_t role = kNormals; role < kRoles; ++role)
      if (part.has[role] && part.elements[role].count != vertices)
        file_.fail(part.elements[role].name + ": " + std::to_string(part.elements[role].count) +
                   " elements for " + std::to_string(vertices) + " vertices of " + part.name);
    part.corners = part.is_indexed ? part.indices.count : vertices;
    if (strokes_) {
      part.triangles = stroke_count(part);
    } else if (part.primitive->mode == GltfPrimitive::kTriangles || part.draco != nullptr) {
      if (part.corners % 3 != 0)
        warnings_.push_back(part.name + ": expected three corners for each triangle, found " +
                            std::to_string(part.corners) + " in all; the last ones are left out");
      part.triangles = part.corners / 3;
    } else {
      part.triangles = part.corners < 3 ? 0 : part.corners - 2;
    }
  }

  /// How many points and lines the part's corners make.
  std::uint64_t stroke_count(const Part& part) {
    const std::uint64_t corners = part.corners;
    switch (part.primitive->mode) {
      case GltfPrimitive::kPoints:
        return corners;
      case GltfPrimitive::kLines:
        if (corners % 2 != 0)
          warnings_.push_back(part.name + ": expected two ends for each line, found " +
                              std::to_string(corners) + " in all; the last one is left out");
        return corners / 2;
      case GltfPrimitive::kLineLoop:
        return corners < 2 ? 0 : corners;
      default:
        return corners < 2 ? 0 : corners - 1;
    }
  }

  void choose_slots() {
    std::map<std::uint32_t, std::uint16_t> slots;
    for (Part& part : parts_) {
      const auto [found, is_new] =
          slots.try_emplace(part.primitive->material, static_cast<std::uint16_t>(slots.size()));
      if (is_new) out_.slots.push_back(part.primitive->material);
      if (slots.size() > 65535) file_.fail(part.name + ": more than 65535 materials in a mesh");
      part.slot = found->second;
    }
  }

  /// Many meshes may share the elements of an accessor, each for itself only a few of them.
  void find_rare_uses() {
    if (bending_ != nullptr) {
      // What bends a part belongs to its own elements.
      for (Part& part : parts_) own_elements(part);
      return;
    }
    std::map<std::uint32_t, std::uint64_t> corners;
    for (const Part& part : parts_) corners[part.accessor[kPositions]] += part.corners;
    for (Part& part : parts_) {
      part.picks = part.is_indexed && part.draco == nullptr &&
                   part.elements[kPositions].count > 1024 + kRareUse * corners[part.accessor[kPositions]];
      for (std::size_t role = 0; role < kRoles; ++role)
        if (part.has[role])
          part.picks =
              part.picks && part.elements[role].data != nullptr && part.elements[role].sparse_count == 0;
      for (const GltfCarriedValues& values : part.carrier.values)
        part.picks = part.picks && values.elements.data != nullptr && values.elements.sparse_count == 0;
      if (part.picks) own_elements(part);
    }
  }

  static void own_elements(Part& part) {
    std::ranges::fill(part.accessor, kNoId);
    for (GltfCarriedValues& values : part.carrier.values) values.accessor = kNoId;
  }

  void plan_attributes() {
    std::vector<const GltfCarrier*> carriers;
    for (Part& part : parts_) {
      GltfCarrier& carrier = part.carrier;
      carrier.positions = part.accessor[kPositions];
      carrier.vertices = part.picks ? part.corners : part.elements[kPositions].count;
      carrier.first_corner = 3 * part.first_triangle, carrier.corners = 3 * part.triangles;
      carriers.push_back(&carrier);
    }
    join_.emplace(std::move(carriers));
  }

  /// Writes the corners of all triangles, as numbers of the part's own elements.
  void read_corners(Part& part) {
    std::uint32_t* const out = out_.mesh.indices.data() + 3 * part.first_triangle;
    const std::uint64_t vertices = part.elements[kPositions].count;
    const bool is_list =
        !strokes_ && (part.primitive->mode == GltfPrimitive::kTriangles || part.draco != nullptr);
    // There is only room for the corners of whole triangles.
    const bool in_place = is_list && part.corners == 3 * part.triangles;
    Column<std::uint32_t> row;
    if (part.is_indexed) {
      if (!in_place) row.resize_uninitialized(part.corners);
      read_gltf_indices(file_, part.indices, vertices, in_place ? out : row.data());
      note_restart(part, {in_place ? out : row.data(), part.corners});
    }
    const auto corner = [&](std::uint64_t i) {
      return part.is_indexed ? row[i] : static_cast<std::uint32_t>(i);
    };
    if (strokes_) {
      const int mode = part.primitive->mode;
      for (std::uint64_t i = 0; i < part.triangles; ++i) {
        const std::uint64_t from = mode == GltfPrimitive::kLines ? 2 * i : i;
        out[3 * i] = corner(from);
        out[3 * i + 1] = out[3 * i + 2] =
            mode == GltfPrimitive::kPoints ? corner(from) : corner((from + 1) % part.corners);
      }
    } else if (is_list) {
      if (!part.is_indexed || !in_place)
        for (std::uint64_t i = 0; i < 3 * part.triangles; ++i) out[i] = corner(i);
    } else {
      // glTF 2.0, 3.7.2.1.
      for (std::uint64_t i = 0; i < part.triangles; ++i) {
        const bool fan = part.primitive->mode == GltfPrimitive::kFan;
        const std::uint64_t turn = i % 2;
        out[3 * i] = corner(fan ? i + 1 : i);
        out[3 * i + 1] = corner(fan ? i + 2 : i + 1 + turn);
        out[3 * i + 2] = corner(fan ? 0 : i + 2 - turn);
      }
    }
    if (part.picks) pick_used(part, out);
  }

  /// The greatest number of a type stands for the end of a strip elsewhere, and must not be used (glTF 2.0,
  /// 3.7.2.1).
  void note_restart(const Part& part, std::span<const std::uint32_t> corners) {
    const std::uint32_t greatest = part.indices.number == GltfNumber::uint8 ? 0xff : 0xffff;
    if (part.indices.number == GltfNumber::uint32 || part.elements[kPositions].count <= greatest) return;
    if (std::ranges::find(corners, greatest) != corners.end())
      warnings_.push_back(part.name + ": the index " + std::to_string(greatest) +
                          " of its type, which must not be used, is read as that of a vertex");
  }

  /// Leaves only the elements that the part's corners name.
  void pick_used(Part& part, std::uint32_t* corners) {
    const std::size_t count = 3 * part.triangles;
    std::vector<std::uint32_t> used(corners, corners + count);
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::size_t i = 0; i < count; ++i)
      corners[i] = static_cast<std::uint32_t>(std::ranges::lower_bound(used, corners[i]) - used.begin());
    for (std::size_t role = 0; role < kRoles; ++role)
      if (part.has[role]) pick(part.elements[role], used);
    for (GltfCarriedValues& values : part.carrier.values) pick(values.elements, used);
  }

  void pick(GltfElements& e, const std::vector<std::uint32_t>& used) {
    const std::size_t size = std::size_t{bytes_of(e.number)} * e.components;
    std::string& picked = picked_.emplace_back();
    picked.resize(used.size() * size);
    for (std::size_t i = 0; i < used.size(); ++i)
      std::memcpy(picked.data() + i * size, e.data + std::uint64_t{e.stride} * used[i], size);
    e.data = picked.data(), e.count = used.size(), e.stride = static_cast<std::uint32_t>(size);
  }

  /// Gives the elements of a leader, with those of its follower, their place in the columns.
  void place(Role role) {
    const Role follower = kFollower[role];
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> places;
    std::uint64_t next = 0;
    for (Part& part : parts_) {
      if (!part.has[role]) continue;
      const std::pair key{part.accessor[role], follower == kRoles ? kNoId : part.accessor[follower]};
      const bool known = key.first != kNoId && !places.try_emplace(key, next).second;
      part.base[role] = known ? places[key] : next;
      if (known) {
        // They have been read.
        part.elements[role].count = 0;
        if (follower != kRoles) part.elements[follower].count = 0;
      } else {
        next += part.elements[role].count;
      }
      if (follower != kRoles) part.base[follower] = part.base[role];
    }
    check_limit(file_.path(), next, "vertices", kMostElements);
    sizes_[role] = next;
    if (follower != kRoles && any(follower)) sizes_[follower] = next;
  }

  static GltfCheck check_of(std::size_t role) {
    return role == kPositions ? GltfCheck::coordinate : GltfCheck::finite;
  }

  void read_columns() {
    TriangleMesh& mesh = out_.mesh;
    mesh.positions.resize_uninitialized(sizes_[kPositions]);
    mesh.normals.resize_uninitialized(sizes_[kNormals]);
    mesh.uvs.resize_uninitialized(sizes_[kUvs]);
    mesh.tangents.resize_uninitialized(sizes_[kTangents]);
    mesh.second_uvs.resize_uninitialized(sizes_[kSecondUvs]);
    // Of parts that have none.
    std::fill(mesh.tangents.begin(), mesh.tangents.end(), std::array<float, 4>{});
    std::fill(mesh.second_uvs.begin(), mesh.second_uvs.end(), Vec2f{0, 0});
    for (const Part& part : parts_) {
      for (const Role role : {kPositions, kNormals}) {
        Column<Vec3f>& column = role == kPositions ? mesh.positions : mesh.normals;
        if (part.elements[role].count > 0)
          read_gltf_vectors(file_, part.elements[role], check_of(role), column.data() + part.base[role]);
      }
      for (const Role role : {kUvs, kSecondUvs}) {
        Column<Vec2f>& column = role == kUvs ? mesh.uvs : mesh.second_uvs;
        if (part.elements[role].count > 0)
          read_gltf_uvs(file_, part.elements[role], column.data() + part.base[role]);
      }
      if (part.elements[kTangents].count > 0)
        read_gltf_tangents(file_, part.elements[kTangents], mesh.tangents.data() + part.base[kTangents]);
    }
  }

  /// Numbers of an attribute beside the part's positions.
  std::vector<float> beside(const Part& part, std::uint32_t accessor, std::uint32_t components) const {
    const GltfElements elements = accessors_.elements(accessor);
    if (elements.count != part.elements[kPositions].count)
      file_.fail(elements.name + ": " + std::to_string(elements.count) + " elements for " +
                 std::to_string(part.elements[kPositions].count) + " vertices of " + part.name);
    return accessors_.numbers(accessor, components);
  }

  /// Whether what bends the part and stands beside Draco's data is of as many vertices, which then are in the
  /// same order, by the extension's rules.
  bool can_bend_draco(const Part& part) const {
    const GltfAttributes& a = part.primitive->attributes;
    const auto first = static_cast<std::ptrdiff_t>(std::min(part.draco->joints.size(), a.joints.size()));
    std::vector<std::uint32_t> beside;
    if (!bending_->joints.empty()) {
      beside.assign(a.joints.begin() + first, a.joints.end());
      beside.insert(beside.end(), a.weights.begin() + first, a.weights.end());
    }
    for (std::size_t i = 0; i < std::min(part.primitive->targets.size(), bending_->weights.size()); ++i) {
      const GltfAttributes& target = part.primitive->targets[i];
      if (bending_->weights[i] != 0)
        beside.insert(beside.end(), {target.positions, target.normals, target.tangents});
    }
    return std::ranges::all_of(beside, [&](std::uint32_t accessor) {
      return accessor == kNoId || file_.model().accessors[accessor].count == part.elements[kPositions].count;
    });
  }

  void bend(const Part& part) {
    const GltfPrimitive& primitive = *part.primitive;
    const bool is_bent = (!bending_->weights.empty() && !primitive.targets.empty()) ||
                         (!bending_->joints.empty() && !primitive.attributes.joints.empty());
    if (!is_bent || part.elements[kPositions].count == 0) return;
    if (part.draco != nullptr && !can_bend_draco(part)) {
      warnings_.push_back(
          part.name +
          ": is packed by Draco, with other vertices than its skin or morph targets have, and "
          "is not bent by them");
      return;
    }
    for (std::size_t i = 0; i < std::min(primitive.targets.size(), bending_->weights.size()); ++i)
      if (bending_->weights[i] != 0) add_target(part, primitive.targets[i], bending_->weights[i]);
    if (!bending_->joints.empty() && !primitive.attributes.joints.empty()) add_skin(part);
    const Vec3f* const positions = out_.mesh.positions.data() + part.base[kPositions];
    for (std::uint64_t i = 0; i < part.elements[kPositions].count; ++i)
      for (const float x : {positions[i].x, positions[i].y, positions[i].z})
        if (!is_coordinate(x)) file_.fail(part.name + ": bent: " + bad_coordinate(x));
  }

  void add_target(const Part& part, const GltfAttributes& target, double weight) {
    TriangleMesh& mesh = out_.mesh;
    const auto add_to = [&](std::uint32_t accessor, float* first, std::size_t stride) {
      if (accessor == kNoId) return;
      const std::vector<float> numbers = beside(part, accessor, 3);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        first[stride * (i / 3) + i % 3] += static_cast<float>(weight * static_cast<double>(numbers[i]));
    };
    add_to(target.positions, &mesh.positions[part.base[kPositions]].x, 3);
    if (part.has[kNormals]) add_to(target.normals, &mesh.normals[part.base[kNormals]].x, 3);
    if (part.has[kTangents]) add_to(target.tangents, mesh.tangents[part.base[kTangents]].data(), 4);
  }

  void add_skin(const Part& part) {
    const GltfAttributes& a = part.primitive->attributes;
    const std::size_t count = part.elements[kPositions].count;
    accessors_.spend(sizeof(Affine) * count);
    std::vector<Affine> maps(count, zero_map());
    std::vector<double> sums(count);
    for (std::size_t set = 0; set < a.joints.size(); ++set) {
      const bool is_packed = part.draco != nullptr && set < part.draco->joints.size();
      const std::vector<float> joints = is_packed ? part.draco->joints[set] : beside(part, a.joints[set], 4),
                               weights =
                                   is_packed ? part.draco->weights[set] : beside(part, a.weights[set], 4);
      for (std::size_t i = 0; i < joints.size(); ++i) {
        if (weights[i] == 0) continue;
        if (!(joints[i] >= 0 && joints[i] < static_cast<float>(bending_->joints.size())))
          file_.fail(part.name + ": there is no joint " + std::to_string(static_cast<long>(joints[i])) +
                     ": the skin has " + std::to_string(bending_->joints.size()));
        const double weight = static_cast<double>(weights[i]);
        const Affine& joint = bending_->joints[static_cast<std::size_t>(joints[i])];
        for (std::size_t row = 0; row < 3; ++row)
          for (std::size_t k = 0; k < 4; ++k) maps[i / 4].m[row][k] += weight * joint.m[row][k];
        sums[i / 4] += weight;
      }
    }
    TriangleMesh& mesh = out_.mesh;
    in_parts(count, std::size_t{1} << 14, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        if (!(sums[i] > 0)) continue;
        for (auto& row : maps[i].m)
          for (double& x : row) x /= sums[i];
        move_vertex(part, maps[i], i, mesh);
      }
    });
  }

  static Affine zero_map() {
    Affine map;
    for (auto& row : map.m) row = {};
    return map;
  }

  static void move_vertex(const Part& part, const Affine& map, std::size_t i, TriangleMesh& mesh) {
    Vec3f& p = mesh.positions[part.base[kPositions] + i];
    p = Vec3f(map.point(Vec3d(p)));
    if (!part.has[kNormals]) return;
    Vec3f& n = mesh.normals[part.base[kNormals] + i];
    if (map.is_invertible()) {
      const Vec3d moved = map.inverse().normal_by_inverse(Vec3d(n)) * (map.determinant() < 0 ? -1.0 : 1.0);
      if (const double size = length(moved); size > 0) n = Vec3f(moved / size);
    }
    if (!part.has[kTangents]) return;
    std::array<float, 4>& t = mesh.tangents[part.base[kTangents] + i];
    const Vec3f along(map.vector(Vec3d(Vec3f{t[0], t[1], t[2]})));
    t = {along.x, along.y, along.z, t[3]};
  }

  void fill_indices() {
    TriangleMesh& mesh = out_.mesh;
    for (const std::size_t role : {kNormals, kUvs}) {
      if (!any(role)) continue;
      Column<std::uint32_t>& column = role == kNormals ? mesh.normal_indices : mesh.uv_indices;
      column.resize_uninitialized(mesh.indices.size());
      for (const Part& part : parts_) shift(part, mesh.indices, column, role);
    }
    for (const Part& part : parts_) shift(part, mesh.indices, mesh.indices, kPositions);
  }

  /// Makes numbers of the part's elements those of the column.
  static void shift(const Part& part, const Column<std::uint32_t>& from, Column<std::uint32_t>& to,
                    std::size_t role) {
    const auto base = static_cast<std::uint32_t>(part.base[role]);
    if (base == 0 && part.has[role] && &from == &to) return;
    const std::uint32_t* const in = from.data() + 3 * part.first_triangle;
    std::uint32_t* const out = to.data() + 3 * part.first_triangle;
    const bool has = part.has[role];
    in_parts(3 * part.triangles, std::size_t{1} << 17, [&](std::uint64_t first, std::uint64_t last) {
      for (std::uint64_t i = first; i < last; ++i) out[i] = has ? in[i] + base : kNoId;
    });
  }

  void fill_slots() {
    TriangleMesh& mesh = out_.mesh;
    if (out_.slots.size() < 2) return;
    mesh.material_slots.resize_uninitialized(triangles_);
    for (const Part& part : parts_)
      std::fill_n(mesh.material_slots.data() + part.first_triangle, part.triangles, part.slot);
  }

  GltfAccessors& accessors_;
  const GltfFile& file_;
  const std::uint32_t number_;
  const GltfChoice choice_;
  const bool strokes_;
  const GltfBending* const bending_;
  std::vector<std::string>& warnings_;
  std::vector<Part> parts_;
  std::deque<DracoMesh> draco_;
  std::deque<std::string> picked_;
  std::optional<GltfCarriedJoin> join_;
  std::uint64_t triangles_ = 0;
  std::uint64_t sizes_[kRoles] = {};
  GltfBuiltMesh out_;
};

}  // namespace

GltfBuiltMesh GltfMeshBuilder::build(std::uint32_t number, const GltfChoice& choice,
                                     const GltfBending* bending, std::vector<std::string>& warnings) {
  Build build(accessors_, number, choice, bending, warnings);
  accessors_.spend(build.measure());
  return build.run();
}

}  // namespace oktett
