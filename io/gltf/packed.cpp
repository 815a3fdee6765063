#include "io/gltf/packed.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "core/error.h"

#ifdef OKTETT_HAVE_DRACO
#include <draco/compression/decode.h>
#endif
#ifdef OKTETT_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace oktett {

#ifdef OKTETT_HAVE_DRACO

namespace {

/// The greatest whole number of a type; 0: of floats.
float greatest_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return 127;
    case draco::DT_UINT8:
      return 255;
    case draco::DT_INT16:
      return 32767;
    case draco::DT_UINT16:
      return 65535;
    default:
      return 0;
  }
}

template <int kSize>
std::vector<float> draco_numbers(const GltfFile& file, const draco::Mesh& mesh, std::uint32_t id,
                                 const std::string& where, bool normalized = false) {
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr || attribute->num_components() != kSize)
    file.fail(where + ": its data hold no attribute " + std::to_string(id) + " of " + std::to_string(kSize) +
              " numbers");
  std::vector<float> numbers(std::size_t{kSize} * mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i)
    if (!attribute->ConvertValue<float, kSize>(attribute->mapped_index(draco::PointIndex(i)),
                                               &numbers[kSize * i]))
      file.fail(where + ": its data cannot be read as numbers");
  // Where the data say it, too, Draco has divided.
  const float greatest = greatest_of(attribute->data_type());
  if (normalized && !attribute->normalized() && greatest > 0)
    for (float& x : numbers) x = std::max(x / greatest, -1.0f);
  return numbers;
}

/// The type of numbers that are read as they are.
std::optional<GltfNumber> number_of_draco(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return GltfNumber::int8;
    case draco::DT_UINT8:
      return GltfNumber::uint8;
    case draco::DT_INT16:
      return GltfNumber::int16;
    case draco::DT_UINT16:
      return GltfNumber::uint16;
    case draco::DT_UINT32:
      return GltfNumber::uint32;
    case draco::DT_FLOAT32:
      return GltfNumber::float32;
    default:
      return std::nullopt;
  }
}

DracoMesh::Carried draco_carried(const GltfFile& file, const draco::Mesh& mesh, const GltfCarried& wanted,
                                 const std::string& where) {
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(wanted.number);
  if (attribute == nullptr)
    file.fail(where + ": its data hold no attribute " + std::to_string(wanted.number));
  DracoMesh::Carried out;
  const std::optional<GltfNumber> number = number_of_draco(attribute->data_type());
  out.number = number.value_or(GltfNumber::float32);
  out.components = static_cast<std::uint32_t>(attribute->num_components());
  out.normalized = number && attribute->normalized();
  const std::size_t size = std::size_t{bytes_of(out.number)} * out.components;
  out.bytes.resize(size * mesh.num_points());
  std::vector<float> floats(out.components);
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(i));
    const bool good =
        value.value() < attribute->size() && (number || attribute->ConvertValue<float>(value, floats.data()));
    if (!good) file.fail(where + ": its data cannot be read as numbers");
    if (number)
      std::memcpy(&out.bytes[size * i], attribute->GetAddress(value), size);
    else
      std::memcpy(&out.bytes[size * i], floats.data(), size);
  }
  return out;
}

}  // namespace

bool can_unpack_draco() { return true; }

DracoMesh unpack_draco(const GltfFile& file, std::string_view bytes,
                       const std::array<std::uint32_t, kDracoSizes.size()>& wanted,
                       const std::array<bool, kDracoSizes.size()>& normalized, const GltfAttributes& others,
                       const std::string& where) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  const auto result = decoder.DecodeMeshFromBuffer(&buffer);
  if (!result.ok()) file.fail(where + ": its Draco data are damaged: " + result.status().error_msg_string());
  const draco::Mesh& mesh = *result.value();
  DracoMesh out;
  out.vertices = mesh.num_points();
  out.numbers[0] = draco_numbers<3>(file, mesh, wanted[0], where, normalized[0]);
  for (std::size_t i = 1; i < wanted.size(); ++i) {
    if (wanted[i] == kNoId) continue;
    out.numbers[i] = kDracoSizes[i] == 2   ? draco_numbers<2>(file, mesh, wanted[i], where, normalized[i])
                     : kDracoSizes[i] == 3 ? draco_numbers<3>(file, mesh, wanted[i], where, normalized[i])
                                           : draco_numbers<4>(file, mesh, wanted[i], where, normalized[i]);
  }
  for (const GltfCarried& one : others.carried) out.carried.push_back(draco_carried(file, mesh, one, where));
  for (const std::uint32_t id : others.joints) out.joints.push_back(draco_numbers<4>(file, mesh, id, where));
  for (const std::uint32_t id : others.weights)
    out.weights.push_back(draco_numbers<4>(file, mesh, id, where));
  out.indices.reserve(std::size_t{3} * mesh.num_faces());
  for (draco::FaceIndex i(0); i < mesh.num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh.face(i)) out.indices.push_back(corner.value());
  return out;
}

#else

bool can_unpack_draco() { return false; }

DracoMesh unpack_draco(const GltfFile& file, std::string_view,
                       const std::array<std::uint32_t, kDracoSizes.size()>&,
                       const std::array<bool, kDracoSizes.size()>&, const GltfAttributes&,
                       const std::string& where) {
  file.fail(where + ": is packed by Draco, without which this program is built");
}

#endif

#ifdef OKTETT_HAVE_MESHOPTIMIZER

namespace {

/// The library demands it of its arguments.
bool are_proper(const GltfPacking& p) {
  using Filter = GltfPacking::Filter;
  if (p.mode != GltfPacking::Mode::attributes)
    return (p.stride == 2 || p.stride == 4) && p.filter == Filter::none &&
           (p.mode == GltfPacking::Mode::indices || p.count % 3 == 0);
  if (p.stride == 0 || p.stride > 256 || p.stride % 4 != 0) return false;
  if (p.filter == Filter::octahedral) return p.stride == 4 || p.stride == 8;
  return p.filter != Filter::quaternion || p.stride == 8;
}

int unpack_to(void* out, const GltfPacking& p, std::string_view bytes) {
  const auto* const in = reinterpret_cast<const unsigned char*>(bytes.data());
  switch (p.mode) {
    case GltfPacking::Mode::attributes:
      return meshopt_decodeVertexBuffer(out, p.count, p.stride, in, bytes.size());
    case GltfPacking::Mode::triangles:
      return meshopt_decodeIndexBuffer(out, p.count, p.stride, in, bytes.size());
    case GltfPacking::Mode::indices:
      return meshopt_decodeIndexSequence(out, p.count, p.stride, in, bytes.size());
  }
  return 1;
}

void apply_filter(void* data, const GltfPacking& p) {
  switch (p.filter) {
    case GltfPacking::Filter::none:
      return;
    case GltfPacking::Filter::octahedral:
      return meshopt_decodeFilterOct(data, p.count, p.stride);
    case GltfPacking::Filter::quaternion:
      return meshopt_decodeFilterQuat(data, p.count, p.stride);
    case GltfPacking::Filter::exponential:
      return meshopt_decodeFilterExp(data, p.count, p.stride);
  }
}

}  // namespace

std::string unpack_meshopt(const GltfFile& file, const GltfPacking& p, const std::string& where) {
  const std::string_view bytes = file.bytes(p.packed, where);
  if (!are_proper(p))
    file.fail(where + ": its stride, count or filter do not go with its mode of compression");
  // The densest data are those of equal vertices: 64 bytes come from one.
  if (p.count > (std::uint64_t{1} << 32) || p.count * p.stride > 64 * bytes.size() + 65536)
    file.fail(where + ": " + std::to_string(p.count) + " elements cannot be packed in " +
              std::to_string(bytes.size()) + " bytes");
  std::string out;
  out.resize(p.count * p.stride);
  if (unpack_to(out.data(), p, bytes) != 0) file.fail(where + ": its packed data are damaged");
  apply_filter(out.data(), p);
  return out;
}

#else

std::string unpack_meshopt(const GltfFile& file, const GltfPacking&, const std::string& where) {
  file.fail(where + ": is packed by meshoptimizer, without which this program is built");
}

#endif

}  // namespace oktett
