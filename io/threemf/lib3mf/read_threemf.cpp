/// \file Reads 3MF files with lib3mf. The shared library liboktett_threemf.

#include <Model/COM/NMR_DLLInterfaces.h>

#include <cstring>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/threemf/lib3mf/package.h"
#include "io/threemf/model.h"

namespace oktett {
namespace {

using namespace NMR;

constexpr std::size_t kMostWarnings = 20;

/// An object of lib3mf, given back at the end of its life.
class Handle {
 public:
  Handle() = default;
  ~Handle() {
    if (object_ != nullptr) lib3mf_release(object_);
  }
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&&) = delete;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  /// Where a function puts the object.
  PLib3MFBase** put() { return &object_; }
  PLib3MFBase* get() const { return object_; }

 private:
  PLib3MFBase* object_ = nullptr;
};

const char* name_of_unit(DWORD unit) {
  switch (unit) {
    case MODELUNIT_MICROMETER:
      return "micron";
    case MODELUNIT_CENTIMETER:
      return "centimeter";
    case MODELUNIT_INCH:
      return "inch";
    case MODELUNIT_FOOT:
      return "foot";
    case MODELUNIT_METER:
      return "meter";
    default:
      return "millimeter";
  }
}

class Reading {
 public:
  explicit Reading(const std::string& path) : path_(path) {}

  ThreeMfModel run(std::string_view bytes) {
    check(lib3mf_createmodel(model_.put()), model_);
    read(bytes);
    DWORD unit = MODELUNIT_MILLIMETER;
    check(lib3mf_model_getunit(model_.get(), &unit), model_);
    out_.unit = name_of_unit(unit);
    read_objects();
    read_build();
    for (const std::string& words : left_out_) out_.warnings.push_back(words + " are not read");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& words) const { throw Error(Location{path_}, words); }

  /// Throws Error unless `result`, of a function called with `object`, is good.
  void check(LIB3MFRESULT result, const Handle& object) const {
    if (result == LIB3MF_OK) return;
    DWORD code = 0;
    LPCSTR text = nullptr;
    if (object.get() != nullptr) lib3mf_getlasterror(object.get(), &code, &text);
    fail(std::string("cannot be read as a 3MF file: ") + (text != nullptr ? text : "unknown reason"));
  }

  /// The text that get(object, which..., buffer, size, needed) gives.
  template <class Get, class... Which>
  std::string text_of(const Handle& object, const Get& get, Which... which) const {
    ULONG size = 0;
    check(get(object.get(), which..., nullptr, 0, &size), object);
    std::string text(std::size_t{size} + 1, '\0');
    check(get(object.get(), which..., text.data(), size + 1, &size), object);
    return text.c_str();
  }

  void read(std::string_view bytes) {
    Handle reader;
    check(lib3mf_model_queryreader(model_.get(), MODELREADERCLASS_3MF, reader.put()), model_);
    // The interface lacks a const.
    auto* const begin = reinterpret_cast<BYTE*>(const_cast<char*>(bytes.data()));
    check(lib3mf_reader_readfrombuffer(reader.get(), begin, bytes.size()), reader);
    DWORD count = 0;
    check(lib3mf_reader_getwarningcount(reader.get(), &count), reader);
    std::set<std::string> said;
    for (DWORD i = 0; i < count && said.size() < kMostWarnings; ++i) {
      DWORD code = 0;
      const std::string words = text_of(reader, lib3mf_reader_getwarningutf8, i, &code);
      if (said.insert(words).second) out_.warnings.push_back("lib3mf: " + words);
    }
  }

  std::uint32_t id_of(const Handle& resource) const {
    DWORD id = 0;
    check(lib3mf_resource_getresourceid(resource.get(), &id), resource);
    return static_cast<std::uint32_t>(id);
  }

  void read_objects() {
    Handle iterator;
    check(lib3mf_model_getobjects(model_.get(), iterator.put()), model_);
    for (;;) {
      BOOL more = 0;
      check(lib3mf_resourceiterator_movenext(iterator.get(), &more), iterator);
      if (!more) return;
      Handle object;
      check(lib3mf_resourceiterator_getcurrent(iterator.get(), object.put()), iterator);
      ThreeMfObject& out = out_.objects.emplace_back();
      object_of_[id_of(object)] = static_cast<std::uint32_t>(out_.objects.size() - 1);
      out.name = text_of(object, lib3mf_object_getnameutf8);
      BOOL is_mesh = 0;
      check(lib3mf_object_ismeshobject(object.get(), &is_mesh), object);
      if (is_mesh)
        read_mesh(object, out);
      else
        read_components(object, out);
    }
  }

  std::uint32_t object_with(std::uint32_t id) const {
    const auto found = object_of_.find(id);
    if (found == object_of_.end()) fail("there is no object " + std::to_string(id));
    return found->second;
  }

  void read_components(const Handle& object, ThreeMfObject& out) {
    BOOL is_components = 0;
    check(lib3mf_object_iscomponentsobject(object.get(), &is_components), object);
    if (!is_components) return;
    DWORD count = 0;
    check(lib3mf_componentsobject_getcomponentcount(object.get(), &count), object);
    for (DWORD i = 0; i < count; ++i) {
      Handle component, target;
      check(lib3mf_componentsobject_getcomponent(object.get(), i, component.put()), object);
      check(lib3mf_component_getobjectresource(component.get(), target.put()), component);
      MODELTRANSFORM transform;
      check(lib3mf_component_gettransform(component.get(), &transform), component);
      out.parts.push_back({object_with(id_of(target)), Affine::from_rows(&transform.m_fFields[0][0])});
    }
  }

  void read_build() {
    Handle iterator;
    check(lib3mf_model_getbuilditems(model_.get(), iterator.put()), model_);
    for (;;) {
      BOOL more = 0;
      check(lib3mf_builditemiterator_movenext(iterator.get(), &more), iterator);
      if (!more) return;
      Handle item, target;
      check(lib3mf_builditemiterator_getcurrent(iterator.get(), item.put()), iterator);
      check(lib3mf_builditem_getobjectresource(item.get(), target.put()), item);
      BOOL is_moved = 0;
      check(lib3mf_builditem_hasobjecttransform(item.get(), &is_moved), item);
      ThreeMfPart part{object_with(id_of(target)), {}};
      if (is_moved) {
        MODELTRANSFORM transform;
        check(lib3mf_builditem_getobjecttransform(item.get(), &transform), item);
        part.place = Affine::from_rows(&transform.m_fFields[0][0]);
      }
      out_.build.push_back(part);
    }
  }

  void read_mesh(const Handle& mesh, ThreeMfObject& out) {
    DWORD vertices = 0, triangles = 0, beams = 0, slices = 0;
    check(lib3mf_meshobject_getvertexcount(mesh.get(), &vertices), mesh);
    check(lib3mf_meshobject_gettrianglecount(mesh.get(), &triangles), mesh);
    check(lib3mf_meshobject_getbeamcount(mesh.get(), &beams), mesh);
    check(lib3mf_meshobject_getslicestackid(mesh.get(), &slices), mesh);
    if (beams > 0) left_out_.insert("beam lattices");
    if (slices > 0) left_out_.insert("slices");
    static_assert(sizeof(MODELMESHVERTEX) == sizeof(Vec3f) && sizeof(MODELMESHTRIANGLE) == 12);
    out.positions.resize_uninitialized(vertices);
    out.indices.resize_uninitialized(std::size_t{3} * triangles);
    if (vertices > 0)
      check(lib3mf_meshobject_getvertices(
                mesh.get(), reinterpret_cast<MODELMESHVERTEX*>(out.positions.data()), vertices, nullptr),
            mesh);
    if (triangles == 0) return;
    check(lib3mf_meshobject_gettriangleindices(
              mesh.get(), reinterpret_cast<MODELMESHTRIANGLE*>(out.indices.data()), triangles, nullptr),
          mesh);
    read_looks(mesh, triangles, out);
  }

  void read_looks(const Handle& mesh, DWORD triangles, ThreeMfObject& out) {
    Handle handler;
    check(lib3mf_meshobject_createpropertyhandler(mesh.get(), handler.put()), mesh);
    for (DWORD i = 0; i < triangles; ++i) {
      eModelPropertyType type = MODELPROPERTYTYPE_NONE;
      check(lib3mf_propertyhandler_getpropertytype(handler.get(), i, &type), handler);
      std::uint32_t look = kNoId;
      if (type == MODELPROPERTYTYPE_BASEMATERIALS) look = read_base(handler, i);
      if (type == MODELPROPERTYTYPE_COLOR) look = read_colors(handler, i, out);
      if (type == MODELPROPERTYTYPE_TEXCOORD2D) look = read_image(handler, i, out);
      if (look == kNoId) continue;
      if (out.looks.empty()) out.looks.assign(triangles, kNoId);
      out.looks[i] = look;
    }
  }

  /// The index of the look with this key, which make() makes the first time.
  template <class Make>
  std::uint32_t look_of(ThreeMfLook::Kind kind, std::uint32_t group, std::uint32_t index, const Make& make) {
    const auto [entry, is_new] = look_of_.try_emplace({kind, group, index}, kNoId);
    if (is_new) {
      ThreeMfLook look = make();
      look.kind = kind;
      out_.looks.push_back(std::move(look));
      entry->second = static_cast<std::uint32_t>(out_.looks.size() - 1);
    }
    return entry->second;
  }

  std::uint32_t read_base(const Handle& handler, DWORD triangle) {
    DWORD group = 0, index = 0;
    check(lib3mf_propertyhandler_getbasematerial(handler.get(), triangle, &group, &index), handler);
    return look_of(ThreeMfLook::Kind::base, group, index, [&, group_id = group, number = index] {
      Handle materials;
      check(lib3mf_model_getbasematerialbyid(model_.get(), group_id, materials.put()), model_);
      DWORD count = 0;
      check(lib3mf_basematerial_getcount(materials.get(), &count), materials);
      if (number >= count)
        fail("a triangle has base material " + std::to_string(number) + " of a group of " +
             std::to_string(count));
      ThreeMfLook look;
      look.name = text_of(materials, lib3mf_basematerial_getnameutf8, number);
      check(lib3mf_basematerial_getdisplaycolor(materials.get(), number, &look.rgba[0], &look.rgba[1],
                                                &look.rgba[2], &look.rgba[3]),
            materials);
      return look;
    });
  }

  std::uint32_t read_colors(const Handle& handler, DWORD triangle, ThreeMfObject& out) {
    MODELMESH_TRIANGLECOLOR_SRGB colors;
    check(lib3mf_propertyhandler_getcolor(handler.get(), triangle, &colors), handler);
    if (out.colors.empty()) out.colors = Column<std::uint8_t>(4 * out.indices.size(), 255);
    static_assert(sizeof colors == 12);
    std::memcpy(&out.colors[std::size_t{12} * triangle], &colors, sizeof colors);
    return look_of(ThreeMfLook::Kind::colors, 0, 0, [] { return ThreeMfLook{.name = "colors"}; });
  }

  std::uint32_t read_image(const Handle& handler, DWORD triangle, ThreeMfObject& out) {
    MODELMESHTEXTURE2D texture;
    check(lib3mf_propertyhandler_gettexture(handler.get(), triangle, &texture), handler);
    if (out.uvs.empty()) out.uvs = Column<Vec2f>(out.indices.size(), Vec2f{0, 0});
    for (std::size_t k = 0; k < 3; ++k)
      out.uvs[std::size_t{3} * triangle + k] = {texture.m_fU[k], texture.m_fV[k]};
    const DWORD id = texture.m_nTextureID;
    return look_of(ThreeMfLook::Kind::image, id, 0, [&] {
      ThreeMfLook look;
      out_.images.push_back(read_texture(id));
      look.name = out_.images.back().path;
      look.image = static_cast<std::uint32_t>(out_.images.size() - 1);
      return look;
    });
  }

  ThreeMfImage read_texture(DWORD id) {
    Handle texture, attachment;
    check(lib3mf_model_gettexture2dbyid(model_.get(), id, texture.put()), model_);
    ThreeMfImage image;
    image.path = text_of(texture, lib3mf_texture2d_getpathutf8);
    check(lib3mf_texture2d_getattachment(texture.get(), attachment.put()), texture);
    ULONG64 size = 0;
    check(lib3mf_attachment_getstreamsize(attachment.get(), &size), attachment);
    image.content.resize(size);
    if (size > 0)
      check(lib3mf_attachment_writetobuffer(attachment.get(), reinterpret_cast<BYTE*>(image.content.data()),
                                            size),
            attachment);
    eModelTextureTileStyle u = MODELTEXTURETILESTYLE_WRAP, v = u;
    check(lib3mf_texture2d_gettilestyleuv(texture.get(), &u, &v), texture);
    eModelTextureFilter filter = MODELTEXTUREFILTER_AUTO;
    check(lib3mf_texture2d_getfilter(texture.get(), &filter), texture);
    image.lookup = {wrap_of(u), wrap_of(v),
                    filter == MODELTEXTUREFILTER_NEAREST ? TextureFilter::nearest : TextureFilter::linear};
    return image;
  }

  /// Beyond the edges of an image that is not repeated there is no image; its edge is shown.
  static TextureWrap wrap_of(eModelTextureTileStyle style) {
    if (style == MODELTEXTURETILESTYLE_WRAP) return TextureWrap::repeat;
    return style == MODELTEXTURETILESTYLE_MIRROR ? TextureWrap::mirror : TextureWrap::clamp;
  }

  const std::string& path_;
  Handle model_;
  ThreeMfModel out_;
  std::set<std::string> left_out_;
  std::map<std::uint32_t, std::uint32_t> object_of_;  ///< index, by the id in the package
  std::map<std::tuple<ThreeMfLook::Kind, std::uint32_t, std::uint32_t>, std::uint32_t> look_of_;
};

class Lib3mfLibrary final : public ThreeMfLibrary {
 public:
  ThreeMfModel read(const std::string& path, std::string_view bytes) const override {
    check_package(path, bytes);
    return Reading(path).run(bytes);
  }
};

}  // namespace
}  // namespace oktett

extern "C" __attribute__((visibility("default"))) const oktett::ThreeMfLibrary* oktett_threemf_library();
const oktett::ThreeMfLibrary* oktett_threemf_library() {
  static const oktett::Lib3mfLibrary library;
  return &library;
}
