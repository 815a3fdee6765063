#include <Imath/half.h>
#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfName.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <exception>
#include <list>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "io/image/encode.h"

namespace oktett {
namespace {

using Imath::half;

/// Level 2 of zlib takes half the time of its default, 6, and makes files that are a few percent larger.
constexpr int kLevel = 2;

/// OpenEXR's threads are those of the process. A program that has chosen their number keeps it.
int thread_count() {
  static const int count = [] {
    if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(tbb::this_task_arena::max_concurrency());
    return Imf::globalThreadCount();
  }();
  return count;
}

/// Keeps the last error, because OpenEXR writes the last bytes in a destructor, which drops exceptions.
class Stream final : public Imf::OStream {
 public:
  explicit Stream(OutputFile& file) : OStream("the picture"), file_(file) {}

  void write(const char bytes[], int count) override {
    try {
      file_.write({bytes, static_cast<std::size_t>(count)});
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
  }
  std::uint64_t tellp() override { return file_.place(); }
  void seekp(std::uint64_t place) override { file_.seek(place); }
  void rethrow_failure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  OutputFile& file_;
  std::exception_ptr failure_;
};

/// The local time in the form of OpenEXR's standard attribute.
std::string date() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y:%m:%d %H:%M:%S", &local)};
}

/// Adds an attribute, by its type.
struct AddTo {
  Imf::Header& header;
  const std::string& name;

  void operator()(const std::string& text) const { header.insert(name, Imf::StringAttribute(text)); }
  void operator()(std::int32_t number) const { header.insert(name, Imf::IntAttribute(number)); }
  void operator()(float number) const { header.insert(name, Imf::FloatAttribute(number)); }
  void operator()(const Matrix4& matrix) const {
    Imath::M44f rows;
    std::memcpy(rows.x, matrix.data(), sizeof rows.x);
    header.insert(name, Imf::M44fAttribute(rows));
  }
  void operator()(const Vec3d& v) const { header.insert(name, Imf::V3dAttribute({v.x, v.y, v.z})); }
};

/// The corners (x, y) and (x + width - 1, y + height - 1).
Imath::Box2i box(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height) {
  return {{static_cast<int>(x), static_cast<int>(y)},
          {static_cast<int>(x + width - 1), static_cast<int>(y + height - 1)}};
}

Imf::Header header(const Picture& picture, const std::vector<Attribute>& attributes) {
  const bool framed = picture.full_width > 0 && picture.full_height > 0;
  Imf::Header header(
      box(0, 0, framed ? picture.full_width : picture.width, framed ? picture.full_height : picture.height),
      box(picture.x, picture.y, picture.width, picture.height));
  header.zipCompressionLevel() = kLevel;
  header.insert("capDate", Imf::StringAttribute(date()));
  for (const auto& [name, text] : picture.attributes) header.insert(name, Imf::StringAttribute(text));
  for (const Attribute& attribute : attributes) std::visit(AddTo{header, attribute.name}, attribute.value);
  return header;
}

/// Whether a finite value is too large for half: such light would be lost.
bool exceeds_half(const PicturePlane& plane) {
  // What rounds to HALF_MAX does not.
  constexpr float kLeast = 65520;
  const auto large = [](float v) { return std::abs(v) >= kLeast && std::isfinite(v); };
  return plane.type == PlaneType::half_float && std::ranges::any_of(plane.values, large);
}

/// The nearest halves, of two equally near ones the even one.
Column<half> to_halves(const Column<float>& values) {
  const auto nearest = [](float v) { return half(v); };
  Column<half> halves(values.size());
  in_parts(values.size(), std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
    std::transform(values.begin() + begin, values.begin() + end, halves.begin() + begin, nearest);
  });
  return halves;
}

void write(Stream& stream, const Picture& picture, const std::vector<Attribute>& attributes) {
  Imf::Header head = header(picture, attributes);
  Imf::FrameBuffer pixels;
  std::list<Column<half>> halves;
  // All of them, as programs expect the same type of red, green and blue.
  const bool wide = std::ranges::any_of(picture.planes, exceeds_half);
  for (const PicturePlane& plane : picture.planes) {
    const std::string& name = plane.name;
    if (name.empty() || name.size() > Imf::Name::MAX_LENGTH || name.find('\0') != std::string::npos)
      throw Error("a plane's name must have 1 to 255 characters");
    if (head.channels().findChannel(name) != nullptr) throw Error("the picture has two planes named " + name);
    const auto add = [&](Imf::PixelType type, const auto* numbers) {
      head.channels().insert(name, Imf::Channel(type));
      pixels.insert(name, Imf::Slice::Make(type, numbers, head.dataWindow()));
    };
    if (plane.type == PlaneType::unsigned_int)
      add(Imf::UINT, plane.ids.data());
    else if (wide || plane.type == PlaneType::single_float)
      add(Imf::FLOAT, plane.values.data());
    else
      add(Imf::HALF, halves.emplace_back(to_halves(plane.values)).data());
  }
  Imf::OutputFile output(stream, head, thread_count());
  output.setFrameBuffer(pixels);
  output.writePixels(static_cast<int>(picture.height));
}

}  // namespace

void write_exr(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes) {
  Stream stream(file);
  try {
    write(stream, picture, attributes);
  } catch (const Iex::BaseExc& error) {
    stream.rethrow_failure();
    throw Error(std::string("cannot write the EXR: ") + error.what(), ErrorKind::io);
  }
  stream.rethrow_failure();
}

}  // namespace oktett
