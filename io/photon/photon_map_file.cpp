#include "io/photon/photon_map_file.h"

#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/bytes.h"
#include "core/error.h"
#include "io/image/output.h"
#include "io/text/file_content.h"
#include "render/photon/photon_map.h"
#include "render/scene.h"

namespace oktett {
namespace {

/// Begins every file; the number is the version of the format.
constexpr std::string_view kMagic = "oktett photons 3\n";
constexpr std::uint32_t kMostPasses = 4096, kMostBounces = 65;

struct Header {
  std::uint32_t photons, passes, depth, seed;
  double radius;
  std::uint64_t geometry, materials, lights;
  std::uint32_t moments, unused;
};
static_assert(sizeof(Header) == 56);

struct PassHeader {
  float radius;
  std::uint32_t count;
};

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

std::string_view bytes_of(const Column<Photon>& photons) {
  return {reinterpret_cast<const char*>(photons.data()), photons.size() * sizeof(Photon)};
}

bool is_possible(const Photon& p) {
  const bool power = p.power.x >= 0 && p.power.y >= 0 && p.power.z >= 0;
  return is_finite(p.position) && is_finite(p.power) && power && p.bounces > 0 && p.bounces <= kMostBounces &&
         p.light_group < kMostLightGroups;
}

/// Takes a value off the front of a file; the same bytes go into the hash.
template <class T>
T take(ByteReader& bytes, Hasher& hash) {
  T value;
  const std::string_view piece = bytes.take(sizeof(T));
  hash.add(checksum(piece));
  std::memcpy(&value, piece.data(), sizeof(T));
  return value;
}

PhotonPass read_pass(ByteReader& bytes, Hasher& hash) {
  const auto header = take<PassHeader>(bytes, hash);
  if (!(header.radius > 0) || !std::isfinite(header.radius))
    throw Error("the radius of a pass is not positive");
  // Before the memory is asked for.
  const std::string_view piece = bytes.take(header.count * sizeof(Photon));
  hash.add(checksum(piece));
  Column<Photon> photons(header.count);
  if (!piece.empty()) std::memcpy(photons.data(), piece.data(), piece.size());
  for (const Photon& photon : photons)
    if (!is_possible(photon)) throw Error("a photon has numbers that none can have");
  return {std::move(photons), header.radius};
}

std::shared_ptr<PhotonMap> parse_photon_map(std::string_view text) {
  if (!text.starts_with(kMagic)) throw Error("is not a photon map of version 3");
  ByteReader bytes(text);
  Hasher hash;
  hash.add(checksum(bytes.take(kMagic.size())));
  const auto header = take<Header>(bytes, hash);
  auto map = std::make_shared<PhotonMap>();
  map->plan = {header.photons, header.passes, header.depth, header.seed, header.radius, header.moments};
  map->scene = {header.geometry, header.materials, header.lights};
  if (header.photons == 0 || header.passes == 0 || header.passes > kMostPasses)
    throw Error("the numbers of photons and passes are out of range");
  for (std::uint32_t pass = 0; pass < header.passes; ++pass) map->passes.push_back(read_pass(bytes, hash));
  if (bytes.left() != sizeof(std::uint64_t)) throw Error("the file has not the length that it says");
  if (bytes.number<std::uint64_t>() != hash.value())
    throw Error("the checksum is wrong: the file is damaged");
  return map;
}

}  // namespace

void write_photon_map(const std::string& path, const PhotonMap& map) {
  OutputFile file(path);
  Hasher hash;
  const auto write = [&](std::string_view bytes) {
    file.write(bytes);
    hash.add(checksum(bytes));
  };
  write(kMagic);
  const PhotonPlan& plan = map.plan;
  write(bytes_of(Header{plan.photons, plan.passes, plan.depth, plan.seed, plan.radius, map.scene.geometry,
                        map.scene.materials, map.scene.lights, plan.moments, 0}));
  for (const PhotonPass& pass : map.passes) {
    write(bytes_of(PassHeader{pass.radius(), static_cast<std::uint32_t>(pass.photons().size())}));
    write(bytes_of(pass.photons()));
  }
  file.write(bytes_of(hash.value()));
  file.commit();
}

std::shared_ptr<const PhotonMap> read_photon_map(const std::string& path) {
  const MappedFile file(path);
  try {
    const std::shared_ptr<PhotonMap> map = parse_photon_map(file.text());
    map->path = path;
    return map;
  } catch (const Error& error) {
    throw Error(Location{path}, error.what(), error.kind());
  }
}

}  // namespace oktett
