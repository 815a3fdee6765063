#pragma once
/// \file The figures of the comparison, as a table for people and as JSON.

#include <string>
#include <utility>
#include <vector>

#include "bench/peer_options.h"
#include "bench/peer_timing.h"

namespace oktett::bench {

/// The modes of Embree that every row is measured against: hits as fast as it can, and its robust mode.
inline constexpr int kRivals = 2;

/// One rival's figures.
struct Against {
  Quartiles embree;
  Quartiles ratio;   ///< above 1: Oktett is faster; bytes: Oktett's over Embree's
  std::string mode;  ///< how many rays at a time, which tree
};

/// One line: rates (higher is better), sizes or times (lower is better). Figures that do not apply are zeros.
struct Row {
  std::string mesh;
  bool inside = false;
  int resolution = 0;  ///< 0: the row does not depend on the picture
  int threads = 1;
  std::string work, unit;
  Quartiles oktett, null;
  Against against[kRivals];                           ///< ordinary, robust
  std::string mode;                                   ///< how Oktett does it
  std::vector<std::pair<std::string, double>> parts;  ///< the parts of the figures, in seconds
};

/// Rays of one work whose answers were compared.
struct Agreement {
  std::string mesh;
  bool inside = false;
  int resolution = 0;
  std::string work;
  std::size_t rays = 0;
  /// By rival: one tracer found a hit, the other none; or they found another number of hits.
  std::size_t hit_or_miss[kRivals] = {};
  std::size_t distance[kRivals] = {};  ///< t, or the sum of all, differs by more than 1e-3 of itself
};

struct PeerReport {
  std::vector<Row> rows;
  std::vector<Agreement> agreements;
};

void print_header(const PeerOptions& options, const std::string& isa);
void print_row(const Row& row);
/// One line for all works of a mesh.
void print_agreement(const std::vector<Agreement>& agreements);

/// Throws Error if the file cannot be written.
void write_json(const std::string& path, const PeerReport& report, const std::string& isa);

}  // namespace oktett::bench
