#include "io/photometry/ies_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "io/text/file_content.h"
#include "io/text/scan.h"

namespace oktett {
namespace {

/// A file of this size holds a million values.
constexpr std::size_t kMostBytes = std::size_t{32} << 20;

bool separates(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; }

/// The words of a file and where they stand.
class Words {
 public:
  Words(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  /// The rest of the line, without blanks at its ends; moves behind it.
  std::string_view line() {
    std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    here_ = at_;
    move_to(std::min(end + 1, text_.size()));
    while (!line.empty() && separates(line.front())) line.remove_prefix(1);
    while (!line.empty() && separates(line.back())) line.remove_suffix(1);
    return line;
  }
  bool at_end() const { return at_ == text_.size(); }
  std::size_t left() const { return text_.size() - at_; }

  double number(const char* what) {
    while (at_ < text_.size() && separates(text_[at_])) move_to(at_ + 1);
    std::size_t end = at_;
    while (end < text_.size() && !separates(text_[end])) ++end;
    std::string_view word = text_.substr(at_, end - at_);
    here_ = at_, here_line_ = line_, here_start_ = line_start_;
    if (word.empty()) fail(std::string("expected ") + what + ", found the end of the file");
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    double value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || stop != digits.data() + digits.size() || !std::isfinite(value))
      fail(std::string("expected ") + what + ", found '" + std::string(word.substr(0, 40)) + "'");
    move_to(end);
    return value;
  }
  double number(const char* what, double lo, double hi) {
    const double value = number(what);
    if (!(value >= lo && value <= hi)) fail(std::string("expected ") + what);
    return value;
  }
  std::size_t count(const char* what) {
    const double value = number(what, 1, 1e6);
    if (value != std::floor(value)) fail(std::string("expected ") + what);
    return static_cast<std::size_t>(value);
  }

  /// Throws Error at the last word.
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(Location{path_, here_line_, static_cast<int>(here_ - here_start_) + 1}, message);
  }

 private:
  void move_to(std::size_t place) {
    here_line_ = line_, here_start_ = line_start_;
    for (; at_ < place; ++at_)
      if (text_[at_] == '\n') ++line_, line_start_ = at_ + 1;
  }

  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0, here_ = 0, line_start_ = 0, here_start_ = 0;
  int line_ = 1, here_line_ = 1;
};

/// Reads up to the line of TILT, and what belongs to that.
void skip_header(Words& words) {
  for (;;) {
    if (words.at_end()) words.fail("expected a line 'TILT=...', found the end of the file");
    const std::string_view line = words.line();
    if (line.substr(0, 5) != "TILT=") continue;
    std::string_view tilt = line.substr(5);
    while (!tilt.empty() && separates(tilt.front())) tilt.remove_prefix(1);
    if (tilt == "INCLUDE") {
      words.number("the lamp's geometry, 1 to 3", 1, 3);
      const std::size_t pairs = words.count("the number of angles of tilt, a whole number of at least 1");
      for (std::size_t k = 0; k < 2 * pairs; ++k) words.number("a number of the table of tilt");
    } else if (tilt.empty()) {
      words.fail("expected TILT=NONE, TILT=INCLUDE or the name of a file");
    }
    return;
  }
}

std::vector<double> read_angles(Words& words, std::size_t count, const char* what, double hi) {
  std::vector<double> angles;
  for (std::size_t k = 0; k < count; ++k) {
    angles.push_back(words.number(what, 0, hi));
    if (k > 0 && !(angles[k] > angles[k - 1]))
      words.fail(std::string(what) + " must be greater than the last");
  }
  return angles;
}

/// An angle of the full circle and the column of the file that it shows.
struct Around {
  double angle;
  std::size_t column;
};

/// The full circle from 0 to 360 of angles of which symmetry leaves some out; the first and last angle say
/// which symmetry. Empty if there is no angle 0.
std::vector<Around> full_circle(const std::vector<double>& angles) {
  std::vector<Around> all;
  const double first = angles.front(), last = angles.back();
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const double a = angles[k];
    const auto add = [&](double angle) {
      all.push_back({angle < 0 ? angle + 360 : angle >= 360 ? angle - 360 : angle, k});
    };
    add(a);
    if (last == 90 || first == 90) add(180 - a);
    if (last == 90 || last == 180) add(360 - a);
    if (last == 90) add(180 + a);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Around& a, const Around& b) { return a.angle < b.angle; });
  all.erase(std::unique(all.begin(), all.end(),
                        [](const Around& a, const Around& b) { return a.angle == b.angle; }),
            all.end());
  if (all.front().angle != 0) return {};
  all.push_back({360, all.front().column});
  return all;
}

}  // namespace

LightProfile read_light_profile(const std::string& path) {
  const MappedFile file(path);
  if (file.text().size() > kMostBytes) throw Error(Location{path}, "the file is larger than 32 MB");
  Words words(path, without_byte_order_mark(file.text()));
  skip_header(words);
  words.number("the number of lamps");
  words.number("the lumens of a lamp");
  words.number("the factor on candela, from 1e-30 to 1e30", 1e-30, 1e30);
  const std::size_t rows = words.count("the number of vertical angles, a whole number of at least 1");
  const std::size_t columns = words.count("the number of horizontal angles, a whole number of at least 1");
  if (words.number("the photometric type") != 1) words.fail("expected the photometric type 1 (C)");
  words.number("the units, 1 (feet) or 2 (metres)", 1, 2);
  for (const char* what : {"the width", "the length", "the height", "the ballast factor",
                           "the ballast-lamp factor", "the input watts"})
    words.number(what);
  if (rows < 2) words.fail("expected at least 2 vertical angles");
  // Each value takes two characters at least; so no memory is asked for that the file cannot fill.
  if (rows * columns > words.left()) words.fail("the file is cut short");
  LightProfile profile;
  profile.vertical = read_angles(words, rows, "a vertical angle from 0 to 180", 180);
  profile.horizontal = read_angles(words, columns, "a horizontal angle from 0 to 360", 360);
  const double first = profile.horizontal.front(), last = profile.horizontal.back();
  const bool turned = first == 90 && last == 270;
  std::vector<Around> around{{0, 0}};
  if (columns > 1) around = full_circle(profile.horizontal);
  if (columns > 1 && (around.empty() || (!turned && (first != 0 || !(last == 90 || last >= 180)))))
    words.fail("expected horizontal angles from 0 to 90, 180 or 360, or from 90 to 270");
  double greatest = 0;
  std::vector<double> read;
  for (std::size_t k = 0; k < rows * columns; ++k) {
    read.push_back(words.number("an intensity from 0 to 1e30", 0, 1e30));
    greatest = std::max(greatest, read.back());
  }
  if (!(greatest > 0)) words.fail("all intensities are 0");
  profile.horizontal.clear();
  for (const auto& [angle, column] : around) {
    profile.horizontal.push_back(angle);
    for (std::size_t v = 0; v < rows; ++v)
      profile.values.push_back(static_cast<float>(read[column * rows + v] / greatest));
  }
  return profile;
}

}  // namespace oktett
