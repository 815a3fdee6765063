// A program outside of Oktett, with its public headers alone: traces rays in all ways, renders, reads and
// writes files. The lines between the two marks are the example of README.md.
#include <oktett/oktett.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace {

void expect(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "failed: %s\n", what);
  std::exit(1);
}

bool near(float a, double b) { return std::abs(static_cast<double>(a) - b) < 1e-5; }

oktett::TriangleMesh make_square() {
  oktett::TriangleMesh mesh;
  for (const oktett::Vec3f& p : {oktett::Vec3f{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}})
    mesh.positions.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(i);
  return mesh;
}

oktett::Geometry thing(decltype(oktett::Geometry::shape) shape, std::uint32_t user = oktett::kNoId) {
  oktett::Geometry g;
  g.shape = std::move(shape);
  g.user = user;
  return g;
}

/// The distance at which a ray from z = 5 down through (x, y) meets the geometry.
float distance_to(oktett::Geometry geometry, float x, float y = 0) {
  const auto accel = oktett::build_accel({std::move(geometry)});
  return oktett::closest_hit(*accel, {{x, y, 5}, 0, {0, 0, -1}, 100}).t;
}

void check_batches(const oktett::TriangleMesh& mesh) {
  // example
  std::vector<oktett::Geometry> things(2);
  things[0].shape = oktett::MeshGeometry{&mesh};
  things[1].shape = oktett::SpheresShape{{{{4, 0, 0}, 1.0}}};
  const auto accel = oktett::build_accel(things);

  std::vector<oktett::Ray> rays;
  for (int i = 0; i < 8; ++i) rays.push_back({{i - 2.5f, 0.25f, 5}, 0, {0, 0, -1}, 100});
  std::vector<oktett::Hit> hits(rays.size());
  oktett::closest_hit(*accel, rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (hits[i].valid()) std::printf("ray %zu meets item %u at t = %g\n", i, hits[i].item, hits[i].t);
  // end of the example

  oktett::RayBatch ray_columns;
  for (const oktett::Ray& ray : rays) ray_columns.push_back(ray);
  oktett::HitBatch hit_columns;
  hit_columns.resize_uninitialized(rays.size());
  std::vector<std::uint8_t> occluded(rays.size()), occluded_columns(rays.size());
  for (const oktett::Isa isa : oktett::available_isas()) {
    oktett::closest_hit(*accel, ray_columns, hit_columns, isa);
    oktett::any_hit(*accel, rays, occluded, isa);
    oktett::any_hit(*accel, ray_columns, occluded_columns, isa);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double x = rays[i].origin.x;
      const bool on_square = std::abs(x) < 1, on_sphere = std::abs(x - 4) < 1;
      expect(hits[i].valid() == (on_square || on_sphere), "hit or miss");
      expect(hits[i] == hit_columns[i] && hits[i] == oktett::closest_hit(*accel, rays[i], isa),
             "columns, structures and single rays agree");
      expect((occluded[i] != 0) == hits[i].valid() && occluded[i] == occluded_columns[i] &&
                 oktett::any_hit(*accel, rays[i], isa) == hits[i].valid(),
             "any_hit agrees with closest_hit");
      if (on_square) expect(hits[i].t == 5 && hits[i].item < 2, "the square is five away");
      if (on_sphere)
        expect(hits[i].item == 2 && near(hits[i].t, 5 - std::sqrt(1 - 0.0625 - (x - 4) * (x - 4))),
               "the sphere is met where it is");
    }
    std::vector<oktett::Hit> all;
    oktett::all_hits(*accel, rays[6], all, isa);
    expect(all.size() == 2, "a ray enters the sphere and leaves it");
    const oktett::ClosestPoint closest = oktett::closest_point(*accel, {4, 0, 3}, isa);
    expect(closest.item == 2 && near(closest.distance, 2) && closest.normal.z > 0.99f,
           "the nearest point of the sphere");
    expect(oktett::inside(*accel, {4, 0, 0.5f}, isa) && !oktett::inside(*accel, {4, 0, 2}, isa),
           "inside of the sphere");
    expect(near(oktett::signed_distance(*accel, {4, 0, 0.5f}, isa), -0.5), "half a unit below its surface");
  }

  const oktett::SurfaceInteraction s = oktett::surface_interaction(*accel, rays[2], hits[2]);
  expect(s.geometric_normal == oktett::Vec3f{0, 0, 1} && s.geometry == 0, "the square faces +z");
  oktett::InteractionBlock block;
  const std::uint32_t which[] = {2, 6};
  oktett::surface_interactions(*accel, ray_columns, hit_columns, which, block);
  expect(block[0].position == s.position && block[1].geometry == 1, "surfaces of a batch");
  expect(oktett::identify(*accel, hits[6]).geometry == 1, "the sphere is the second geometry");
  expect(oktett::offset_origin(s, {0, 0, 1}).z > 0, "a ray that leaves the square starts above it");
}

void check_shapes() {
  oktett::ImplicitShape function;
  function.function = oktett::compile_function("x^2 + y^2 + z^2 - 1");
  oktett::PolynomialShape polynomial;
  polynomial.terms = oktett::expand_polynomial("x^2 + y^2 + z^2 = 1");
  expect(near(distance_to(thing(oktett::ExactShape{function}), 0), 4), "a function");
  expect(near(distance_to(thing(oktett::ExactShape{polynomial}), 0), 4), "a polynomial");
  expect(near(distance_to(thing(oktett::ExactShape{oktett::TorusShape{}}), 0.7f), 4.7), "a torus");

  const oktett::Geometry box = thing(oktett::BoxShape{}, 1);
  const oktett::Geometry ball = thing(oktett::SpheresShape{{{{0, 0, 1}, 0.5}}}, 2);
  const auto dented = std::make_shared<oktett::CsgExpression>();
  dented->op = oktett::CsgOp::subtract;
  dented->children = {{oktett::CsgOp::operand, {box}, {}}, {oktett::CsgOp::operand, {ball}, {}}};
  expect(near(distance_to(thing(oktett::CsgGeometry{dented}), 0), 4.5), "a box with a dent");
  expect(near(distance_to(thing(oktett::CsgGeometry{dented}), 0.75f), 4), "a box beside its dent");
}

void check_instances() {
  const auto ball = oktett::build_accel({thing(oktett::SpheresShape{{{{0, 0, 0}, 1.0}}}, 1)});
  oktett::InstanceList list;
  list.children = {ball};
  for (std::uint32_t i = 0; i < 3; ++i) {
    oktett::InstancePlace place{{}, 0, 10 + i};
    oktett::Affine::translation({4.0 * i, 0, 0}).to_rows(place.to_list);
    list.places.push_back(place);
  }
  oktett::Geometry one = thing(oktett::InstanceGeometry{ball}, 9);
  one.transform = oktett::Affine::translation({-4, 0, 0});
  const auto accel = oktett::build_accel({one, thing(list)});
  for (int i = -1; i < 3; ++i) {
    const oktett::Hit hit = oktett::closest_hit(*accel, {{4.0f * i, 0, 5}, 0, {0, 0, -1}, 100});
    expect(hit.t == 4 && hit.instance != oktett::kNoId, "an instance");
    expect(oktett::identify(*accel, hit).user == 10u + i, "an instance has a number of its own");
  }
  expect(oktett::bounds(*accel).lo.x <= -5 && oktett::stats(*accel).items == 4, "four instances");
}

/// A grey ball before black, seen from z = 5.
void check_pictures(const std::string& folder) {
  oktett::Scene scene;
  scene.camera_given = true;
  scene.film.width = scene.film.height = 16;
  oktett::Object ball;
  ball.shape = oktett::SphereShape{};
  scene.objects.push_back(ball);
  const oktett::Picture picture = oktett::render(scene).picture;
  const oktett::PicturePlane* red = picture.find("R");
  expect(red != nullptr && red->values[16 * 8 + 8] > 0 && red->values[0] == 0, "a ball in the middle");

  std::ofstream(folder + "/ball.yaml") << "oktett: 1\ncamera: {}\nfilm: {width: 16, height: 16}\n"
                                       << "objects: [{sphere: {radius: 1}}]\n";
  const oktett::Scene read = oktett::load_scene(folder + "/ball.yaml");
  expect(read.objects.size() == 1, "a scene file holds one object");
  const oktett::Picture again = oktett::render(read).picture;
  for (std::size_t i = 0; i < red->values.size(); ++i)
    expect(red->values[i] == again.find("R")->values[i], "a scene of a file renders as one put together");

  oktett::write_image(folder + "/ball.exr", picture);
  expect(oktett::read_image(folder + "/ball.exr").find("R")->values.size() == red->values.size(),
         "a picture is read as it was written");

  std::ofstream(folder + "/triangle.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const oktett::ObjFile obj = oktett::load_obj(folder + "/triangle.obj");
  expect(obj.mesh.triangle_count() == 1 && obj.warnings.empty(), "an OBJ file of one triangle");
  try {
    oktett::load_obj(folder + "/missing.obj");
    expect(false, "a file that is not there is an error");
  } catch (const oktett::Error& e) {
    expect(e.kind() == oktett::ErrorKind::io, "of input");
  }
}

}  // namespace

int main(int count, char** arguments) {
  expect(count == 2, "expected a folder to write to");
  check_batches(make_square());
  check_shapes();
  check_instances();
  check_pictures(arguments[1]);
}
