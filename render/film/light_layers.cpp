#include "render/film/light_layers.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "render/light_groups.h"

namespace oktett {

static std::string plane_name(const std::string& group, char channel) {
  return fmt::format("light_{}.{}", group, channel);
}

void add_light_planes(const std::vector<std::string>& names, Picture& picture) {
  const std::size_t size = static_cast<std::size_t>(picture.width) * picture.height;
  for (const std::string& name : names)
    for (const char channel : {'R', 'G', 'B'})
      picture.planes.push_back(
          {plane_name(name, channel), PlaneType::half_float, filled_column(size, 0.0f), {}});
}

std::size_t first_light_plane(const Picture& picture) {
  const std::string name = plane_name(kDefaultLightGroup, 'R');
  const auto is_first = [&](const PicturePlane& plane) { return plane.name == name; };
  return static_cast<std::size_t>(std::ranges::find_if(picture.planes, is_first) - picture.planes.begin());
}

void add_to_layers(const SampleBatch& samples, std::size_t i, double* sums) {
  for (const ColorColumn& layer : samples.grouped)
    for (const Column<float>& channel : layer.part) *sums++ += static_cast<double>(channel[i]);
}

void write_layers(Picture& picture, std::size_t first, std::size_t at, std::span<const double> sums,
                  std::uint32_t samples) {
  if (samples == 0) return;
  for (std::size_t k = 0; k < sums.size(); ++k)
    picture.planes[first + k].values[at] = static_cast<float>(sums[k] / samples);
}

}  // namespace oktett
