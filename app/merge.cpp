#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "app/render_options.h"
#include "app/setting_options.h"
#include "app/text.h"
#include "app/unused_options.h"
#include "core/error.h"
#include "io/film/film_file.h"
#include "io/image/image.h"
#include "render/film/denoise.h"

namespace oktett {
namespace {

struct MergeArguments {
  std::vector<std::string> films;
  std::string outfile;
  SettingWords settings;
  std::string bits;
  bool allow_missing = false, denoise = false, quiet = false;
};

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw Error(Location{path}, message);
}

/// A film of the merge, without its sums.
struct Part {
  std::string path;
  FilmShare share;
  std::size_t tiles_wanted = 0, tiles_finished = 0;
};

/// Shares of one picture, checked one after the other.
class Shares {
 public:
  explicit Shares(bool allow_missing) : allow_missing_(allow_missing) {}

  void add(const std::string& path, const FilmFile& file) {
    const FilmState& film = *file.film;
    if (parts_.empty())
      first_ = file, first_.film = std::make_shared<FilmState>(film.share(), film.added()),
      first_.film->begin(film.plan(), film.tone());
    else
      check_picture(path, file);
    const std::uint32_t number = film.share().number;
    const Part part{path, film.share(), film.tiles_wanted(), film.tiles_finished()};
    if (!parts_.emplace(number, part).second)
      fail(path,
           fmt::format("is share {}/{}, as '{}' is", number, film.share().count, parts_.at(number).path));
    if (part.tiles_finished < part.tiles_wanted && !allow_missing_)
      fail(path,
           fmt::format("has {} of its {} tiles; go on with 'oktett render --resume {}', or leave them out "
                       "with --allow-missing",
                       part.tiles_finished, part.tiles_wanted, path));
    if (parts_.size() > 1) first_.metadata.render_seconds += file.metadata.render_seconds;
    if (!first_.metadata.camera) first_.metadata.camera = file.metadata.camera;
  }

  void check_complete() const {
    const std::uint32_t count = first_.film->share().count;
    if (allow_missing_ || parts_.size() == count) return;
    std::uint32_t least = 1;
    for (const auto& part : parts_)
      if (part.first == least) ++least;
    const std::size_t others = count - parts_.size() - 1;
    throw Error(fmt::format("share {}/{}{} missing; --allow-missing leaves the pixels transparent", least,
                            count, others == 0 ? " is" : fmt::format(" and {} others are", others)));
  }

  /// The first film, without sums; its metadata are those of all.
  const FilmFile& first() const { return first_; }
  const std::map<std::uint32_t, Part>& parts() const { return parts_; }
  std::size_t tiles_missing() const {
    std::size_t missing = first_.film->tile_count();
    for (const auto& entry : parts_) missing -= entry.second.tiles_finished;
    return missing;
  }
  void check_picture(const std::string& path, const FilmFile& file) const {
    const std::string& other = parts_.begin()->second.path;
    const FilmState &film = *file.film, &before = *first_.film;
    std::string what = difference(first_.fingerprint, file.fingerprint);
    if (what.empty() && film.added() != before.added())
      what = fmt::format("--add-spp is {} there and {} here", before.added(), film.added());
    if (what.empty() && film.share().count != before.share().count)
      what = fmt::format("it is one of {} shares there and of {} here", before.share().count,
                         film.share().count);
    if (what.empty() && film.plan() != before.plan()) what = "the planes are others";
    if (!what.empty()) fail(path, fmt::format("does not belong to '{}': {}", other, what));
  }

 private:
  bool allow_missing_;
  FilmFile first_;
  std::map<std::uint32_t, Part> parts_;  ///< by number
};

/// The tone of the films, or what is asked for instead.
Tone tone_of(const MergeArguments& arguments, const Tone& tone) {
  Scene scene;
  scene.film.tone = tone;
  override_settings(arguments.settings, scene);
  return scene.film.tone;
}

int run_merge(const MergeArguments& arguments) {
  if (arguments.outfile.empty()) throw Error("expected -o FILE, the picture to write");
  check_output(arguments.outfile);
  check_bits(arguments.bits, arguments.outfile);
  tone_of(arguments, {});
  warn_of_unused_tone(arguments.settings, arguments.outfile);
  // Films are read twice: all are checked before the picture takes memory, and one at a time is in memory.
  Shares shares(arguments.allow_missing);
  for (const std::string& path : arguments.films) shares.add(path, read_film(path));
  shares.check_complete();
  const FilmPlan& plan = shares.first().film->plan();
  if (arguments.denoise && !plan.format.data_layers)
    throw Error("--denoise needs the data layers of films that were made for EXR files");
  Picture picture = make_picture(plan, tone_of(arguments, shares.first().film->tone()));
  for (const auto& [number, part] : shares.parts()) {
    const FilmFile file = read_film(part.path);
    if (!(file.film->share() == part.share)) fail(part.path, "has changed meanwhile");
    shares.check_picture(part.path, file);
    try {
      write_tiles(*file.film, picture);
    } catch (const Error& error) {
      fail(part.path, error.what());
    }
  }
  const std::size_t missing = shares.tiles_missing();
  if (arguments.denoise && missing == 0) denoise(picture);
  const auto write = arguments.bits == "16" ? write_image16 : write_image;
  write(arguments.outfile, picture, shares.first().metadata);
  if (!arguments.quiet) fmt::print("wrote {}\n", arguments.outfile);
  std::fflush(stdout);
  if (missing > 0)
    say("warning: {} of {} tiles are missing and transparent\n", missing, shares.first().film->tile_count());
  return 0;
}

}  // namespace

void add_merge_command(CommandLine& line) {
  const auto a = std::make_shared<MergeArguments>();
  Verb verb = line.add_verb("merge", "Put the shares of a picture together", [a] { return run_merge(*a); });
  verb.positionals("films", a->films, "FILM...", "Film files of oktett render --shard or --checkpoint");
  verb.option("-o,--outfile", &a->outfile, "FILE", "Picture to write");
  add_bits_option(verb, a->bits);
  verb.flag("--allow-missing", a->allow_missing, "Leave pixels transparent that no film has");
  for (const char* option : {"--tone", "--exposure"}) add_setting_option(verb, option, a->settings);
  verb.flag("--denoise", a->denoise, "Smooth the noise of the merged picture");
  verb.flag("--quiet", a->quiet, "Print nothing but warnings and errors");
}

}  // namespace oktett
