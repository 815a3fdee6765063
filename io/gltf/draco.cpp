#include "io/gltf/draco.h"

#include "core/error.h"

#ifdef OKTETT_HAVE_DRACO
#include <draco/compression/decode.h>
#endif

namespace oktett {

#ifdef OKTETT_HAVE_DRACO

namespace {

template <int kSize>
std::vector<float> numbers_of(const GltfFile& file, const draco::Mesh& mesh, std::uint32_t id,
                              const std::string& where) {
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr || attribute->num_components() != kSize)
    file.fail(where + ": its data hold no attribute " + std::to_string(id) + " of " + std::to_string(kSize) +
              " numbers");
  std::vector<float> numbers(std::size_t{kSize} * mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i)
    if (!attribute->ConvertValue<float, kSize>(attribute->mapped_index(draco::PointIndex(i)),
                                               &numbers[kSize * i]))
      file.fail(where + ": its data cannot be read as numbers");
  return numbers;
}

}  // namespace

bool can_unpack_draco() { return true; }

DracoMesh unpack_draco(const GltfFile& file, std::string_view bytes, const GltfAttributes& wanted,
                       std::size_t uv_set, const std::string& where) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  const auto result = decoder.DecodeMeshFromBuffer(&buffer);
  if (!result.ok()) file.fail(where + ": its Draco data are damaged: " + result.status().error_msg_string());
  const draco::Mesh& mesh = *result.value();
  DracoMesh out;
  out.vertices = mesh.num_points();
  out.positions = numbers_of<3>(file, mesh, wanted.positions, where);
  if (wanted.normals != kNoId) out.normals = numbers_of<3>(file, mesh, wanted.normals, where);
  if (wanted.uvs[uv_set] != kNoId) out.uvs = numbers_of<2>(file, mesh, wanted.uvs[uv_set], where);
  out.indices.reserve(std::size_t{3} * mesh.num_faces());
  for (draco::FaceIndex i(0); i < mesh.num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh.face(i)) out.indices.push_back(corner.value());
  return out;
}

#else

bool can_unpack_draco() { return false; }

DracoMesh unpack_draco(const GltfFile& file, std::string_view, const GltfAttributes&, std::size_t,
                       const std::string& where) {
  file.fail(where + ": is packed by Draco, without which this program is built");
}

#endif

}  // namespace oktett
