#pragma once
/// \file A meadow of many plants from few models: 61 models of 1.1 million triangles together, 4000 plants
/// that show 19.5 million, the sizes of the forest of Zachmann 2010.

#include <cstddef>
#include <vector>

#include "bench/plant_models.h"

namespace oktett::bench {

/// What grows where.
struct Meadow {
  /// A model scaled, turned about the vertical, and moved.
  struct Plant {
    std::size_t model = 0;  ///< index into `models`
    Vec3d scale, position;
    double degrees = 0;
  };
  std::vector<PlantModel> models;
  std::vector<PlantKind> kinds;  ///< of `models`
  std::vector<Plant> plants;     ///< those of a model side by side, larger models last
};

/// The meadow of about `plants` plants of the same models.
Meadow make_meadow(std::size_t plants = 4000);

}  // namespace oktett::bench
