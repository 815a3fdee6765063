#include <span>
#include <string>

#include "io/ply/body.h"

namespace oktett {

std::uint64_t count_polygon(std::uint64_t corners, const char* where) {
  if (corners < 3) stop_at(where, "a face needs at least 3 corners, found " + std::to_string(corners));
  return corners - 2;
}

void check_texcoords(std::uint64_t values, std::uint64_t corners, const char* where) {
  if (values == 0 || values == 2 * corners) return;
  stop_at(where, "expected " + std::to_string(2 * corners) + " texture coordinates for " +
                     std::to_string(corners) + " corners, or none, found " + std::to_string(values));
}

void PlyFaceWriter::begin(const char* where) {
  where_ = where;
  corners_.clear();
  uvs_.clear();
}

void PlyFaceWriter::check_index(std::int64_t index, const char* where) const {
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count_)
    stop_at(where, "vertex index " + std::to_string(index) + " is out of range: the file has " +
                       std::to_string(vertex_count_) + " vertices");
}

void PlyFaceWriter::add_index(std::int64_t index, const char* where) {
  if (strips_ && index == -1) {
    corners_.push_back(kNoId);
    return;
  }
  check_index(index, where);
  corners_.push_back(static_cast<std::uint32_t>(index));
}

void PlyFaceWriter::end() {
  if (strips_)
    write_strips();
  else
    write_polygon();
}

std::uint32_t* PlyFaceWriter::take_triangles(std::uint64_t count, const char* where) {
  if (count > last_ - next_) stop_changed(where);
  std::uint32_t* const indices = mesh_.indices.data() + 3 * next_;
  next_ += count;
  return indices;
}

/// The arguments are numbers of corners.
void PlyFaceWriter::write(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (next_ == last_) stop_changed(where_);
  const std::size_t at = 3 * next_++;
  const std::uint32_t corner[3] = {a, b, c};
  for (std::size_t k = 0; k < 3; ++k) {
    mesh_.indices[at + k] = corners_[corner[k]];
    if (mesh_.uv_indices.empty()) continue;
    mesh_.uv_indices[at + k] = uvs_.empty() ? kNoId : static_cast<std::uint32_t>(next_uv_ + corner[k]);
  }
}

void PlyFaceWriter::write_strips() {
  std::uint32_t length = 0;
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    length = corners_[i] == kNoId ? 0 : length + 1;
    // Every second triangle of a strip runs the other way round.
    if (length > 2 && length % 2 == 1) write(i - 2, i - 1, i);
    if (length > 2 && length % 2 == 0) write(i - 1, i - 2, i);
  }
}

void PlyFaceWriter::write_polygon() {
  count_polygon(corners_.size(), where_);
  check_texcoords(uvs_.size(), corners_.size(), where_);
  if (uvs_.size() / 2 > last_uv_ - next_uv_) stop_changed(where_);
  for (std::size_t i = 0; i < uvs_.size() / 2; ++i) mesh_.uvs[next_uv_ + i] = {uvs_[2 * i], uvs_[2 * i + 1]};
  if (corners_.size() == 3) {
    write(0, 1, 2);
  } else {
    points_.clear();
    for (const std::uint32_t corner : corners_) points_.push_back(mesh_.positions[corner]);
    const std::span<const std::uint32_t> cut = triangulator_.run(points_);
    for (std::size_t i = 0; i < cut.size(); i += 3) write(cut[i], cut[i + 1], cut[i + 2]);
  }
  next_uv_ += uvs_.size() / 2;
}

}  // namespace oktett
