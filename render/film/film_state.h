#pragma once
/// \file A picture in progress: the sums of the tiles that are finished, and which tiles it is to have.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "render/film/tile.h"
#include "render/tone.h"

namespace oktett {

/// Part `number` of `count` parts of a picture.
struct FilmShare {
  static constexpr std::uint32_t kMost = 1u << 20;  ///< parts

  std::uint32_t number = 1, count = 1;
  bool operator==(const FilmShare&) const = default;
};

/// What is known of a picture before its first pixel.
struct FilmPlan {
  FilmFormat format;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< see Picture::attributes
  std::uint32_t samples = 1;  ///< of each pixel, without those that are added
  bool moves = false;         ///< samples are added by multiples of `samples` only

  /// Whether the sums of one picture are of use for the other.
  bool operator==(const FilmPlan&) const = default;
};

/// The edge of tiles: 32 pixels, or 16 or 8 if a picture in so many shares, at least two, would else have
/// fewer than four tiles for each of them.
std::uint32_t tile_size_of(const FilmFormat& format, std::uint32_t shares);

/// The sums of a tile as bytes, and how many samples more than the plan's each of its pixels has.
struct TileRecord {
  std::uint32_t added = 0;
  std::string bytes;
};
using TileRecordPointer = std::shared_ptr<const TileRecord>;

/// Tiles are numbered row by row. Tile (column, row) belongs to share (row * columns + (column + row) mod
/// columns) mod count + 1: every count-th tile, where each row begins one tile further to the right so that
/// shares are no columns. All functions may be called by several threads at the same time.
class FilmState {
 public:
  /// `added`: samples of each pixel beyond those of the plan.
  explicit FilmState(FilmShare share, std::uint32_t added = 0) : share_(share), added_(added) {}

  /// Sets the plan and the tone. A plan that is there already stays: throws Error unless it is the same.
  void begin(const FilmPlan& plan, const Tone& tone);
  bool has_begun() const;
  /// How formats that store no linear light show the colours: the tone of the last begin().
  Tone tone() const;
  // The following need a plan.
  const FilmPlan& plan() const { return plan_; }
  std::uint32_t tile_size() const { return tile_size_; }
  std::size_t tile_count() const { return columns_ * rows_; }
  FinishedTile tile(std::size_t number) const;
  FilmShare share() const { return share_; }
  bool in_share(std::size_t tile) const;
  std::uint32_t added() const { return added_; }
  /// Asks for that many more samples of each pixel. Throws Error if they are too many, or if things move and
  /// it is no multiple of the plan's samples. Not while other threads use the film.
  void add_samples(std::uint32_t count);

  /// What is known of a tile; may be null.
  TileRecordPointer record(std::size_t tile) const;
  void set_record(std::size_t tile, TileRecord record);
  /// All that are known, by number.
  std::map<std::size_t, TileRecordPointer> records() const;
  /// Grows with each record that is set.
  std::uint64_t version() const;

  std::size_t tiles_wanted() const;
  /// Of these, those with all their samples.
  std::size_t tiles_finished() const;

 private:
  FilmShare share_;
  std::uint32_t added_;
  std::uint32_t tile_size_ = 0;
  FilmPlan plan_;                       ///< never changes once the film has begun
  std::size_t columns_ = 0, rows_ = 0;  ///< of tiles
  mutable std::mutex mutex_;            ///< for all that follows
  Tone tone_;
  std::map<std::size_t, TileRecordPointer> records_;
  std::uint64_t version_ = 0;
  bool begun_ = false;
};

/// Does what render_tile does for a tile of the film: traces the samples that the film lacks, keeps the sums
/// and writes the planes.
TileCounts render_film_tile(const RenderContext& context, FilmState& film, std::size_t tile, Picture& picture,
                            TileWorkspace& work);

/// An empty picture with the plan's planes and attributes.
Picture make_picture(const FilmPlan& plan, const Tone& tone);

/// Writes all tiles that `film` has. Throws Error for records that it cannot have.
void write_tiles(const FilmState& film, Picture& picture);

}  // namespace oktett
