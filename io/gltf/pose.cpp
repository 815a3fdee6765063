#include "io/gltf/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "core/math.h"
#include "io/gltf/gltf_file.h"

namespace oktett {
namespace {

/// Towards `b` by the shortest arc (glTF 2.0, appendix C.4); both of length 1.
std::vector<double> slerped(const std::vector<double>& a, const std::vector<double>& b, double t) {
  double cosine = 0;
  for (std::size_t k = 0; k < 4; ++k) cosine += a[k] * b[k];
  const double sign = cosine < 0 ? -1 : 1, angle = portable::acos(std::min(std::abs(cosine), 1.0));
  const double sine = portable::sin(angle);
  // Nearly parallel ones lie on a line.
  const double from = sine < 1e-6 ? 1 - t : portable::sin((1 - t) * angle) / sine,
               to = sine < 1e-6 ? t : portable::sin(t * angle) / sine;
  std::vector<double> out(4);
  for (std::size_t k = 0; k < 4; ++k) out[k] = from * a[k] + sign * to * b[k];
  return out;
}

void make_unit(std::vector<double>& q) {
  double square = 0;
  for (const double x : q) square += x * x;
  if (square > 0)
    for (double& x : q) x /= std::sqrt(square);
  else
    q = {0, 0, 0, 1};
}

}  // namespace

GltfAnimator::GltfAnimator(GltfAccessors& accessors, bool moves) : accessors_(accessors) {
  if (!moves) return;
  std::set<std::pair<std::uint32_t, GltfChannel::Path>> seen;
  const std::vector<GltfChannel>& channels = accessors.file().model().channels;
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (seen.emplace(channels[i].node, channels[i].path).second) read(channels[i], i);
}

void GltfAnimator::read(const GltfChannel& channel, std::size_t number) {
  const GltfFile& file = accessors_.file();
  const GltfModel& model = file.model();
  const std::string where = "animation channel " + std::to_string(number) + ": ";
  Track track;
  track.channel = channel;
  track.times = accessors_.numbers(channel.times, 1);
  const std::size_t keys = track.times.size(), per_key = channel.curve == GltfChannel::Curve::cubic ? 3 : 1;
  if (keys == 0) return;
  for (std::size_t i = 1; i < keys; ++i)
    if (!(track.times[i] > track.times[i - 1])) file.fail(where + "its times do not ascend");
  if (channel.path == GltfChannel::Path::weights) {
    const std::uint32_t mesh = model.nodes[channel.node].mesh;
    if (mesh == kNoId || model.meshes[mesh].primitives.empty()) return;
    track.width = model.meshes[mesh].primitives[0].targets.size();
    track.values = accessors_.numbers(channel.values, 1);
  } else {
    track.width = channel.path == GltfChannel::Path::rotation ? 4 : 3;
    track.values = accessors_.numbers(channel.values, static_cast<std::uint32_t>(track.width));
  }
  if (track.values.size() != keys * per_key * track.width)
    file.fail(where + "expected " + std::to_string(keys * per_key * track.width) + " numbers for " +
              std::to_string(keys) + " keys, found " + std::to_string(track.values.size()));
  if (track.width > 0) tracks_.push_back(std::move(track));
}

std::vector<double> GltfAnimator::value_at(const Track& track, double time) {
  using Curve = GltfChannel::Curve;
  const bool turns = track.channel.path == GltfChannel::Path::rotation;
  const bool is_cubic = track.channel.curve == Curve::cubic;
  // `part`: of a cubic key, the tangent into it, its value, the tangent out of it.
  const auto at = [&](std::size_t key, std::size_t part) {
    const std::size_t first = track.width * (is_cubic ? 3 * key + part : key);
    const auto begin = track.values.begin() + static_cast<std::ptrdiff_t>(first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(track.width));
  };
  const auto after = std::upper_bound(track.times.begin(), track.times.end(), time,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const auto next = static_cast<std::size_t>(after - track.times.begin());
  std::vector<double> value = at(next == 0 ? 0 : next - 1, 1);
  if (turns) make_unit(value);
  if (next == 0 || next == track.times.size() || track.channel.curve == Curve::step) return value;
  const auto begin = static_cast<double>(track.times[next - 1]), end = static_cast<double>(track.times[next]);
  const double span = end - begin, t = (time - begin) / span;
  std::vector<double> to = at(next, 1);
  if (is_cubic) {
    value = at(next - 1, 1);
    const std::vector<double> leaving = at(next - 1, 2), arriving = at(next, 0);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t k = 0; k < track.width; ++k)
      value[k] = (2 * t3 - 3 * t2 + 1) * value[k] + span * (t3 - 2 * t2 + t) * leaving[k] +
                 (3 * t2 - 2 * t3) * to[k] + span * (t3 - t2) * arriving[k];
    if (turns) make_unit(value);
    return value;
  }
  if (turns) {
    make_unit(to);
    return slerped(value, to, t);
  }
  for (std::size_t k = 0; k < track.width; ++k) value[k] += (to[k] - value[k]) * t;
  return value;
}

GltfPose GltfAnimator::at(std::optional<double> time) const {
  const GltfModel& model = accessors_.file().model();
  const std::size_t count = model.nodes.size();
  accessors_.spend(count * (2 * sizeof(Affine) + sizeof(GltfPlace)));
  GltfPose pose;
  std::vector<GltfPlace> places;
  for (const GltfNode& node : model.nodes) {
    places.push_back(node.place);
    pose.to_parent.push_back(node.to_parent);
    const bool uses_mesh = node.weights.empty() && node.mesh != kNoId;
    pose.weights.push_back(uses_mesh ? model.meshes[node.mesh].weights : node.weights);
  }
  if (time) {
    std::set<std::uint32_t> moved;
    for (const Track& track : tracks_) {
      const std::vector<double> value = value_at(track, *time);
      const std::uint32_t node = track.channel.node;
      if (track.channel.path == GltfChannel::Path::weights) {
        pose.weights[node] = value;
        continue;
      }
      moved.insert(node);
      if (track.channel.path == GltfChannel::Path::rotation)
        places[node].rotation = {value[0], value[1], value[2], value[3]};
      else
        (track.channel.path == GltfChannel::Path::scale ? places[node].scale : places[node].translation) =
            Vec3d{value[0], value[1], value[2]};
    }
    for (const std::uint32_t node : moved) pose.to_parent[node] = places[node].transform();
  }
  // Parents first; nodes that are their own ancestors stay where they are.
  pose.to_world.resize(count);
  std::vector<bool> is_child(count), seen(count);
  for (const GltfNode& node : model.nodes)
    for (const std::uint32_t child : node.children) is_child[child] = true;
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t i = 0; i < count; ++i)
    if (!is_child[i]) waiting.push_back(i), pose.to_world[i] = pose.to_parent[i];
  while (!waiting.empty()) {
    const std::uint32_t node = waiting.back();
    waiting.pop_back();
    if (seen[node]) continue;
    seen[node] = true;
    for (const std::uint32_t child : model.nodes[node].children) {
      if (seen[child]) continue;
      pose.to_world[child] = pose.to_world[node] * pose.to_parent[child];
      waiting.push_back(child);
    }
  }
  return pose;
}

std::vector<Affine> gltf_joints(GltfAccessors& accessors, const GltfSkin& skin, const GltfPose& pose) {
  std::vector<Affine> joints;
  for (const std::uint32_t node : skin.joints) joints.push_back(pose.to_world[node]);
  if (skin.inverse_binds == kNoId) return joints;
  const std::vector<float> numbers = accessors.numbers(skin.inverse_binds, 16);
  if (numbers.size() < 16 * joints.size())
    accessors.file().fail("accessors[" + std::to_string(skin.inverse_binds) + "]: expected " +
                          std::to_string(joints.size()) + " matrices, one for each joint, found " +
                          std::to_string(numbers.size() / 16));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Affine bind;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        bind.m[row][column] = static_cast<double>(numbers[16 * i + 4 * column + row]);
    joints[i] = joints[i] * bind;
  }
  return joints;
}

}  // namespace oktett
