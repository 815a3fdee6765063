// Shapes with raw numbers in all their parameters, in any space, solids of them, and rays through them.

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "tests/fuzz/tracing.h"
#include "verify/cases/random_parameters.h"

namespace oktett {
namespace {

/// Raw numbers within the range of their parameter: what the readers of files refuse is not asked.
struct RawSource {
  test::InputBytes& bytes;

  bool flag() { return bytes.take<std::uint8_t>() & 1; }
  double number(const Range& range) {
    const double x = static_cast<double>(bytes.number());
    return x >= range.lo && x <= range.hi ? x : 1.0;
  }
};

template <class T>
T take_shape(test::InputBytes& bytes) {
  T shape;
  DrawnParameters parameters(RawSource{bytes});
  if constexpr (requires { shape.describe(parameters); }) shape.describe(parameters);
  return shape;
}

template <std::size_t... I>
ExactForm take_form(test::InputBytes& bytes, std::size_t form, std::index_sequence<I...>) {
  ExactForm result;
  (void)((form == I &&
          (result = take_shape<std::variant_alternative_t<I, ExactForm::variant>>(bytes), true)) ||
         ...);
  return result;
}

Geometry take_geometry(test::InputBytes& bytes, std::uint32_t user) {
  Geometry g;
  g.user = user;
  constexpr std::size_t kForms = std::variant_size_v<ExactForm::variant>;
  const std::size_t kind = bytes.take<std::uint8_t>() % (kForms + 4);
  switch (kind) {
    case 0:
      g.shape = SpheresShape{{take_shape<SphereShape>(bytes)}};
      break;
    case 1:
      g.shape = take_shape<PlaneShape>(bytes);
      break;
    case 2:
      g.shape = take_shape<DiskShape>(bytes);
      break;
    case 3:
      g.shape = take_shape<BoxShape>(bytes);
      break;
    default:
      g.shape = ExactShape{take_form(bytes, kind - 4, std::make_index_sequence<kForms>{})};
      break;
  }
  if (bytes.take<std::uint8_t>() & 1)
    for (auto& row : g.transform.m)
      for (double& x : row) x = RawSource{bytes}.number(kCoordinate);
  return g;
}

}  // namespace
}  // namespace oktett

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  test::InputBytes bytes(data, size);
  const auto plan = bytes.take<std::uint8_t>();
  std::vector<Geometry> geometries;
  for (std::uint32_t i = 0; i < 1 + plan % 3u; ++i) geometries.push_back(take_geometry(bytes, i));
  if (plan & 0x40) {
    CsgExpression expression;
    expression.op = plan & 0x20 ? CsgOp::subtract : CsgOp::intersect;
    for (Geometry& g : geometries) {
      CsgExpression operand;
      operand.solids.push_back(std::move(g));
      expression.children.push_back(std::move(operand));
    }
    geometries.clear();
    geometries.push_back({CsgGeometry{std::make_shared<const CsgExpression>(std::move(expression))}, {}, 0});
  }
  const std::vector<Ray> rays = test::take_rays(bytes, 8);
  const auto accel = build_accel(std::move(geometries), {BuildQuality::balanced, false});
  test::trace_every_way(*accel, rays);
  return 0;
}
