/// \file Fractals in scene files.

#include "io/scene_exact.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

void read_depth(SceneLoad& load, const YamlNode* node, std::uint32_t& depth, int most) {
  if (node) depth = load.values.integer(*node, 0, static_cast<std::uint32_t>(most));
}

MaybeForm read_sphereflake(SceneLoad& load, const YamlNode&, const YamlNode& node) {
  const Fields fields(node, "sphereflake", {"depth", "ratio"});
  SphereflakeShape shape;
  read_depth(load, fields["depth"], shape.depth, kMaxSphereflakeDepth);
  load.values.read(fields["ratio"], shape.ratio, {0, 0.5, true});
  return shape;
}

MaybeForm read_menger(SceneLoad& load, const YamlNode&, const YamlNode& node) {
  const Fields fields(node, "menger", {"depth"});
  MengerShape shape;
  read_depth(load, fields["depth"], shape.depth, kMaxMengerDepth);
  return shape;
}

constexpr ExactReader kReaders[] = {{"sphereflake", read_sphereflake}, {"menger", read_menger}};

}  // namespace

std::span<const ExactReader> fractal_readers() { return kReaders; }

}  // namespace oktett
