#include "render/film/adaptive.h"

#include <algorithm>

namespace oktett {

void LuminanceSums::add(const Color& c) {
  const double y = 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) +
                   0.0722 * static_cast<double>(c.z);
  sum += y, square += y * y;
  ++count;
}

void ErrorEstimate::add_neighbour(const LuminanceSums& s) {
  if (s.count < 2) return;
  const double n = s.count;
  variance_ += std::max(0.0, s.square - s.sum * s.sum / n) / (n - 1);
  mean_ += s.sum / n;
  ++count_;
}

std::uint32_t ErrorEstimate::samples_wanted(const IntegratorSettings& settings) const {
  const std::uint32_t pilot = settings.samples;
  if (count_ == 0) return pilot;
  const double light = std::max(mean_ / count_, kDarkestLight), allowed = settings.error * light;
  const double wanted = variance_ / count_ / (allowed * allowed) / pilot;
  const std::uint32_t most = std::max(1u, settings.max_samples / pilot);
  std::uint32_t times = 1;
  // 1, 2, 3, 4, 6, 8, 12, ...: blocks that samplers spread evenly, without much more than is wanted.
  while (times < most && times < wanted)
    times = times == 1 ? 2 : (times & (times - 1)) == 0 ? times + times / 2 : times / 3 * 4;
  return pilot * std::min(times, most);
}

}  // namespace oktett
