#pragma once
/// \file Packages of 3MF files, made by libzip of texts that are written by hand.

#include <zip.h>

#include <map>
#include <string>

namespace oktett::test {

/// Contents by names.
using PackageParts = std::map<std::string, std::string>;

/// Writes a ZIP archive of these files; whether that was possible. `compression`: ZIP_CM_DEFAULT, or
/// ZIP_CM_STORE for none.
inline bool pack_parts(const std::string& path, const PackageParts& parts, int compression = ZIP_CM_DEFAULT) {
  zip_t* const archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  if (archive == nullptr) return false;
  for (const auto& [name, content] : parts) {
    zip_source_t* const source = zip_source_buffer(archive, content.data(), content.size(), 0);
    const zip_int64_t entry = zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (entry < 0 ||
        zip_set_file_compression(archive, static_cast<zip_uint64_t>(entry), compression, 0) != 0) {
      zip_discard(archive);
      return false;
    }
  }
  return zip_close(archive) == 0;
}

inline const std::string kRelationships = "http://schemas.openxmlformats.org/package/2006/relationships";

/// The files of a package with this text of the model.
inline PackageParts threemf_parts(const std::string& model) {
  return {
      {"[Content_Types].xml",
       "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
       "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
       "<Default Extension=\"rels\" "
       "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
       "<Default Extension=\"png\" ContentType=\"image/png\"/>"
       "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
       "</Types>"},
      {"_rels/.rels",
       "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"" + kRelationships +
           "\"><Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
           "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
      {"3D/3dmodel.model", model}};
}

/// The same with an image /3D/Textures/wood.png of these bytes.
inline PackageParts with_image(PackageParts parts, const std::string& content) {
  parts["3D/Textures/wood.png"] = content;
  parts["3D/_rels/3dmodel.model.rels"] =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"" + kRelationships +
      "\"><Relationship Target=\"/3D/Textures/wood.png\" Id=\"rel1\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture\"/></Relationships>";
  return parts;
}

}  // namespace oktett::test
