#include "io/photon/photon_map_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/hash.h"
#include "io/image/output.h"
#include "io/text/mapped_file.h"
#include "render/photon/photon_map.h"
#include "render/scene.h"

namespace oktett {
namespace {

static_assert(std::endian::native == std::endian::little, "photons are written as they lie in memory");

/// Begins every file; the number is the version of the format.
constexpr std::string_view kMagic = "oktett photons 2\n";
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

std::uint64_t checksum(std::string_view bytes) {
  Hasher hash;
  std::uint64_t word;
  for (; bytes.size() >= sizeof word; bytes.remove_prefix(sizeof word)) {
    std::memcpy(&word, bytes.data(), sizeof word);
    hash.add(word);
  }
  for (const char c : bytes) hash.add(std::uint64_t{static_cast<unsigned char>(c)});
  return hash.value();
}

/// Takes pieces off the front of a file.
class Pieces {
 public:
  Pieces(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {}

  std::string_view take(std::size_t size) {
    if (bytes_.size() < size) fail("the file is cut short");
    const std::string_view piece = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return piece;
  }
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::size_t left() const { return bytes_.size(); }
  [[noreturn]] void fail(const std::string& message) const { throw Error(Location{path_}, message); }

 private:
  const std::string& path_;
  std::string_view bytes_;
};

bool is_possible(const Photon& p) {
  const bool power = p.power.x >= 0 && p.power.y >= 0 && p.power.z >= 0;
  return is_finite(p.position) && is_finite(p.power) && power && p.bounces > 0 && p.bounces <= kMostBounces &&
         p.light_group < kMostLightGroups;
}

PhotonPass read_pass(Pieces& pieces) {
  const auto header = pieces.take<PassHeader>();
  if (!(header.radius > 0) || !std::isfinite(header.radius))
    pieces.fail("the radius of a pass is not positive");
  // Compared before the memory is asked for.
  if (header.count > pieces.left() / sizeof(Photon)) pieces.fail("the file is cut short");
  Column<Photon> photons(header.count);
  const std::string_view bytes = pieces.take(header.count * sizeof(Photon));
  if (!bytes.empty()) std::memcpy(photons.data(), bytes.data(), bytes.size());
  for (const Photon& photon : photons)
    if (!is_possible(photon)) pieces.fail("a photon has numbers that none can have");
  return {std::move(photons), header.radius};
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
  Pieces pieces(path, file.text());
  if (pieces.left() < kMagic.size() || pieces.take(kMagic.size()) != kMagic)
    pieces.fail("is not a photon map of version 2");
  const auto header = pieces.take<Header>();
  auto map = std::make_shared<PhotonMap>();
  map->path = path;
  map->plan = {header.photons, header.passes, header.depth, header.seed, header.radius, header.moments};
  map->scene = {header.geometry, header.materials, header.lights};
  if (header.photons == 0 || header.passes == 0 || header.passes > kMostPasses)
    pieces.fail("the numbers of photons and passes are out of range");
  Hasher hash;
  hash.add(checksum(kMagic)), hash.add(checksum(bytes_of(header)));
  for (std::uint32_t pass = 0; pass < header.passes; ++pass) {
    Pieces again = pieces;
    map->passes.push_back(read_pass(pieces));
    hash.add(checksum(again.take(sizeof(PassHeader))));
    hash.add(checksum(again.take(map->passes.back().photons().size() * sizeof(Photon))));
  }
  if (pieces.left() != sizeof(std::uint64_t)) pieces.fail("the file has not the length that it says");
  if (pieces.take<std::uint64_t>() != hash.value()) pieces.fail("the checksum is wrong: the file is damaged");
  return map;
}

}  // namespace oktett
