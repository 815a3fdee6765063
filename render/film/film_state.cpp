#include "render/film/film_state.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/error.h"
#include "render/film/tile.h"

namespace oktett {
namespace {

/// Tiles along an edge of so many pixels.
std::size_t tiles_along(std::uint32_t pixels, std::uint32_t size) { return (pixels + size - 1) / size; }

std::size_t pixels_of(const FinishedTile& tile) { return std::size_t{tile.width} * tile.height; }

/// The samples of a pixel are spread over the time that is seen, so that what is added must be so, too.
void expect_whole_turns(const FilmPlan& plan, std::uint32_t added) {
  if (plan.moves && added % plan.samples != 0)
    throw Error("things move, so samples are added by multiples of " + std::to_string(plan.samples));
}

}  // namespace

std::uint32_t tile_size_of(const FilmFormat& format, std::uint32_t shares) {
  std::uint32_t size = 32;
  const auto tiles = [&] {
    return tiles_along(format.window.width(), size) * tiles_along(format.window.height(), size);
  };
  while (size > 8 && shares > 1 && tiles() < std::size_t{4} * shares) size /= 2;
  return size;
}

void FilmState::begin(const FilmPlan& plan, const Tone& tone) {
  const std::lock_guard lock(mutex_);
  if (begun_ && plan != plan_) throw Error("the film is of another picture");
  tone_ = tone;
  if (begun_) return;
  plan_ = plan;
  tile_size_ = tile_size_of(plan.format, share_.count);
  columns_ = tiles_along(plan.format.window.width(), tile_size_);
  rows_ = tiles_along(plan.format.window.height(), tile_size_);
  expect_whole_turns(plan, added_);
  begun_ = true;
}

bool FilmState::has_begun() const {
  const std::lock_guard lock(mutex_);
  return begun_;
}

Tone FilmState::tone() const {
  const std::lock_guard lock(mutex_);
  return tone_;
}

FinishedTile FilmState::tile(std::size_t number) const {
  const auto x = static_cast<std::uint32_t>(number % columns_) * tile_size_,
             y = static_cast<std::uint32_t>(number / columns_) * tile_size_;
  return {x, y, std::min(tile_size_, plan_.format.window.width() - x),
          std::min(tile_size_, plan_.format.window.height() - y)};
}

bool FilmState::in_share(std::size_t tile) const {
  const std::size_t row = tile / columns_, column = tile % columns_;
  return (row * columns_ + (column + row) % columns_) % share_.count + 1 == share_.number;
}

void FilmState::add_samples(std::uint32_t count) {
  if (count > kMostAddedSamples - added_)
    throw Error("more than " + std::to_string(kMostAddedSamples) + " samples would be added");
  expect_whole_turns(plan_, count);
  added_ += count;
}

TileRecordPointer FilmState::record(std::size_t tile) const {
  const std::lock_guard lock(mutex_);
  const auto found = records_.find(tile);
  return found == records_.end() ? nullptr : found->second;
}

void FilmState::set_record(std::size_t tile, TileRecord record) {
  auto kept = std::make_shared<const TileRecord>(std::move(record));
  const std::lock_guard lock(mutex_);
  records_[tile] = std::move(kept);
  ++version_;
}

std::map<std::size_t, TileRecordPointer> FilmState::records() const {
  const std::lock_guard lock(mutex_);
  return records_;
}

std::uint64_t FilmState::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

std::size_t FilmState::tiles_wanted() const {
  return tile_count() / share_.count + (share_.number <= tile_count() % share_.count ? 1 : 0);
}

std::size_t FilmState::tiles_finished() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::ranges::count_if(records_, [&](const auto& entry) { return entry.second->added == added_; }));
}

TileCounts render_film_tile(const RenderContext& context, FilmState& film, std::size_t tile, Picture& picture,
                            TileWorkspace& work) {
  const FilmFormat& format = film.plan().format;
  const FinishedTile place = film.tile(tile);
  const TileRecordPointer known = film.record(tile);
  TileCounts counts;
  work.wavefront.counts = {};
  TileSums sums =
      known != nullptr ? decode_tile(format, pixels_of(place), known->bytes) : sum_tile(context, place, work);
  // Samples are added to the sums of the first ones even in one render, so that several give the same bits.
  const std::uint32_t missing = film.added() - (known != nullptr ? known->added : 0);
  if (missing > 0) add_to_tile(context, place, missing, work, sums);
  counts.rays = work.wavefront.counts;
  if (known == nullptr || missing > 0) film.set_record(tile, {film.added(), encode_tile(format, sums)});
  write_tile(format, place, sums, picture);
  counts.bad_samples = sums.bad_samples();
  return counts;
}

Picture make_picture(const FilmPlan& plan, const Tone& tone) {
  Picture picture = make_picture(plan.format);
  picture.attributes = plan.attributes;
  picture.tone = tone;
  return picture;
}

void write_tiles(const FilmState& film, Picture& picture) {
  const auto records = film.records();
  std::vector<std::pair<std::size_t, TileRecordPointer>> list(records.begin(), records.end());
  tbb::parallel_for(std::size_t{0}, list.size(), [&](std::size_t i) {
    const FinishedTile place = film.tile(list[i].first);
    const FilmFormat& format = film.plan().format;
    write_tile(format, place, decode_tile(format, pixels_of(place), list[i].second->bytes), picture);
  });
}

}  // namespace oktett
