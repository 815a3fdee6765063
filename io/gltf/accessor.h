#pragma once
/// \file The numbers of accessors. Within io/ only.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"
#include "io/gltf/gltf_file.h"

namespace oktett {

/// Elements in memory: those of an accessor, or what Draco's data hold.
struct GltfElements {
  std::string name;            ///< for messages, as "accessors[3]"
  const char* data = nullptr;  ///< null: all are zero
  std::uint64_t count = 0;
  std::uint32_t stride = 0;
  GltfNumber number = GltfNumber::float32;
  std::uint32_t components = 1;
  bool normalized = false;
  /// Elements that stand elsewhere: so many indices, and values without gaps.
  std::uint64_t sparse_count = 0;
  const char* sparse_indices = nullptr;
  const char* sparse_values = nullptr;
  GltfNumber sparse_number = GltfNumber::uint32;
};

/// Finds the elements of accessors in the buffers of a file. Views that meshoptimizer has packed are unpacked
/// when they are first asked for.
class GltfAccessors {
 public:
  explicit GltfAccessors(const GltfFile& file) : file_(file) {}

  /// Throws Error if elements are not all there.
  GltfElements elements(std::uint32_t accessor);

  /// The numbers of an accessor, see read_gltf_numbers; counted by spend().
  std::vector<float> numbers(std::uint32_t accessor, std::uint32_t components);

  /// Counts memory that is taken for the file. Throws Error if it is more in all than the file justifies.
  void spend(std::uint64_t bytes);

  const GltfFile& file() const { return file_; }

 private:
  std::string_view view_bytes(std::uint32_t view, const std::string& where);
  std::string_view elements_in(std::uint32_t view, std::uint64_t offset, std::uint64_t count,
                               std::uint32_t size, std::uint32_t stride, const std::string& where);
  void add_sparse(const GltfAccessor& accessor, GltfElements& elements);

  const GltfFile& file_;
  std::map<std::uint32_t, std::string> unpacked_;  ///< by the number of the view
  std::uint64_t spent_ = 0;
};

/// What coordinates must be.
enum class GltfCheck : std::uint8_t { finite, coordinate };

/// Reads vectors of three numbers to `out`, which has room for all elements. Throws Error for other elements,
/// and for numbers that fail the check.
void read_gltf_vectors(const GltfFile& file, const GltfElements& elements, GltfCheck check, Vec3f* out);
/// The same for texture coordinates; v becomes 1 - v, since here it points up in images.
void read_gltf_uvs(const GltfFile& file, const GltfElements& elements, Vec2f* out);
/// The numbers of elements of 1, 3, 4 or 16 components, which must be finite. Throws Error for other
/// elements.
std::vector<float> read_gltf_numbers(const GltfFile& file, const GltfElements& elements,
                                     std::uint32_t components);
/// The same for tangents and the side of the second one.
void read_gltf_tangents(const GltfFile& file, const GltfElements& elements, std::array<float, 4>* out);
/// Reads the numbers of all elements, as many of each as it has components, to `out`. `parts`: whole ones of
/// 8 and 16 bits are parts of the greatest one even if the accessor does not say so. Numbers may be anything.
/// Throws Error for a sparse element out of range.
void read_gltf_values(const GltfFile& file, const GltfElements& elements, bool parts, float* out);
/// Reads indices, which must be below `limit`. Throws Error if one is not, or for other elements.
void read_gltf_indices(const GltfFile& file, const GltfElements& elements, std::uint64_t limit,
                       std::uint32_t* out);

}  // namespace oktett
