#include "io/image/oiio/library.h"

/// The one symbol that the shared library shows; kImageLibraryEntry names it.
extern "C" __attribute__((visibility("default"))) const oktett::ImageLibrary* oktett_image_library();

const oktett::ImageLibrary* oktett_image_library() {
  static const oktett::oiio::OpenImageIoLibrary library;
  return &library;
}
