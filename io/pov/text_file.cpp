#include "io/pov/text_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "io/pov/interpreter.h"

namespace oktett::pov {

/// Steps from folder to folder, so that no link on the way, even one made in between, leads out.
TextFile::TextFile(const std::string& folder, const std::string& name, Mode mode, std::size_t most_bytes)
    : mode_(mode) {
  namespace fs = std::filesystem;
  const fs::path path(name);
  if (name.empty() || path.is_absolute()) throw std::string("expected a path below the folder of files");
  // The system would read the name only up to there.
  if (name.find('\0') != std::string::npos) throw std::string("a path has no zero byte");
  int at = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (at < 0) throw "cannot open the folder of files: " + std::string(std::strerror(errno));
  const auto fail = [&at](const std::string& message) {
    ::close(at);
    throw message;
  };
  std::string last;
  for (const fs::path& part : path) {
    if (part == "..") fail("paths with '..' are refused");
    if (!last.empty() && last != ".") {
      const int next = openat(at, last.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
      if (next < 0) fail(std::strerror(errno));
      ::close(at);
      at = next;
    }
    last = part.string();
  }
  const int how = mode == Mode::read    ? O_RDONLY
                  : mode == Mode::write ? O_WRONLY | O_CREAT | O_TRUNC
                                        : O_WRONLY | O_CREAT | O_APPEND;
  descriptor_ = openat(at, last.c_str(), how | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
  struct stat status {};
  const bool is_open = descriptor_ >= 0;
  if (!is_open) fail(errno == ELOOP ? "links are refused" : std::strerror(errno));
  ::close(at);
  const auto refuse = [this](const char* message) {
    ::close(descriptor_);
    throw std::string(message);
  };
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) refuse("not a regular file");
  if (mode != Mode::read) return;
  if (static_cast<std::uint64_t>(status.st_size) > most_bytes) refuse("too large");
  text_.resize(static_cast<std::size_t>(status.st_size));
  std::size_t got = 0;
  while (got < text_.size()) {
    const ssize_t count = ::read(descriptor_, text_.data() + got, text_.size() - got);
    if (count <= 0) break;
    got += static_cast<std::size_t>(count);
  }
  text_.resize(got);
}

TextFile::~TextFile() {
  try {
    flush();
  } catch (const std::string&) {
    // Nobody is left to be told.
  }
  if (descriptor_ >= 0) ::close(descriptor_);
}

void TextFile::write(std::string_view text) {
  constexpr std::size_t kMostUnwritten = 1 << 16;
  unwritten_ += text;
  if (unwritten_.size() > kMostUnwritten) flush();
}

void TextFile::flush() {
  const std::string whole = std::exchange(unwritten_, {});
  std::string_view text = whole;
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor_, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::string(std::strerror(errno));
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

void TextFile::close() {
  flush();
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  closed_ = true;
}

namespace {

bool is_gap(char c) { return c == ',' || c == ' ' || (c >= '\t' && c <= '\r'); }

/// A number as `%g` of C prints it, with as many digits as POV-Ray writes.
std::string written(double x) {
  char text[64];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

/// One value at the start of `text`, and how many characters it takes. None where nothing fits.
std::size_t read_datum(std::string_view text, Datum& datum) {
  // scan_number reads whole words, so it needs zero bytes behind the text.
  std::string copy(text.substr(0, 400));
  copy.append(FileContent::kPadding, '\0');
  const auto scan = [&](std::size_t at, double& x) -> std::size_t {
    const std::size_t start = at;
    const bool negative = copy[at] == '-';
    if (negative || copy[at] == '+') ++at;
    if (!is_digit(copy[at]) && !(copy[at] == '.' && is_digit(copy[at + 1]))) return 0;
    const char* const end =
        scan_number(copy.data() + at, copy.data() + copy.size() - FileContent::kPadding, x);
    if (negative) x = -x;
    return static_cast<std::size_t>(end - copy.data()) - start;
  };
  if (text[0] == '"') {
    const std::size_t end = text.find('"', 1);
    if (end == std::string_view::npos) return 0;
    datum.value = std::string(text.substr(1, end - 1));
    return end + 1;
  }
  Numbers value;
  if (text[0] != '<') {
    const std::size_t used = scan(0, value.v[0]);
    datum.value = value;
    return used;
  }
  std::size_t at = 1, size = 0;
  while (at < text.size() && size < 5) {
    while (is_gap(copy[at])) ++at;
    const std::size_t used = scan(at, value.v[size]);
    if (used == 0) return 0;
    at += used, ++size;
    while (is_gap(copy[at])) ++at;
    if (copy[at] != '>') continue;
    if (size < 2) return 0;
    value.size = static_cast<std::uint8_t>(size);
    datum.value = value;
    return at + 1;
  }
  return 0;
}

}  // namespace

/// `#fopen NAME "file" read`, `write` or `append`
void Interpreter::open_file() {
  const Token name = take_written();
  if (name.kind != Token::Kind::word || name.name->keyword != kNoKeyword)
    fail_expected("the name of a file handle", name);
  const std::string path = parse_string();
  const Token how = take_written();
  TextFile::Mode mode = TextFile::Mode::read;
  switch (how.keyword()) {
    case "read"_kw:
      break;
    case "write"_kw:
      mode = TextFile::Mode::write;
      break;
    case "append"_kw:
      mode = TextFile::Mode::append;
      break;
    default:
      fail_expected("read, write or append", how);
  }
  if (options_.file_folder.empty())
    fail(name.where, std::string("#fopen is not allowed: the option ") + kFileFolderOption +
                         " names a folder for files of scenes");
  Datum datum;
  count_step(name.where, 100);
  try {
    const std::uint64_t most = std::min(limits_.file_bytes, limits_.bytes - bytes_);
    auto file = std::make_shared<TextFile>(options_.file_folder, path, mode, most);
    bytes_ += file->size();
    count_step(name.where, file->size() / kBytesOfStep);
    datum.value = std::move(file);
  } catch (const std::string& problem) {
    fail(name.where, "cannot open " + in_quotes(path) + ": " + problem);
  }
  assign(variable(name, false), std::move(datum), name.where);
}

TextFile& Interpreter::file_handle(const Token& token) {
  const Datum* const datum = token.kind == Token::Kind::word ? token.name->datum() : nullptr;
  const auto* const file = datum ? datum->get<std::shared_ptr<TextFile>>() : nullptr;
  if (file == nullptr) fail_expected("a file that #fopen has opened", token);
  return **file;
}

void Interpreter::close_file() {
  const Token name = take_written();
  if (name.kind == Token::Kind::word && name.name->datum() == nullptr) return;
  try {
    file_handle(name).close();
  } catch (const std::string& problem) {
    fail(name.where, "cannot write: " + problem);
  }
  assign(name.name->bindings.back().value, {}, name.where);
}

/// `#read (FILE, NAME, ...)`. At the end of the file the handle counts as not declared.
void Interpreter::read_file() {
  expect('(', "behind #read");
  const Token name = take_written();
  const std::shared_ptr<TextFile> file =
      (file_handle(name), *name.name->datum()->get<std::shared_ptr<TextFile>>());
  if (file->mode() != TextFile::Mode::read) fail(name.where, "this file is not open for reading");
  while (!next_is(')')) {
    skip_comma();
    const Token target = take_written();
    if (target.kind != Token::Kind::word || target.name->keyword != kNoKeyword)
      fail_expected("a name to read into", target);
    const Reference reference = next_is('[') ? access(target) : variable(target, false);
    const auto skip_gaps = [&] {
      std::size_t gaps = 0;
      const std::string_view rest = file->rest();
      while (gaps < rest.size() && is_gap(rest[gaps])) ++gaps;
      file->skip(gaps);
    };
    skip_gaps();
    Datum datum;
    if (file->at_end()) continue;
    const std::size_t used = read_datum(file->rest(), datum);
    if (used == 0)
      fail(target.where, "expected a number, a vector or a string in the file, found " +
                             in_quotes(file->rest().substr(0, file->rest().find('\n'))));
    if (const std::string* text = datum.get<std::string>()) check_length(text->size(), target.where);
    file->skip(used);
    skip_gaps();
    count_step(target.where);
    assign(reference, std::move(datum), target.where);
  }
  expect(')', "behind #read");
}

/// `#write (FILE, value, ...)`; sint8, uint16le and the like write the numbers behind them as bytes.
void Interpreter::write_file() {
  expect('(', "behind #write");
  const Token name = take_written();
  const std::shared_ptr<TextFile> file =
      (file_handle(name), *name.name->datum()->get<std::shared_ptr<TextFile>>());
  if (file->mode() == TextFile::Mode::read) fail(name.where, "this file is open for reading");
  std::size_t bytes = 0;
  bool big_first = false;
  while (!take_if(')')) {
    if (take_if(',')) continue;
    const Token token = peek();
    const std::string word = token.keyword() == kNoKeyword ? "" : token.name->text;
    if (word.starts_with("sint") || word.starts_with("uint")) {
      take();
      bytes = word.find("32") != std::string::npos ? 4 : word.find("16") != std::string::npos ? 2 : 1;
      big_first = word.ends_with("be");
      continue;
    }
    const Datum datum = parse_value();
    std::string text;
    if (const std::string* value = datum.get<std::string>()) {
      text = *value;
    } else if (const Numbers* numbers = datum.get<Numbers>()) {
      if (bytes > 0) {
        if (!(std::abs(numbers->v[0]) < 0x1p33)) fail(token.where, "this number has no room in its bytes");
        const auto whole = static_cast<std::int64_t>(numbers->v[0]);
        for (std::size_t i = 0; i < bytes; ++i)
          text += static_cast<char>(static_cast<std::uint64_t>(whole) >> 8 * (big_first ? bytes - 1 - i : i));
        bytes = 0;
      } else if (numbers->size == 1) {
        text = written(numbers->v[0]);
      } else {
        for (std::size_t i = 0; i < numbers->size; ++i) text += (i == 0 ? "<" : ",") + written(numbers->v[i]);
        text += "> ";
      }
    } else {
      fail_expected("a number, a vector or a string", token);
    }
    try {
      count_step(token.where, 1 + text.size() / 16);
      file->write(text);
    } catch (const std::string& problem) {
      fail(token.where, "cannot write: " + problem);
    }
  }
}

}  // namespace oktett::pov
