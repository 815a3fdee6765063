/// \file Pictures in progress: what is rendered in parts has the bits of what is rendered at once.

#include "render/film/film_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <set>
#include <thread>

#include "core/error.h"
#include "tests/render/test_scenes.h"

namespace oktett::film_state_test {
namespace {

using namespace test;

/// Two balls, one of which is a mirror, on a floor; many tiles at a crop that cuts tiles.
Scene balls(IntegratorKind kind, std::uint32_t samples) {
  Scene scene = bare_scene(72);
  scene.film.height = 56;
  scene.film.crop[0] = 0.1;
  scene.integrator.kind = kind;
  scene.integrator.samples = samples, scene.integrator.depth = 3;
  scene.camera.from = {0, 2, 6};
  scene.lights = {PointLight{{3, 5, 4}, {1, 1, 1}}, DirectionalLight{{-1, -1, -1}, {0.3f, 0.3f, 0.5f}, 4}};
  add_object(scene, SphereShape{{-1, 0, 0}, 1}, add_material(scene, mirror()));
  add_object(scene, SphereShape{{1.2, 0, 0}, 1}, add_material(scene, diffuse({0.8f, 0.2f, 0.1f})));
  scene.objects.back().name = "red ball";
  add_object(scene, BoxShape{{-4, -2, -4}, {4, -1, 4}}, add_material(scene, diffuse({0.5f, 0.6f, 0.5f})));
  return scene;
}

struct Case {
  std::string name;
  Scene scene;
  bool layers = true;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"whitted", balls(IntegratorKind::whitted, 4)});
  all.push_back({"one sample", balls(IntegratorKind::whitted, 1), false});
  all.push_back({"colours only", balls(IntegratorKind::path, 3), false});
  all.push_back({"ambient occlusion", balls(IntegratorKind::ao, 2)});
  all.push_back({"path", balls(IntegratorKind::path, 4)});
  all.back().scene.background = {0.1f, 0.2f, 0.3f};
  all.push_back({"adaptive", balls(IntegratorKind::path, 4)});
  all.back().scene.integrator.error = 0.05, all.back().scene.integrator.max_samples = 24;
  all.push_back({"photons", balls(IntegratorKind::path, 4)});
  all.back().scene.integrator.caustics.photons = 2000, all.back().scene.integrator.caustics.passes = 3;
  all.push_back({"mattes", balls(IntegratorKind::whitted, 4)});
  all.back().scene.film.cryptomatte = true;
  all.push_back({"light groups", balls(IntegratorKind::path, 4)});
  all.back().scene.light_traits = {{.group = "key"}, {.group = "sun"}};
  all.push_back({"adaptive light groups", all.back().scene});
  all.back().scene.integrator.error = 0.05, all.back().scene.integrator.max_samples = 24;
  all.push_back({"catcher", balls(IntegratorKind::path, 8)});
  all.back().scene.objects.back().shadow_catcher = true;
  all.push_back({"motion", balls(IntegratorKind::path, 8)});
  Object& ball = all.back().scene.objects.front();
  ball.motion =
      std::make_shared<const Motion>(Motion{{{{0, Affine{}}, {1, Affine::translation({0, 0.5, 0})}}}});
  return all;
}

Picture rendered(const Case& c, FilmState* film = nullptr, std::uint32_t tile_size = 32) {
  return run(c.scene,
             [&](RenderOptions& options) {
               options.data_layers = c.layers, options.film = film, options.tile_size = tile_size;
             })
      .picture;
}

/// The first plane in which two pictures differ by a bit; empty: none.
std::string difference(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height || a.planes.size() != b.planes.size()) return "the format";
  if (a.attributes != b.attributes) return "the attributes";
  for (std::size_t k = 0; k < a.planes.size(); ++k) {
    const PicturePlane &p = a.planes[k], &q = b.planes[k];
    if (p.name != q.name) return "the name of " + p.name;
    const auto same = [](float x, float y) { return std::bit_cast<int>(x) == std::bit_cast<int>(y); };
    if (!std::equal(p.values.begin(), p.values.end(), q.values.begin(), q.values.end(), same)) return p.name;
    if (!std::equal(p.ids.begin(), p.ids.end(), q.ids.begin(), q.ids.end())) return p.name;
  }
  return "";
}

TEST(FilmState, FilmsDoNotChangePictures) {
  for (const Case& c : cases()) {
    FilmState film(FilmShare{});
    EXPECT_EQ(difference(rendered(c), rendered(c, &film)), "") << c.name;
    EXPECT_EQ(film.tiles_finished(), film.tiles_wanted()) << c.name;
  }
}

TEST(FilmState, PicturesGoOnFromAnyTiles) {
  std::mt19937 random(1);
  for (const Case& c : cases()) {
    const Picture whole = rendered(c);
    FilmState film(FilmShare{});
    rendered(c, &film);
    for (const unsigned percent : {0u, 30u, 70u, 100u}) {
      FilmState begun(FilmShare{});
      begun.begin(film.plan(), film.tone());
      for (const auto& [number, record] : film.records())
        if (random() % 100 < percent) begun.set_record(number, *record);
      EXPECT_EQ(difference(whole, rendered(c, &begun)), "") << c.name << " from " << percent << " %";
    }
  }
}

TEST(FilmState, SharesInAnyOrderMakeThePicture) {
  std::mt19937 random(2);
  for (const Case& c : cases()) {
    const Picture whole = rendered(c);
    std::vector<std::unique_ptr<FilmState>> shares;
    for (std::uint32_t k = 1; k <= 7; ++k) {
      shares.push_back(std::make_unique<FilmState>(FilmShare{k, 7}));
      rendered(c, shares.back().get());
    }
    std::shuffle(shares.begin(), shares.end(), random);
    Picture merged = make_picture(shares.front()->plan(), {});
    for (const auto& share : shares) write_tiles(*share, merged);
    EXPECT_EQ(difference(whole, merged), "") << c.name;
  }
}

/// Samples that are added later have the bits of samples that are asked for at once.
TEST(FilmState, SamplesAreAddedOneByOneOrTogether) {
  for (const Case& c : cases()) {
    const std::uint32_t step = c.scene.integrator.samples;
    FilmState at_once(FilmShare{}, 2 * step), later(FilmShare{});
    const Picture together = rendered(c, &at_once);
    const Picture first = rendered(c, &later);
    later.add_samples(step);
    rendered(c, &later);
    later.add_samples(step);
    const Picture last = rendered(c, &later);
    EXPECT_EQ(difference(together, last), "") << c.name;
    // Noise and edges change.
    EXPECT_NE(difference(first, last), "") << c.name;
  }
}

/// Without textures, adaptive sampling and motion nothing depends on how many samples were asked for first.
TEST(FilmState, AddedSamplesAreThoseOfALongerRender) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Case few{"few", balls(kind, 3)}, many{"many", balls(kind, 8)};
    many.scene.integrator.samples = 8;
    FilmState film(FilmShare{}, 5);
    EXPECT_EQ(difference(rendered(few, &film), rendered(many)), "");
  }
}

/// Added samples ask the passes of photons that they would ask in a longer render.
TEST(FilmState, AddedSamplesAskFurtherPhotons) {
  Case few{"few", balls(IntegratorKind::path, 3)};
  add_object(few.scene, SphereShape{{0, 0, 2}, 0.5}, add_material(few.scene, glass(1.5f)));
  few.scene.integrator.caustics.photons = 300, few.scene.integrator.caustics.radius = 0.2;
  Case many = few;
  many.scene.integrator.samples = 8;
  FilmState film(FilmShare{}, 5);
  const Picture longer = rendered(many);
  EXPECT_EQ(difference(rendered(few, &film), longer), "");
  many.scene.integrator.caustics.passes = 1;
  EXPECT_NE(difference(rendered(many), longer), "") << "there are caustics";
}

TEST(FilmState, WhatMovesGetsWholeRoundsOfSamples) {
  const Case moving = cases().back();
  FilmState film(FilmShare{}, 3);
  EXPECT_THROW(rendered(moving, &film), Error);
  FilmState other(FilmShare{});
  rendered(moving, &other);
  EXPECT_THROW(other.add_samples(12), Error);
  EXPECT_THROW(other.add_samples(0xffffffff), Error);
  other.add_samples(16);
}

// 32 pixels if those make four tiles for each share, else 16, and if those do not either, 8.
TEST(FilmState, TilesAreAsLargeAsSharesAllow) {
  struct Row {
    std::uint32_t width, height, shares, size;
  };
  const Row rows[] = {{64, 64, 1, 32},     {1920, 1080, 1, 32}, {128, 64, 2, 32},   {97, 33, 2, 32},
                      {96, 64, 2, 16},     {64, 32, 2, 16},     {48, 32, 2, 8},     {33, 32, 2, 8},
                      {8, 8, 2, 8},        {1, 1, 2, 8},        {128, 96, 3, 32},   {128, 65, 3, 32},
                      {128, 64, 3, 16},    {64, 48, 3, 16},     {64, 32, 3, 8},     {640, 640, 100, 32},
                      {640, 608, 100, 16}, {320, 320, 100, 16}, {320, 304, 100, 8}, {1920, 1080, 1000, 16}};
  for (const Row& row : rows) {
    FilmFormat format;
    format.window = {3, 5, 3 + row.width, 5 + row.height};
    EXPECT_EQ(tile_size_of(format, row.shares), row.size)
        << row.width << " x " << row.height << ", " << row.shares << " shares";
  }
}

TEST(FilmState, EachTileIsOfOneShare) {
  for (const std::uint32_t count : {1u, 2u, 7u, 8u, 9u, 100u}) {
    std::multiset<std::size_t> seen;
    std::size_t least = ~std::size_t{0}, most = 0, tiles = 0;
    for (std::uint32_t k = 1; k <= count; ++k) {
      FilmState film(FilmShare{k, count});
      FilmPlan plan;
      plan.format.window = {3, 5, 3 + 250, 5 + 130};
      film.begin(plan, {});
      tiles = film.tile_count();
      std::size_t own = 0;
      for (std::size_t i = 0; i < tiles; ++i)
        if (film.in_share(i)) seen.insert(i), ++own;
      EXPECT_EQ(own, film.tiles_wanted());
      least = std::min(least, own), most = std::max(most, own);
    }
    EXPECT_EQ(seen.size(), tiles) << count;
    EXPECT_EQ(std::set<std::size_t>(seen.begin(), seen.end()).size(), tiles) << count;
    EXPECT_LE(most - least, 1u) << count;
    EXPECT_TRUE(count == 1 || tiles >= 4 * count) << count;
  }
}

// A film that is gone on with is saved by one thread while another begins to render it, with a tone of its
// own.
TEST(FilmState, HasOneToneOrTheOtherWhileItBegins) {
  const FilmPlan plan;
  const Tone a{ToneKind::srgb, -1}, b{ToneKind::aces, 2};
  FilmState film(FilmShare{});
  film.begin(plan, a);
  std::thread begins([&] {
    for (int i = 0; i < 20000; ++i) film.begin(plan, i % 2 == 0 ? b : a);
  });
  for (int i = 0; i < 20000; ++i) {
    const Tone tone = film.tone();
    EXPECT_TRUE(tone == a || tone == b);
  }
  begins.join();
  EXPECT_EQ(film.tone(), a);
}

TEST(FilmState, AnotherPlanIsRefused) {
  Case c = cases().front();
  FilmState film(FilmShare{});
  rendered(c, &film);
  c.scene.film.width += 1;
  EXPECT_THROW(rendered(c, &film), Error);
}

TEST(TileSums, BytesGiveBackAllSums) {
  for (const Case& c : cases()) {
    FilmState film(FilmShare{});
    rendered(c, &film);
    const FilmFormat& format = film.plan().format;
    for (const auto& [number, record] : film.records()) {
      const FinishedTile tile = film.tile(number);
      const std::size_t pixels = std::size_t{tile.width} * tile.height;
      EXPECT_EQ(encode_tile(format, decode_tile(format, pixels, record->bytes)), record->bytes) << c.name;
    }
  }
}

/// Bytes that lie are refused or give sums; they never break anything.
TEST(TileSums, DamagedBytesAreSafe) {
  std::mt19937 random(3);
  for (const Case& c : cases()) {
    FilmState film(FilmShare{});
    rendered(c, &film);
    const FilmFormat& format = film.plan().format;
    const std::size_t number = film.tile_count() - 1;
    const FinishedTile tile = film.tile(number);
    const std::size_t pixels = std::size_t{tile.width} * tile.height;
    const std::string bytes = film.record(number)->bytes;
    EXPECT_THROW(decode_tile(format, pixels, bytes + '\0'), Error);
    Picture picture = make_picture(film.plan(), {});
    for (int i = 0; i < 300; ++i) {
      std::string damaged = bytes;
      if (i % 3 == 0) {
        damaged.resize(random() % bytes.size());
        EXPECT_THROW(decode_tile(format, pixels, damaged), Error);
        continue;
      }
      for (unsigned k = random() % 4; k + 1 > 0; --k)
        damaged[random() % (i % 2 == 0 ? 40 : bytes.size())] ^= static_cast<char>(1 + random() % 255);
      try {
        write_tile(format, tile, decode_tile(format, pixels, damaged), picture);
      } catch (const Error&) {}
    }
  }
}

}  // namespace
}  // namespace oktett::film_state_test
