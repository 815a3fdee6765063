#include "io/pov/translate/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/math.h"

namespace oktett::pov {
namespace {

class FinishReader {
 public:
  explicit FinishReader(Context& context) : context_(context) {}

  void read(const Block& block, Finish& f) {
    Arguments a(context_, block);
    Albedos albedos;
    while (!a.at_end()) {
      if (const Block* const inner = a.peek_block()) {
        if (inner->keyword == "finish")
          read(*inner, f);
        else if (inner->keyword == "reflection")
          read_reflection(*inner, f);
        else if (inner->keyword == "irid")
          read_irid(*inner, f);
        else
          tell(inner->keyword, inner->where);
        a.take();
        continue;
      }
      const Place where = a.where();
      const std::string_view word = a.peek_word();
      a.take();
      read_word(word, where, a, f, albedos);
    }
    // So that this part of the light leaves again, however it is spread (POV-Ray 3.7, measured).
    if (albedos.diffuse) f.diffuse *= (f.brilliance + 1) / 2, f.diffuse_back *= (f.brilliance + 1) / 2;
    if (albedos.phong) f.phong *= (f.phong_size + 1) / 2;
    if (const double n = 1 / std::max(f.roughness, 1e-6); albedos.specular)
      f.specular *= (n + 2) / (4 * (2 - portable::exp2(-n / 2)));
  }

 private:
  /// What is given as a part of the light, by the word `albedo`.
  struct Albedos {
    bool diffuse = false, phong = false, specular = false;
  };

  void tell(std::string_view what, const Place& where) {
    context_.tell(fmt::format("finish {}", what), where,
                  fmt::format("'{}' of a finish has no meaning here, and is left out", what));
  }

  void read_word(std::string_view word, const Place& where, Arguments& a, Finish& f, Albedos& albedos) {
    if (word == "ambient")
      f.ambient = a.vector("a colour");
    else if (word == "emission")
      f.emission = a.vector("a colour");
    else if (word == "diffuse") {
      albedos.diffuse = a.take_word("albedo");
      f.diffuse = a.number("a number");
      f.diffuse_back = a.is_numbers() ? std::max(0.0, a.number("a number")) : 0;
    } else if (word == "phong")
      albedos.phong = a.take_word("albedo"), f.phong = a.number("a number");
    else if (word == "phong_size")
      f.phong_size = a.number("a number");
    else if (word == "specular")
      albedos.specular = a.take_word("albedo"), f.specular = a.number("a number");
    else if (word == "roughness")
      f.roughness = a.number("a number");
    else if (word == "metallic")
      f.metallic = a.is_numbers() ? a.number("a number") : 1;
    else if (word == "reflection")
      f.reflection = f.reflection_max = a.vector("a colour"), f.varies = f.fresnel = false;
    else if (word == "ior")
      f.ior = a.number("a number");
    else if (word == "refraction" || word == "caustics" || word == "fade_power" || word == "fade_distance" ||
             word == "use_alpha") {
      if (a.is_numbers()) a.take();
    } else if (word == "conserve_energy")
      f.conserves = a.flag();
    else if (word == "brilliance")
      f.brilliance = std::max(0.0, a.number("a number"));
    else if (word == "crand")
      f.crand = std::max(0.0, a.number("a number"));
    else if (word == "reflection_exponent") {
      if (a.number("a number") != 1) tell("exponent of reflection", where);
    } else if (is_filler(word)) {
    } else {
      tell(word, where);
      while (a.is_numbers()) a.take();
    }
  }

  static bool is_filler(std::string_view word) {
    return word.empty() || word == "color" || word == "colour" || word == "rgb";
  }

  void read_reflection(const Block& block, Finish& f) {
    Arguments a(context_, block);
    std::vector<Vec3d> colors;
    f.fresnel = false, f.falloff = 1, f.reflection_metallic = 0;
    while (!a.at_end()) {
      const Place where = a.where();
      if (a.is_numbers()) {
        colors.push_back(a.vector("a colour"));
      } else if (a.take_word("fresnel")) {
        f.fresnel = a.flag();
      } else if (a.take_word("metallic")) {
        f.reflection_metallic = a.is_numbers() ? a.number("a number") : 1;
      } else if (a.take_word("falloff")) {
        f.falloff = a.number("a number");
      } else if (a.take_word("exponent")) {
        if (a.number("a number") != 1) tell("exponent of reflection", where);
      } else {
        a.take();
      }
    }
    if (colors.empty()) return;
    f.reflection = colors[0], f.reflection_max = colors.back();
    // By Fresnel's equations a single colour is that at grazing angles.
    if (f.fresnel && colors.size() == 1) f.reflection = {0, 0, 0};
    f.varies = !(f.reflection == f.reflection_max);
  }

  /// A thin film.
  void read_irid(const Block& block, Finish& f) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      if (a.is_numbers())
        f.irid = std::max(0.0, a.number("a number"));
      else if (a.take_word("thickness"))
        f.film_thickness = std::max(0.0, a.number("a number"));
      else if (a.take_word("turbulence"))
        f.film_turbulence = std::clamp(a.number("a number"), 0.0, 1.0);
      else
        a.take();
    }
  }

  Context& context_;
};

}  // namespace

void read_finish(Context& context, const Block& block, Finish& finish) {
  FinishReader(context).read(block, finish);
}

}  // namespace oktett::pov
