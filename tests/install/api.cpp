// The names and signatures of the public interface, as the documents state them: this compiles, or the
// interface has changed.
#include <oktett/oktett.h>
#include <concepts>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace oktett {

/// Asserts that `function` has an overload of exactly this type.
template <class Signature>
constexpr bool has(Signature*) {
  return true;
}

using Bytes = std::span<std::uint8_t>;

// Building.
static_assert(has<std::shared_ptr<const Accel>(std::vector<Geometry>, const BuildOptions&)>(build_accel));
static_assert(has<AccelStats(const Accel&)>(stats));
static_assert(has<Box(const Accel&)>(bounds));

// Queries.
static_assert(has<void(const Accel&, const RaySpan&, const HitSpan&, Isa)>(closest_hit));
static_assert(has<void(const Accel&, std::span<const Ray>, std::span<Hit>, Isa)>(closest_hit));
static_assert(has<Hit(const Accel&, const Ray&, Isa)>(closest_hit));
static_assert(has<void(const Accel&, const RaySpan&, Bytes, Isa)>(any_hit));
static_assert(has<void(const Accel&, std::span<const Ray>, Bytes, Isa)>(any_hit));
static_assert(has<bool(const Accel&, const Ray&, Isa)>(any_hit));
static_assert(has<void(const Accel&, const Ray&, std::vector<Hit>&, Isa)>(all_hits));
static_assert(has<void(const Accel&, const RaySpan&, HitLists&, Isa)>(all_hits));
static_assert(has<void(const Accel&, std::span<const Ray>, HitLists&, Isa)>(all_hits));
static_assert(has<void(const Accel&, const RaySpan&, std::span<std::uint32_t>, Isa)>(count_hits));
static_assert(has<void(const Accel&, std::span<const Ray>, std::span<std::uint32_t>, Isa)>(count_hits));
static_assert(has<ClosestPoint(const Accel&, const Vec3f&, Isa)>(closest_point));
static_assert(has<void(const Accel&, const PointSpan&, const ClosestPointSpan&, Isa)>(closest_point));
static_assert(has<void(const Accel&, std::span<const Vec3f>, std::span<ClosestPoint>, Isa)>(closest_point));
static_assert(has<bool(const Accel&, const Vec3f&, Isa)>(inside));
static_assert(has<void(const Accel&, const PointSpan&, Bytes, Isa)>(inside));
static_assert(has<void(const Accel&, std::span<const Vec3f>, Bytes, Isa)>(inside));
static_assert(has<float(const Accel&, const Vec3f&, Isa)>(signed_distance));
static_assert(has<void(const Accel&, const PointSpan&, std::span<float>, Isa)>(signed_distance));
static_assert(has<void(const Accel&, std::span<const Vec3f>, std::span<float>, Isa)>(signed_distance));
static_assert(has<SurfaceInteraction(const Accel&, const Ray&, const Hit&)>(surface_interaction));
static_assert(has<SurfaceInteraction(const Accel&, const Hit&)>(identify));
static_assert(has<void(const Accel&, const RaySpan&, const HitSpan&, std::span<const std::uint32_t>,
                       InteractionBlock&, Isa)>(surface_interactions));
static_assert(has<void(const Accel&, const RaySpan&, const HitSpan&, std::span<const std::uint32_t>,
                       InteractionBlock&, Isa, bool)>(surface_interactions));
static_assert(has<Vec3f(const SurfaceInteraction&, const Vec3f&)>(offset_origin));

// The instruction set need not be named, and batches are passed as they are.
template <class... Arguments>
concept AsksClosest = requires(Arguments&... a) {
  closest_hit(a...);
};
template <class... Arguments>
concept AsksAny = requires(Arguments&... a) {
  any_hit(a...);
};
static_assert(AsksClosest<const Accel, const RayBatch, HitBatch> && AsksClosest<const Accel, const Ray>);
static_assert(AsksClosest<const Accel, const std::vector<Ray>, std::vector<Hit>>);
static_assert(AsksAny<const Accel, const RayBatch, std::vector<std::uint8_t>> && AsksAny<const Accel, Ray>);
static_assert(AsksAny<const Accel, const std::vector<Ray>, Column<std::uint8_t>>);
static_assert(requires(const Accel& a, const RayBatch& r, HitBatch& h, InteractionBlock& b,
                       std::vector<Hit>& l) {
  all_hits(a, Ray{}, l);
  surface_interactions(a, r, h, std::vector<std::uint32_t>{}, b);
});

// Data.
template <class Shape>
concept IsGeometry = requires(Geometry g) {
  std::get<Shape>(g.shape);
};
static_assert(IsGeometry<MeshGeometry> && IsGeometry<SpheresShape> && IsGeometry<PlaneShape>);
static_assert(IsGeometry<DiskShape> && IsGeometry<BoxShape> && IsGeometry<PolygonShape>);
static_assert(IsGeometry<ExactShape> && IsGeometry<CsgGeometry>);
static_assert(IsGeometry<InstanceGeometry> && IsGeometry<InstanceList>);
template <class Form>
concept IsExact = requires(ExactShape s) {
  std::get<Form>(s.form);
};
static_assert(IsExact<TorusShape> && IsExact<CylinderShape> && IsExact<ConeShape>);
static_assert(IsExact<PolyhedronShape> && IsExact<QuadricShape> && IsExact<PolynomialShape>);
static_assert(IsExact<BlobShape> && IsExact<RevolutionShape> && IsExact<LatheShape>);
static_assert(IsExact<SuperquadricShape> && IsExact<MetaballsShape> && IsExact<BlobTreeShape>);
static_assert(IsExact<ImplicitShape> && IsExact<SphereflakeShape> && IsExact<MengerShape>);
static_assert(IsExact<IfsShape> && IsExact<JuliaShape> && IsExact<TerrainShape>);
static_assert(IsExact<HeightFieldShape> && IsExact<PrismShape> && IsExact<SphereSweepShape>);
static_assert(IsExact<BezierPatchShape> && IsExact<ParametricShape>);
static_assert(std::same_as<decltype(Ray::origin), Vec3f> && std::same_as<decltype(Ray::tmax), float>);
static_assert(std::same_as<decltype(Hit::item), std::uint32_t> && sizeof(Hit) == 20 && sizeof(Ray) == 32);
static_assert(std::same_as<decltype(SurfaceInteraction::user), std::uint32_t>);
static_assert(sizeof(InstancePlace) == 56);
static_assert(has<FunctionTape(std::string_view, std::span<const std::string_view>)>(compile_function));
static_assert(has<std::vector<Monomial>(std::string_view)>(expand_polynomial));
static_assert(has<std::shared_ptr<const HeightGrid>(std::uint32_t, std::uint32_t, Column<float>,
                                                    HeightInterpolation)>(make_height_grid));
static_assert(has<std::shared_ptr<const HeightGrid>(std::uint32_t, std::uint32_t, Column<std::uint16_t>,
                                                    HeightInterpolation)>(make_height_grid));

// Instruction sets.
static_assert(has<Isa()>(default_isa) && has<Isa(const std::string&)>(choose_isa));
static_assert(has<std::vector<Isa>()>(available_isas) && has<const char*(Isa)>(to_string));
static_assert(has<std::optional<Isa>(std::string_view)>(parse_isa));

// Pictures.
static_assert(has<RenderResult(Scene, const RenderOptions&)>(render));
static_assert(requires(Scene scene) { render(scene).picture.find("R")->values; });
static_assert(has<CameraFrame(const Camera&, const Film&)>(camera_frame));
static_assert(has<Ray(const CameraFrame&, double, double)>(camera_ray));
static_assert(has<void(const CameraFrame&, const FilmPoints&, RayBatch&, Isa)>(camera_rays));
static_assert(has<PixelWindow(const Film&)>(crop_window));
static_assert(std::derived_from<ImageTextures, TextureSampler>);
static_assert(std::constructible_from<ImageTextures, std::vector<Texture>>);

// Files.
static_assert(has<Scene(const std::string&, const Definitions&)>(load_scene));
static_assert(has<Scene(const std::string&, const Definitions&)>(load_scene_file));
static_assert(has<Scene(const std::string&, const GltfOptions&)>(scene_from_mesh));
static_assert(has<ObjFile(const std::string&)>(load_obj));
static_assert(has<MeshFile(const std::string&, const MeshOptions&)>(load_mesh) &&
              has<bool(const std::string&)>(is_mesh_file));
static_assert(has<void(const std::string&)>(check_output));
static_assert(has<void(const std::string&, const Picture&, const ImageMetadata&)>(write_image));
static_assert(has<Picture(const std::string&)>(read_image));
static_assert(has<HeightImage(const std::string&, std::uint32_t, std::size_t)>(read_heights));

// Errors.
static_assert(std::derived_from<Error, std::runtime_error>);
static_assert(std::same_as<decltype(std::declval<const Error&>().where()), const Location&>);
static_assert(std::same_as<decltype(std::declval<const Error&>().kind()), ErrorKind>);
static_assert(OKTETT_VERSION_MAJOR * 10000 + OKTETT_VERSION_MINOR * 100 + OKTETT_VERSION_PATCH >= 100);

}  // namespace oktett
