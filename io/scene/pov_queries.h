#pragma once
/// \file What scenes in POV-Ray's language ask of their own objects and patterns while they are read. Within
/// io/ only.

#include <cstdint>
#include <list>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/noise_generator.h"
#include "io/pov/read_pov.h"

namespace oktett {

/// Answers by what objects become here: each object that is asked is translated as if it stood in the scene,
/// built, and kept for the next question. What is too large is an Error.
class PovQueries final : public pov::ObjectQueries {
 public:
  PovQueries();
  ~PovQueries() override;

  void begin(const pov::Document& document) override { document_ = &document; }
  std::uint64_t take_steps() override { return std::exchange(steps_, 0); }
  std::optional<bool> inside(const BlockPointer& object, const Point& point) override;
  std::optional<Hit> trace(const BlockPointer& object, const Point& origin, const Point& direction) override;
  std::optional<std::pair<Point, Point>> extent(const BlockPointer& object) override;
  std::optional<std::array<double, 5>> pigment(const BlockPointer& block, const Point& point) override;
  std::optional<double> pattern(const BlockPointer& block, const Point& point) override;
  std::optional<double> internal(std::uint32_t number, std::span<const double> arguments) override;
  std::optional<Point> turbulence(double lambda, double omega, int octaves, const Point& point) override;

  /// What could not be said of what was asked.
  std::vector<Warning> take_warnings() { return std::move(warnings_); }

 private:
  struct Asked;
  struct Surfaces;
  struct Look;

  Asked& find(const BlockPointer& block);
  const Surfaces& surfaces(Asked& asked, bool as_solid);
  struct Weight {
    std::uint64_t elements, functions;  ///< steps of functions
  };
  Weight weight(const pov::Block& block);
  std::unique_ptr<Surfaces> make_surfaces(const Asked& asked, bool as_solid);
  const Look& look(Asked& asked);
  std::unique_ptr<Look> make_look(const Asked& asked);
  /// Calls make(); an Error without a place gets that of the block.
  template <class Make>
  void at_place(const Asked& asked, const Make& make);
  void warn(const std::vector<Warning>& warnings);

  /// The one that the statements read so far ask for.
  NoiseGenerator noise_generator();

  const pov::Document* document_ = nullptr;
  std::size_t statements_seen_ = static_cast<std::size_t>(-1);  ///< of which `noise_generator_` is
  double version_seen_ = 0;
  NoiseGenerator noise_generator_{};
  std::list<Asked> asked_;  ///< the last one that was asked first
  std::unordered_map<const pov::Block*, std::list<Asked>::iterator> places_;
  std::uint64_t weight_ = 0;  ///< of all that is kept
  std::uint64_t steps_ = 0;
  std::vector<Warning> warnings_;
};

}  // namespace oktett
