// A program that is compiled for a processor with fused multiply-add and uses the functions of public headers
// that compute. tests/install/run_install_test.cmake looks at its object file: a weak function with a fused
// operation would take the place of the library's own.
#include <oktett/oktett.h>
#include <cstdio>

template <class T>
static T computed(const oktett::Vec3<T>& a, const oktett::Vec3<T>& b) {
  oktett::Vec3<T> tangent, bitangent;
  make_basis(normalize(a), tangent, bitangent);
  oktett::Vec3<T> sum = cross(a, b) * dot(a, b) + a * b - abs(b) / length(a);
  sum += min(a, b);
  sum -= max(tangent, -bitangent);
  sum *= T(3);
  return max_component(sum) + (is_finite(sum) && !is_black(a) ? sum[dominant_axis(b)] : T(0)) + a.x * b.x;
}

int main(int count, char**) {
  const double x = 0.1 * count;
  const oktett::Vec3d a{x, x + 1, x - 2}, b{x * x, 3 - x, x};
  const auto f = static_cast<oktett::Vec3f>(a), g = static_cast<oktett::Vec3f>(b);
  oktett::Box box;
  box.grow(f);
  box.grow(oktett::Box{g, g});
  const float area =
      box.half_area() + box.center().x * box.extent().y + (box.contains(f) && !box.empty() ? 1 : 0);
  const oktett::Vec3f up = oktett::round_up(a), down = oktett::round_down(b);
  std::printf("%g %g %g\n", computed(a, b), static_cast<double>(computed(f, g)),
              static_cast<double>(area + up.x * down.y + oktett::glass_weight(f.x, g.x)));
}
