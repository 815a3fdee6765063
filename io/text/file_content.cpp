#include "io/text/file_content.h"

#include "io/text/extension.h"

namespace oktett {

FileContent::FileContent(const std::string& path) {
  mapped_.emplace(path);
  if (!is_packed(path)) return;
  unpacked_.emplace(unpack_gzip(path, mapped_->text(), kPadding));
  mapped_.reset();
}

std::string_view FileContent::text() const {
  return unpacked_ ? std::string_view{unpacked_->data(), unpacked_->size} : mapped_->text();
}

void FileContent::release(const char* begin, const char* end) const {
  if (mapped_) mapped_->release(begin, end);
}

}  // namespace oktett
