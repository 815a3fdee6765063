/// \file Scene files of findings: shapes are read back as they were written, and findings are found again.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "io/scene/scene_file.h"
#include "io/scene/write_scene.h"
#include "render/geometry.h"
#include "tests/support/temp_dir.h"
#include "verify/checks/compare_mode.h"
#include "verify/checks/findings.h"
#include "verify/oracles/known_shapes.h"

namespace oktett::findings_test {
namespace {

using test::TempDir;

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

HitBatch hits(const Scene& scene, const RayBatch& rays) {
  HitBatch out;
  out.resize_uninitialized(rays.size());
  closest_hit(*build_world(scene).accel, rays.span(), out.span());
  return out;
}

/// Writes and reads a scene: its rays must have the same hits, and writing it again must give the same text.
void expect_round_trip(const Scene& scene, std::uint64_t number) {
  const TempDir dir;
  const std::string path = dir.file("a.yaml"), again = dir.file("b.yaml");
  write_scene_file(path, scene, "two\nlines");
  const Scene back = load_scene_file(path);
  // Random scenes may lie far away, which is told.
  for (const Warning& w : back.warnings)
    if (w.message.find("details are lost") == std::string::npos) ADD_FAILURE() << to_string(w);
  ASSERT_EQ(back.objects.size(), scene.objects.size());
  std::filesystem::create_directory(dir.path() / "again");
  write_scene_file(dir.file("again/a.yaml"), back, "two\nlines");
  EXPECT_EQ(content(path), content(dir.file("again/a.yaml")));
  EXPECT_TRUE(content(path).starts_with("# two\n# lines\noktett: 1\n"));
  const RayBatch rays = draw_rays(scene, number);
  const HitBatch expected = hits(scene, rays), found = hits(back, rays);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_TRUE(same_bits(expected[i], found[i])) << content(path) << exact_text(rays[i]);
}

class WriteScene : public testing::TestWithParam<std::size_t> {};

TEST_P(WriteScene, ShapesOfEveryKindAreReadBack) {
  for (std::uint64_t number = 0; number < 4; ++number) {
    SCOPED_TRACE(known_name(GetParam(), number));
    Scene scene;
    Object& object = scene.objects.emplace_back();
    object.shape = draw_known_shape(GetParam(), number).shape;
    object.name = known_name(GetParam(), number);
    object.transform = Affine::translation({0.1, 0.2, 0.3}) * Affine::rotation({10, 20, 30});
    if (auto* exact = std::get_if<ExactShape>(&object.shape)) exact->normals = NormalMethod::central;
    expect_round_trip(scene, number);
    if (HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, WriteScene, testing::Range(std::size_t{0}, known_kinds().size()),
                         [](const auto& kind) { return known_kinds()[kind.param]; });

TEST(WriteSceneFile, WholeScenesAreReadBack) {
  for (std::uint64_t number = 0; number < 20; ++number) {
    SCOPED_TRACE(number);
    expect_round_trip(draw_scene(number), number);
  }
}

/// The normals of differences are another choice; it is written, too.
TEST(WriteSceneFile, ChoicesAreWritten) {
  const TempDir dir;
  Scene scene;
  ExactShape torus{TorusShape{}, NormalMethod::forward};
  scene.objects.emplace_back().shape = torus;
  write_scene_file(dir.file("a.yaml"), scene);
  EXPECT_NE(content(dir.file("a.yaml")).find("torus: {major: 0.7, minor: 0.3, normals: forward}"),
            std::string::npos)
      << content(dir.file("a.yaml"));
}

TEST(WriteSceneFile, FilesThatCannotBeWrittenAreErrors) {
  try {
    write_scene_file("/proc/nowhere/a.yaml", {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::io);
    EXPECT_NE(std::string(e.what()).find("cannot be written"), std::string::npos);
  }
}

/// A scene among whose objects one claims to be another shape than it is.
Finding lie() {
  Finding finding{"a lie", "scene 3", draw_scene(3), {}};
  Object& object = finding.scene.objects.emplace_back();
  object.shape = SphereShape{{0, 0, 0}, 1.001};
  object.name = "box.7";
  // The random scene may be so large that no ray through all of it meets the object.
  Scene alone;
  alone.objects.push_back(object);
  finding.rays = draw_rays(alone, 3);
  return finding;
}

TEST(Findings, AreMinimizedSavedAndFoundAgain) {
  const TempDir dir;
  Finding finding = lie();
  ASSERT_TRUE(minimize(finding, available_isas(), 500));  // until there is nothing left to leave out
  ASSERT_EQ(finding.scene.objects.size(), 1u);
  EXPECT_EQ(finding.scene.objects[0].name, "box.7");
  EXPECT_EQ(finding.rays.size(), 1u);
  EXPECT_TRUE(finding.scene.prototypes.empty());
  const std::string path = dir.file("finding.yaml");
  save_finding(path, finding);
  const Finding back = load_finding(path);
  EXPECT_EQ(back.what, finding.what);
  EXPECT_EQ(back.repeat, "scene 3");
  ASSERT_EQ(back.rays.size(), 1u);
  EXPECT_EQ(exact_text(back.rays[0]), exact_text(finding.rays[0]));
  const std::vector<std::string> wrong = replay(back, available_isas());
  ASSERT_EQ(wrong.size(), 1u) << "scene 3 itself is right";
  EXPECT_EQ(wrong[0], "this scene: " + finding.what);
}

TEST(Findings, WhatIsRightIsNotMinimized) {
  Finding finding{"", "scene 3", draw_scene(3), {}};
  finding.rays = draw_rays(finding.scene, 3);
  const std::size_t rays = finding.rays.size();
  EXPECT_FALSE(minimize(finding, available_isas()));
  EXPECT_EQ(finding.rays.size(), rays);
}

/// Every check can be named in a file and is run again.
TEST(Findings, EveryCheckIsRepeated) {
  for (const char* check : {"kernel sphere_geometric far 123456789", "surface torus 77", "combination 12",
                            "changes 12", "scene 5", "mesh cube 1 100 64"}) {
    Finding finding{"", check, {}, {}};
    EXPECT_TRUE(replay(finding, available_isas()).empty()) << check;
  }
  for (const char* check : {"", "kernel torus far 1", "surface nothing 7", "mesh cube 99 1 1", "scene x"})
    EXPECT_THROW(replay({"", check, {}, {}}, available_isas()), Error) << check;
}

/// What a kernel's pair was is in the scene.
TEST(Findings, KernelsGiveScenes) {
  for (int k = 0; k < kKernels; ++k) {
    const auto id = static_cast<KernelId>(k);
    KernelTally tally;
    KernelCases cases;
    cases.fill(id, CaseClass::random, 40, 1);
    tally.fail(40, "wrong: " + exact_text(cases.rays[0]));
    const Finding finding = finding_of(id, CaseClass::random, tally);
    ASSERT_EQ(finding.rays.size(), 1u);
    EXPECT_EQ(exact_text(finding.rays[0]), exact_text(cases.rays[0]));
    EXPECT_EQ(finding.scene.objects.size(), id == KernelId::slab ? 0u : 1u);
    EXPECT_TRUE(replay(finding, available_isas()).empty()) << to_string(id);
  }
}

}  // namespace
}  // namespace oktett::findings_test
