// What the viewer says of a pixel, compared bit by bit with what the library says of the same ray.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <set>
#include <string>

#include "io/scene/scene_file.h"
#include "render/camera.h"
#include "render/hit_object.h"
#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::view_pick_test {
namespace {

using test::CommandProcess;
using test::TempDir;

/// The body of the answer to a GET request; empty if there is none.
std::string get(int port, const std::string& path) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    const std::string request = "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                                "\r\nConnection: close\r\n\r\n";
    send(socket, request.data(), request.size(), MSG_NOSIGNAL);
    char bytes[4096];
    for (ssize_t n; (n = recv(socket, bytes, sizeof bytes, 0)) > 0;)
      answer.append(bytes, static_cast<std::size_t>(n));
  }
  close(socket);
  const std::size_t end = answer.find("\r\n\r\n");
  return answer.starts_with("HTTP/1.1 200") && end != std::string::npos ? answer.substr(end + 4) : "";
}

/// The members of one JSON object whose values are numbers, words and lists of numbers, as they are written.
std::map<std::string, std::string> members(const std::string& json) {
  std::map<std::string, std::string> all;
  for (std::size_t at = json.find('"'); at != std::string::npos;) {
    const std::size_t name_end = json.find('"', at + 1), value = name_end + 3;
    const std::size_t last = json[value] == '[' ? json.find(']', value) + 1 : json.find_first_of(",}", value);
    all[json.substr(at + 1, name_end - at - 1)] = json.substr(value, last - value);
    at = json.find('"', last);
  }
  return all;
}

/// The float that `text` begins with.
std::uint32_t bits_of(const char* first, const char* last, const char** rest = nullptr) {
  float value = NAN;
  const auto [end, error] = std::from_chars(first, last, value);
  if (rest != nullptr) *rest = end;
  return error == std::errc{} ? std::bit_cast<std::uint32_t>(value) : kNoId;
}

void expect_bits(const std::string& text, float expected, const char* what) {
  EXPECT_EQ(bits_of(text.data(), text.data() + text.size()), std::bit_cast<std::uint32_t>(expected))
      << what << " " << text << " is not " << expected;
}

void expect_bits(const std::string& text, const Vec3f& expected, const char* what) {
  const char *at = text.data() + 1, *end = text.data() + text.size();
  for (int k = 0; k < 3; ++k, at += 2)
    EXPECT_EQ(bits_of(at, end, &at), std::bit_cast<std::uint32_t>(expected[k])) << what << " " << text;
}

/// What an object of the scene files below is said to be, by its material.
struct Thing {
  std::string surface, name;
};

/// A running viewer, and what it answers.
struct Viewer {
  explicit Viewer(const TempDir& dir, const std::string& file)
      : process(dir, {"view", file, "--no-open"}), runs(process.wait_for_err("Ctrl-C", 30)) {
    if (!runs) return;
    const std::string text = process.err(), begin = "http://127.0.0.1:";
    const std::size_t port_at = text.find(begin) + begin.size();
    port = std::stoi(text.substr(port_at));
    path = text.substr(text.find('/', port_at), 34);
  }
  std::string answer(const std::string& request) const { return get(port, path + request); }

  CommandProcess process;
  const bool runs;
  int port = 0;
  std::string path;
};

/// Asks the viewer for `count` pixels at random, and the library for the rays through their centres, with the
/// narrowest instruction set. Returns the materials of what was hit.
std::set<std::string> compare_picks(const std::string& file, const std::map<std::string, Thing>& things,
                                    int count) {
  const TempDir dir;
  Viewer viewer(dir, file);
  if (!viewer.runs) return {viewer.process.err()};
  const Scene scene = load_scene_file(file);
  const World world = build_world(scene);
  const CameraFrame frame = camera_frame(scene.camera, scene.film);
  std::set<std::string> seen;
  std::mt19937 random(5);
  for (int k = 0; k < count; ++k) {
    const auto x = static_cast<std::uint32_t>(random() % scene.film.width),
               y = static_cast<std::uint32_t>(random() % scene.film.height);
    SCOPED_TRACE("pixel " + std::to_string(x) + ", " + std::to_string(y));
    auto pick = members(viewer.answer("pick?x=" + std::to_string(x) + "&y=" + std::to_string(y)));
    const Ray ray = camera_ray(frame, x + 0.5, y + 0.5);
    expect_bits(pick["origin"], ray.origin, "origin");
    expect_bits(pick["direction"], ray.direction, "direction");
    const Hit hit = closest_hit(*world.accel, ray, Isa::scalar);
    EXPECT_EQ(pick["hit"], hit.valid() ? "true" : "false");
    if (!hit.valid()) {
      seen.insert("nothing");
      continue;
    }
    const SurfaceInteraction s = surface_interaction(*world.accel, ray, hit);
    expect_bits(pick["t"], hit.t, "t");
    expect_bits(pick["u"], hit.u, "u");
    expect_bits(pick["v"], hit.v, "v");
    expect_bits(pick["point"], s.position, "point");
    expect_bits(pick["normal"], s.geometric_normal, "normal");
    expect_bits(pick["shading_normal"], s.shading_normal, "shading normal");
    EXPECT_EQ(pick["object"], std::to_string(s.user));
    EXPECT_EQ(pick["primitive"], std::to_string(s.primitive));
    EXPECT_EQ(pick["instance"], std::to_string(hit.instance));
    EXPECT_EQ(pick["item"], std::to_string(hit.item));
    const std::string material = material_at(world, s).name;
    seen.insert(material);
    const auto thing = things.find(material);
    if (thing == things.end()) {
      ADD_FAILURE() << "unexpected material " << material;
      continue;
    }
    EXPECT_EQ(pick["material"], '"' + material + '"');
    EXPECT_EQ(pick["object_name"], '"' + thing->second.name + '"') << material;
    EXPECT_EQ(pick["surface"], '"' + thing->second.surface + '"') << material;
  }
  viewer.process.send(SIGTERM);
  EXPECT_EQ(viewer.process.wait(), 0);
  return seen;
}

bool has_viewer() {
  const TempDir dir;
  return !test::contains(test::run_command(dir, {"view", "none.yaml", "--no-open"}).err, "no viewer");
}

/// A hilly square of 2 x 12 x 12 triangles over [-1, 1]^2, with a normal at each corner.
std::string hills() {
  constexpr int kEdge = 12;
  std::string text;
  for (int j = 0; j <= kEdge; ++j)
    for (int i = 0; i <= kEdge; ++i) {
      const double x = 2.0 * i / kEdge - 1, z = 2.0 * j / kEdge - 1;
      text += "v " + std::to_string(x) + " " + std::to_string(0.2 * std::sin(5 * x) * std::cos(4 * z)) + " " +
              std::to_string(z) + "\nvn " + std::to_string(-std::cos(5 * x)) + " 1 0\n";
    }
  for (int j = 0; j < kEdge; ++j)
    for (int i = 0; i < kEdge; ++i) {
      const auto corner = [](int a) { return std::to_string(a) + "//" + std::to_string(a) + " "; };
      const int a = j * (kEdge + 1) + i + 1, b = a + kEdge + 1;
      text += "f " + corner(a) + corner(b) + corner(a + 1) + "\nf " + corner(a + 1) + corner(b) +
              corner(b + 1) + "\n";
    }
  return text;
}

/// A scene far from the origin counts from another place; who copies its camera or notes a point does not.
TEST(ViewPick, FarPlacesAndCamerasAreThoseOfTheFile) {
  if (!has_viewer()) GTEST_SKIP() << "built without a viewer";
  const TempDir dir;
  dir.write("a.obj", "v 432100 5411000 300\nv 432108 5411000 300\nv 432100 5411008 300\nf 1 2 3\n");
  Viewer viewer(dir,
                dir.write("a.yaml",
                          "oktett: 1\nfilm: {width: 8, height: 8}\n"
                          "camera: {from: [432101.25, 5411001.5, 305], at: [432101.25, 5411001.5, 300]}\n"
                          "objects: [{mesh: {file: a.obj}}]\n"));
  ASSERT_TRUE(viewer.runs) << viewer.process.err();
  EXPECT_TRUE(viewer.answer("camera").starts_with(
      "camera:\n  from: [432101.25, 5411001.5, 305]\n  at: [432101.25, 5411001.5, 300]\n"))
      << viewer.answer("camera");
  auto pick = members(viewer.answer("pick?x=4&y=4"));
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(pick["place"].c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3) << pick["place"];
  // Half a pixel beside the middle.
  EXPECT_NEAR(x, 432101.25, 0.5);
  EXPECT_NEAR(y, 5411001.5, 0.5);
  EXPECT_NEAR(z, 300, 1e-5);
  viewer.process.send(SIGTERM);
  EXPECT_EQ(viewer.process.wait(), 0);
}

/// Where the viewer looks at meshes, its answers have the bits of closest_hit and surface_interaction.
TEST(ViewPick, GivesTheBitsOfTheLibraryForMeshes) {
  if (!has_viewer()) GTEST_SKIP() << "this build has no viewer";
  const TempDir dir;
  dir.write("hills.obj", hills());
  const std::string file = dir.write("scene.yaml",
                                     "oktett: 1\n"
                                     "camera: {from: [1, 2.5, 3.5], at: [0, 0, 0], fov: 45}\n"
                                     "film: {width: 101, height: 67}\n"
                                     "integrator: {kind: whitted, samples: 1}\n"
                                     "materials: {grass: {color: [0.2, 0.6, 0.2]}, sand: {}}\n"
                                     "define: {hill: {mesh: {file: hills.obj}, material: sand}}\n"
                                     "objects:\n"
                                     "  - {mesh: {file: hills.obj}, material: grass, name: land}\n"
                                     "  - {instance: hill, transform: [{scale: 0.5}, "
                                     "{rotate: [10, 30, 20]}, {translate: [-1, 0.9, 0.3]}]}\n");
  const std::map<std::string, Thing> things{{"grass", {"mesh", "land"}}, {"sand", {"mesh", ""}}};
  EXPECT_EQ(compare_picks(file, things, 200), (std::set<std::string>{"nothing", "grass", "sand"}));
}

/// The same for surfaces by equations, combinations and instances.
TEST(ViewPick, GivesTheBitsOfTheLibraryForExactSurfaces) {
  if (!has_viewer()) GTEST_SKIP() << "this build has no viewer";
  const TempDir dir;
  const std::string file = dir.write(
      "scene.yaml",
      "oktett: 1\n"
      "camera: {from: [0.3, 2.1, 6], at: [0, 0.4, 0], fov: 38}\n"
      "film: {width: 97, height: 61}\n"
      "integrator: {kind: whitted, samples: 1}\n"
      "materials: {red: {}, gold: {}, tin: {}, copper: {}, grey: {}, blue: {}, green: {}}\n"
      "define:\n"
      "  pair:\n"
      "    group:\n"
      "      - {torus: {major: 0.5, minor: 0.2}, material: blue}\n"
      "      - {sphere: {center: [0, 0, 0], radius: 0.3}, material: green}\n"
      "objects:\n"
      "  - {disk: {center: [0, -0.8, 0], normal: [0, 1, 0], radius: 4}, material: grey, name: floor}\n"
      "  - {sphere: {center: [1.7, 0, 0], radius: 0.7}, material: red, name: ball}\n"
      "  - difference:\n"
      "      - intersection:\n"
      "          - {box: {min: [-0.75, -0.75, -0.75], max: [0.75, 0.75, 0.75]}, material: gold}\n"
      "          - {sphere: , material: tin}\n"
      "      - {cylinder: {radius: 0.4}, material: copper, name: bore}\n"
      "    name: cut\n"
      "  - {instance: pair, material: blue, name: rings, transform: [{rotate: [50, 0, 20]}, {translate: "
      "[-1.7, "
      "0.3, 0.4]}]}\n");
  const std::map<std::string, Thing> things{
      {"grey", {"disk", "floor"}}, {"red", {"sphere", "ball"}},      {"gold", {"box", "cut"}},
      {"tin", {"sphere", "cut"}},  {"copper", {"cylinder", "bore"}}, {"blue", {"instance", "rings"}}};
  EXPECT_EQ(compare_picks(file, things, 200),
            (std::set<std::string>{"nothing", "grey", "red", "gold", "tin", "copper", "blue"}));
}

}  // namespace
}  // namespace oktett::view_pick_test
