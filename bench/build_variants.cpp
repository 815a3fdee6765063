#include "bench/build_variants.h"

#include <algorithm>

#include "core/error.h"

namespace oktett::bench {

const std::vector<BuildVariant>& build_variants() {
  // A new build quality is added here only.
  static const std::vector<BuildVariant> variants = {
      {"balanced", {BuildQuality::balanced}}, {"fast", {BuildQuality::fast}}, {"best", {BuildQuality::best}}};
  return variants;
}

const BuildVariant& find_variant(const std::string& name) {
  const std::vector<BuildVariant>& all = build_variants();
  if (name.empty()) return all.front();
  const auto at = std::find_if(all.begin(), all.end(), [&](const BuildVariant& v) { return v.name == name; });
  if (at == all.end()) throw Error("there is no way to build called '" + name + "'");
  return *at;
}

}  // namespace oktett::bench
