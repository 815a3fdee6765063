// Scenes in POV-Ray's language: every input is read or refused within the limits, and what is read can be
// walked.

#include "io/pov/read_pov.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/pov_options.h"

namespace {

using namespace oktett;

/// Answers everything with a number, so that no question ends the reading.
class Answers final : public pov::ObjectQueries {
  std::optional<bool> inside(const BlockPointer&, const Point& p) override { return p[0] > 0; }
  std::optional<Hit> trace(const BlockPointer&, const Point& origin, const Point& direction) override {
    return Hit{true, origin, direction};
  }
  std::optional<std::pair<Point, Point>> extent(const BlockPointer&) override {
    return {{{0, 0, 0}, {1, 1, 1}}};
  }
  std::optional<std::array<double, 5>> pigment(const BlockPointer&, const Point& p) override {
    return {{p[0], p[1], p[2], 0, 0}};
  }
  std::optional<double> pattern(const BlockPointer&, const Point& p) override { return p[0]; }
  std::optional<double> internal(std::uint32_t number, std::span<const double> a) override {
    return a.empty() ? number : a[0];
  }
  std::optional<Point> turbulence(double, double, int, const Point& p) override { return p; }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return test::fuzz_reader("scene.pov", data, size, [](const std::string& path) {
    Answers answers;
    pov::ReadOptions options = test::small_pov_options();
    options.queries = &answers;
    const pov::Document document = pov::read_pov(path, options);
    for (const pov::Element& statement : document.statements)
      test::require(document.location(statement.where).line > 0, "a statement has a place");
  });
}
