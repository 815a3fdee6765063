#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/image/image.h"
#include "io/image/output.h"
#include "tests/support/temp_dir.h"

namespace oktett::write_image_test {
namespace {

using test::TempDir;

Picture empty_picture(std::uint32_t width, std::uint32_t height) {
  Picture picture;
  picture.width = picture.full_width = width;
  picture.height = picture.full_height = height;
  return picture;
}

/// A plane of random bits, among them NaN, infinities and denormals, or of numbers that grow slowly.
PicturePlane plane(const std::string& name, PlaneType type, std::size_t pixels, bool noise) {
  static std::mt19937 random(7);
  PicturePlane result{name, type, {}, {}};
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t bits =
        noise ? static_cast<std::uint32_t>(random()) : 0x3f000000u + 64u * static_cast<std::uint32_t>(i);
    if (type == PlaneType::unsigned_int)
      result.ids.push_back(bits);
    else
      result.values.push_back(std::bit_cast<float>(bits));
  }
  return result;
}

/// Whether a value of half is finite, but none of half.
bool has_large(const Picture& picture) {
  for (const PicturePlane& plane : picture.planes)
    for (const float v : plane.values)
      if (plane.type == PlaneType::half_float && std::isfinite(v) && std::abs(v) >= 65520) return true;
  return false;
}

/// What OpenImageIO's own conversion makes of `value`.
std::uint16_t half_of(float value) {
  std::uint16_t half = 0;
  OIIO::convert_pixel_values(OIIO::TypeFloat, &value, OIIO::TypeHalf, &half, 1);
  return half;
}

/// Expects every channel of an EXR file to hold the bits of the plane of its name.
void expect_planes(const std::string& path, const Picture& picture) {
  const auto input = OIIO::ImageInput::open(path);
  ASSERT_TRUE(input) << OIIO::geterror();
  const OIIO::ImageSpec spec = input->spec();
  ASSERT_EQ(static_cast<std::size_t>(spec.nchannels), picture.planes.size());
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  const bool wide = has_large(picture);
  for (const PicturePlane& expected : picture.planes) {
    const int channel = spec.channelindex(expected.name);
    ASSERT_GE(channel, 0) << expected.name;
    const OIIO::TypeDesc type = spec.channelformat(channel);
    std::vector<std::uint8_t> bytes(pixels * type.size());
    ASSERT_TRUE(input->read_image(0, 0, channel, channel + 1, type, bytes.data())) << input->geterror();
    if (expected.type == PlaneType::half_float && !wide) {
      ASSERT_EQ(type, OIIO::TypeHalf);
      for (std::size_t i = 0; i < pixels; ++i) {
        std::uint16_t half;
        std::memcpy(&half, &bytes[i * 2], 2);
        ASSERT_EQ(half, half_of(expected.values[i]))
            << expected.name << " " << i << " " << expected.values[i];
      }
    } else {
      const bool ids = expected.type == PlaneType::unsigned_int;
      ASSERT_EQ(type, ids ? OIIO::TypeUInt32 : OIIO::TypeFloat);
      const void* numbers = ids ? static_cast<const void*>(&expected.ids[0]) : &expected.values[0];
      ASSERT_EQ(std::memcmp(bytes.data(), numbers, bytes.size()), 0) << expected.name;
    }
  }
}

// Blocks hold 16 rows. Smooth planes are compressed; noise makes blocks that are stored as they are.
TEST(WriteExr, EverySizeIsReadBackBitByBit) {
  const TempDir dir;
  for (const bool noise : {false, true})
    for (const std::uint32_t width : {1u, 2u, 33u, 500u})
      for (const std::uint32_t height : {1u, 15u, 16u, 17u, 1500u}) {
        Picture picture = empty_picture(width, height);
        const std::size_t pixels = std::size_t{width} * height;
        picture.planes.push_back(plane("R", PlaneType::half_float, pixels, noise));
        picture.planes.push_back(plane("N.X", PlaneType::single_float, pixels, noise));
        picture.planes.push_back(plane("primID.I", PlaneType::unsigned_int, pixels, noise));
        write_image(dir.file("a.exr"), picture);
        expect_planes(dir.file("a.exr"), picture);
      }
}

// Every half, what lies midway between two, and the floats beside these.
TEST(WriteExr, HalvesAreTheNearestOnes) {
  const TempDir dir;
  Picture picture = empty_picture(1, 1);
  PicturePlane halves{"Y", PlaneType::half_float, {}, {}};
  const auto value_of = [](std::uint32_t half) {
    return std::ldexp(static_cast<float>(half < 1024 ? half : 1024 + half % 1024),
                      static_cast<int>(half < 1024 ? 0 : half / 1024 - 1) - 24);
  };
  for (std::uint32_t half = 0; half < 0x7c00; ++half) {
    const float value = value_of(half), middle = 0.5f * value + 0.5f * value_of(half + 1);
    for (const float v : {value, middle, std::nextafter(middle, 0.0f), std::nextafter(middle, 1e9f)}) {
      // From there on light is kept in single precision.
      if (v >= 65520) continue;
      halves.values.push_back(v);
      halves.values.push_back(-v);
    }
  }
  picture.height = picture.full_height = static_cast<std::uint32_t>(halves.values.size());
  picture.planes.push_back(std::move(halves));
  write_image(dir.file("a.exr"), picture);
  expect_planes(dir.file("a.exr"), picture);
}

TEST(WriteExr, NamesOfPlanesMayBeLongAndMustDiffer) {
  const TempDir dir;
  Picture picture = empty_picture(3, 2);
  picture.planes.push_back(plane(std::string(31, 'a'), PlaneType::single_float, 6, false));
  picture.planes.push_back(plane(std::string(200, 'a'), PlaneType::half_float, 6, false));
  write_image(dir.file("a.exr"), picture);
  expect_planes(dir.file("a.exr"), picture);
  for (const std::string& name : {std::string(31, 'a'), std::string(256, 'a'), std::string()}) {
    picture.planes[1].name = name;
    EXPECT_THROW(write_image(dir.file("b.exr"), picture), Error);
  }
  EXPECT_FALSE(std::filesystem::exists(dir.file("b.exr")));
}

// As OpenImageIO reads it.
TEST(WritePng, EverySizeIsReadBack) {
  const TempDir dir;
  for (const std::uint32_t width : {1u, 700u, 100000u})
    for (const std::uint32_t height : {1u, 93u, 94u, 187u, 400u}) {
      if (std::size_t{width} * height > 2000000) continue;
      for (const char* names : {"RGB", "RGBA"}) {
        Picture picture = empty_picture(width, height);
        const std::size_t pixels = std::size_t{width} * height, channels = std::strlen(names);
        std::vector<std::uint8_t> expected(pixels * channels);
        for (std::size_t c = 0; c < channels; ++c) {
          picture.planes.push_back(
              {std::string(1, names[c]), PlaneType::half_float, Column<float>(pixels), {}});
          for (std::size_t i = 0; i < pixels; ++i) {
            const std::uint8_t byte =
                static_cast<std::uint8_t>(c == 3 ? 255 : (i * 7 + i / 256 * (c + 1)) % 256);
            const double v = byte / 255.0;
            picture.planes[c].values[i] =
                static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
            if (c == 3) picture.planes[c].values[i] = 1;
            expected[i * channels + c] = byte;
          }
        }
        write_image(dir.file("a.png"), picture);
        const auto input = OIIO::ImageInput::open(dir.file("a.png"));
        ASSERT_TRUE(input) << OIIO::geterror();
        ASSERT_EQ(input->spec().nchannels, static_cast<int>(channels));
        std::vector<std::uint8_t> read(expected.size());
        ASSERT_TRUE(input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeUInt8, read.data()))
            << input->geterror();
        ASSERT_EQ(read, expected) << width << " x " << height;
      }
    }
}

// As OpenImageIO, another library, reads it: texts, and the curve of the colours.
TEST(WritePng, TextsAndColourSpaceAreWritten) {
  const TempDir dir;
  Picture picture = empty_picture(1, 1);
  for (const char* name : {"R", "G", "B"})
    picture.planes.push_back(plane(name, PlaneType::half_float, 1, false));
  ImageMetadata metadata;
  metadata.software = "oktett 1.2.3";
  metadata.command_line = "oktett render ä.yaml";
  metadata.scene = "ä.yaml";
  metadata.samples = 3;
  for (const char* name : {"a.png", "A.PNG", "a.tif"}) {
    write_image(dir.file(name), picture, metadata);
    const OIIO::ImageSpec spec = OIIO::ImageInput::open(dir.file(name))->spec();
    EXPECT_EQ(spec.get_string_attribute("oiio:ColorSpace"), "sRGB") << name;
    EXPECT_EQ(spec.get_string_attribute("Software"), metadata.software) << name;
    if (std::string(name) == "a.tif") continue;
    EXPECT_EQ(spec.get_string_attribute("commandLine"), metadata.command_line) << name;
    EXPECT_EQ(spec.get_string_attribute("scene"), metadata.scene) << name;
  }
}

// The limit of a file's size stands for a disk that is full.
TEST(WriteImage, AFullDiskLeavesTheOldFileAndNoTemporary) {
  const TempDir dir;
  Picture picture = empty_picture(100, 100);
  for (const char* name : {"R", "G", "B"})
    picture.planes.push_back(plane(name, PlaneType::single_float, 10000, true));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  // The error where a file may have so many bytes. The old file must stay.
  const auto error_at = [&](const std::string& name, rlim_t bytes) {
    const std::string path = dir.write(name, "old");
    const rlimit full{bytes, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &full);
    std::string message;
    try {
      write_image(path, picture);
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::io) message = e.what();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(test::file_content(path), "old");
    return message;
  };
  for (const char* name : {"a.png", "a.exr", "a.hdr", "a.bmp", "a.tga", "a.jpg", "a.webp", "a.ppm", "a.gif"})
    for (const rlim_t bytes : {0, 10, 500, 3000}) {
      const std::string path = dir.file(name);
      EXPECT_EQ(error_at(name, bytes), path + ": cannot write: File too large") << bytes;
    }
  // Writers of these formats write by name. Whether they notice it themselves depends on them.
  for (const char* name : {"a.tif", "a.sgi", "a.rla", "a.fits", "a.ico"})
    for (const rlim_t bytes : {0, 10, 500, 3000, 4096}) {
      const std::string path = dir.file(name), message = error_at(name, bytes);
      EXPECT_EQ(message.find(path + ": cannot write: "), 0u) << message << " " << bytes;
    }
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(test::file_count(dir), 14u);
}

constexpr mode_t kMasks[] = {0, 022, 027, 0077};

mode_t permissions(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_mode & 07777 : ~mode_t{0};
}

// As those of all files that programs make. TIFF is written by the name of the temporary.
TEST(WriteImage, FilesHaveThePermissionsThatTheUmaskLeaves) {
  const TempDir dir;
  Picture picture = empty_picture(8, 8);
  for (const char* name : {"R", "G", "B"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(64, 0.5f), {}});
  for (const mode_t mask : kMasks) {
    const mode_t before = umask(mask);
    for (const char* name : {"a.png", "a.exr", "a.jpg", "a.tif"}) {
      EXPECT_NO_THROW(write_image(dir.file(name), picture));
      EXPECT_EQ(permissions(dir.file(name)), 0666 & ~mask) << name << " " << mask;
    }
    OutputFile file(dir.file("a.txt"));
    file.write("text");
    file.commit_unflushed(0);
    EXPECT_EQ(permissions(dir.file("a.txt")), 0666 & ~mask) << mask;
    umask(before);
  }
}

/// From now on this process cannot create files without a name, as on file systems that have none. False if
/// the system has no such filters.
bool forbid_unnamed_files() {
  constexpr std::uint32_t kFlags =
      offsetof(seccomp_data, args[2]) + (std::endian::native == std::endian::big ? sizeof(std::uint32_t) : 0);
  sock_filter steps[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_openat, 0, 3),
                         BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kFlags),
                         BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, O_TMPFILE & ~O_DIRECTORY, 0, 1),
                         BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EOPNOTSUPP),
                         BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const sock_fprog program{static_cast<unsigned short>(std::size(steps)), steps};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0 &&
         open(".", O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600) < 0 && errno == EOPNOTSUPP;
}

// The temporary has a name from the start, beside the file.
TEST(WriteImage, FileSystemsWithoutUnnamedFilesWillDo) {
  const TempDir dir;
  constexpr int kSkipped = 77;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (!forbid_unnamed_files()) _exit(kSkipped);
    int faults = 0;
    try {
      for (const mode_t mask : kMasks) {
        umask(mask);
        {
          OutputFile dropped(dir.file("a.txt"));
          faults += test::file_count(dir) != (mask == kMasks[0] ? 1u : 2u);
        }
        OutputFile file(dir.file("a.txt"));
        file.write("text");
        file.commit();
        faults += permissions(dir.file("a.txt")) != (0666 & ~mask);
        faults += test::file_content(dir.file("a.txt")) != "text" || test::file_count(dir) != 1;
      }
    } catch (const Error&) {
      ++faults;
    }
    _exit(faults);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kSkipped)
    GTEST_SKIP() << "this system has no seccomp filters";
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "number of faults";
}

// The same pixels as a writer gives that has a file's name.
TEST(WriteImage, WritersInMemoryMakeWholeFiles) {
  const TempDir dir;
  Picture picture = empty_picture(31, 33);
  int formats = 0;
  for (const char* name : {"R", "G", "B"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(31 * 33, 0.5f), {}});
  for (const char* extension :
       {"hdr", "bmp", "tga", "jpg", "webp", "ppm", "gif", "dpx", "iff", "tif", "sgi", "rla", "fits", "ico"}) {
    const std::string path = dir.file(std::string("a.") + extension);
    if (OIIO::ImageOutput::create(path) == nullptr) continue;
    ++formats;
    write_image(path, picture);
    const Picture read = read_image(path);
    ASSERT_EQ(read.width, 31u) << extension;
    ASSERT_EQ(read.height, 33u) << extension;
    const PicturePlane* green = read.find("G");
    ASSERT_NE(green, nullptr) << extension;
    for (const float v : green->values) ASSERT_NEAR(v, 0.5f, 0.02f) << extension;
  }
  EXPECT_GE(formats, 8);
}

}  // namespace
}  // namespace oktett::write_image_test
