#include <sys/resource.h>

#include "io/text/files.h"
#include "tests/io/gltf_test_support.h"

namespace oktett::test::gltf_error_test {
namespace {

/// A good file with a texture, lights, sparse elements and everything else that can be damaged.
std::string good_json() {
  return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":84}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},)"
         R"({"buffer":0,"byteOffset":48,"byteLength":36,"byteStride":12}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5125,"count":3,"type":"SCALAR"},)"
         R"({"bufferView":2,"componentType":5126,"count":3,"type":"VEC3",)"
         R"("sparse":{"count":1,"indices":{"bufferView":1,"componentType":5125},"values":{"bufferView":0}}}],)"
         R"("images":[{"uri":"a.png"}],"textures":[{"source":0}],)"
         R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
         R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],)"
         R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":1}]}},)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":2},"indices":1,"material":0}]}],)"
         R"("nodes":[{"mesh":0},{"camera":0,"children":[2]},{"extensions":{"KHR_lights_punctual":{"light":0}}}],)"
         R"("scenes":[{"nodes":[0,1]}],"scene":0})";
}

std::string good_binary() {
  std::string bytes;
  for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) append_bytes(bytes, x);
  for (const std::uint32_t i : {0u, 1u, 2u}) append_bytes(bytes, i);
  for (int i = 0; i < 9; ++i) append_bytes(bytes, 0.5f);
  return bytes;
}

/// The error of the good file with `part` of its JSON replaced.
std::string error_with(const std::string& part, const std::string& other) {
  const GltfFiles files;
  std::string json = good_json();
  EXPECT_NE(json.find(part), std::string::npos) << part;
  return files.error(glb_of(json.replace(json.find(part), part.size(), other), good_binary()));
}

TEST(GltfError, Json) {
  EXPECT_EQ(error_with("asset", "asset"), "no error");
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{"\"asset\"", "asset"}, "byte 1 of the JSON: expected other text there"},
      {{"\"version\":\"2.0\"", "\"version\":\"1.0\""}, "expected glTF version 2, found '1.0'"},
      {{"\"version\":\"2.0\"", ""}, "expected a glTF file: the version in 'asset' is missing"},
      {{"\"scene\":0", "\"extensionsRequired\":[\"EXT_other\"]"},
       "needs the extension 'EXT_other', which is not known here"},
      {{"\"buffer\":0,\"byteLength\":36", "\"buffer\":1,\"byteLength\":36"},
       "bufferViews[0]: there is no buffer 1: the file has 1"},
      {{"\"byteLength\":84", "\"byteLength\":85"}, "buffers[0]: expected 85 bytes, found 84"},
      {{"\"byteLength\":84", "\"byteLength\":-1"},
       "buffers[0].byteLength: expected a whole number of 0 or more, found -1"},
      {{"\"byteLength\":84", "\"byteLength\":20"},
       "accessors[0]: bufferViews[0]: bytes 0 to 36 of buffer 0, which has 20"},
      {{"\"byteLength\":84", "\"byteLength\":84,\"uri\":\"none.bin\""},
       "none.bin: cannot read: No such file or directory"},
      {{"\"byteLength\":84", "\"byteLength\":84,\"uri\":\"http://a.b/c\""},
       "buffers[0]: expected the path of a file, found 'http://a.b/c'"},
      {{"\"byteLength\":84", "\"byteLength\":84,\"uri\":\"data:x;base64,AAA*\""},
       "buffers[0]: its data URI is not base64 at character 17"},
      {{"\"byteLength\":84", "\"byteLength\":84,\"uri\":\"data:x,AA%41A\""},
       "buffers[0]: expected 84 bytes, found 4"},
      {{"\"byteLength\":84", "\"byteLength\":84,\"uri\":\"data:x\""}, "buffers[0]: expected a data URI"},
      {{"\"byteStride\":12", "\"byteStride\":8"}, "accessors[2]: elements of 12 bytes, but a stride of 8"},
      {{"\"byteStride\":12", "\"byteStride\":256"},
       "bufferViews[2]: a stride of 256 bytes; expected a multiple of 4 that is at most 252"},
      {{"\"byteStride\":12", "\"byteStride\":16"},
       "accessors[2]: 3 elements from byte 0 on do not fit into bufferViews[2], which has 36 bytes"},
      {{"\"count\":3", "\"count\":4"},
       "accessors[0]: 4 elements from byte 0 on do not fit into bufferViews[0], which has 36 bytes"},
      {{"\"count\":3", "\"count\":18446744073709551615"},
       "accessors[0]: 18446744073709551615 elements from byte 0 on do not fit into bufferViews[0], which has "
       "36 bytes"},
      {{"\"bufferView\":0,\"componentType\":5126,\"count\":3", "\"componentType\":5126,\"count\":4000000000"},
       "accessors[0]: 4000000000 elements, but no view that holds them"},
      {{"\"count\":3", "\"byteOffset\":18446744073709551600,\"count\":3"},
       "accessors[0]: 3 elements from byte 18446744073709551600 on do not fit into bufferViews[0], which has "
       "36 bytes"},
      {{"\"bufferView\":0,\"componentType\":5126", "\"bufferView\":7,\"componentType\":5126"},
       "accessors[0]: there is no view 7: the file has 3"},
      {{"\"bufferView\":0,\"componentType\":5126", "\"bufferView\":4294967296,\"componentType\":5126"},
       "accessors[0]: there is no view 4294967296: the file has 3"},
      {{"\"componentType\":5126", "\"componentType\":5124"}, "accessors[0]: unknown component type 5124"},
      {{"\"componentType\":5125,\"count\":3", "\"componentType\":5126,\"count\":3"},
       "accessors[1]: expected whole numbers, the indices of vertices"},
      {{"\"VEC3\"", "\"VEC2\""}, "accessors[0]: expected vectors of 3 numbers, found 2"},
      {{"\"sparse\":{\"count\":1", "\"sparse\":{\"count\":4"},
       "accessors[2]: 4 elements from byte 0 on do not fit into bufferViews[1], which has 12 bytes"},
      {{"\"sparse\":{\"count\":1", "\"sparse\":{\"count\":-4"},
       "accessors[2].sparse.count: expected a whole number of 0 or more, found -4"},
      {{"\"indices\":{\"bufferView\":1", "\"indices\":{\"bufferView\":0,\"byteOffset\":12"},
       "accessors[2]: sparse element 1065353216 is out of range: it has 3"},
      {{"\"POSITION\":0", "\"POSITION\":3"},
       "meshes[0].primitives[0]: there is no accessor 3: the file has 3"},
      {{"\"material\":0", "\"material\":1"},
       "meshes[0].primitives[0]: there is no material 1: the file has 1"},
      {{"\"index\":0", "\"index\":5"}, "materials[0]: there is no texture 5: the file has 1"},
      {{"\"source\":0", "\"source\":5"}, "textures[0]: there is no image 5: the file has 1"},
      {{"\"uri\":\"a.png\"", "\"bufferView\":5"}, "images[0]: there is no view 5: the file has 3"},
      {{"\"baseColorTexture\":{\"index\":0}", "\"metallicFactor\":2"},
       "materials[0]: 'metallicFactor' is out of range"},
      {{"\"intensity\":1", "\"intensity\":-1"}, "lights[0]: its intensity or angles are out of range"},
      {{"\"light\":0", "\"light\":1"}, "nodes[2]: there is no light 1: the file has 1"},
      {{"{\"mesh\":0}", "{\"mesh\":1}"}, "nodes[0]: there is no mesh 1: the file has 1"},
      {{"{\"mesh\":0}", "{\"mesh\":0,\"rotation\":[0,0,0,0]}"},
       "nodes[0]: the quaternion of its rotation is zero or out of range"},
      {{"{\"mesh\":0}", "{\"mesh\":0,\"matrix\":[1,2]}"}, "nodes[0].matrix: expected 16 numbers, found 2"},
      {{"\"children\":[2]", "\"children\":[3]"}, "nodes[1]: there is no node 3: the file has 3"},
      {{"\"children\":[2]", "\"children\":[1]"},
       "nodes[1] is in more than one place; nodes must form a tree"},
      {{"\"children\":[2]", "\"children\":[0]"},
       "nodes[0] is in more than one place; nodes must form a tree"},
      {{"\"nodes\":[0,1]", "\"nodes\":[0,3]"}, "scenes[0]: there is no node 3: the file has 3"},
      {{"\"scene\":0", "\"scene\":1"}, "scene: there is no scene 1: the file has 1"},
  };
  for (const auto& [change, message] : cases) {
    const std::string error = error_with(change.first, change.second);
    EXPECT_TRUE(error == std::string("a.glb: ") + message || error == message)
        << error << "\nexpected: " << message;
  }
}

// A number at its limit is read, the next greater one is an error, and so is one below zero.
TEST(GltfError, FactorsOfMaterialsHaveLimits) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const auto error = [&](std::string material, double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    const std::size_t place = material.find('#');
    return files.error(out.glb("\"materials\":[{" + material.replace(place, 1, text) + "}]," +
                               one_node("{\"attributes\":{\"POSITION\":0},\"material\":0}")));
  };
  struct Factor {
    std::string before, after;  // of the number
    double most;
    std::string name;  // in the message; of a colour, none
  };
  const auto pbr = [](const std::string& key) { return "\"pbrMetallicRoughness\":{\"" + key + "\":"; };
  const auto extension = [](const std::string& name, const std::string& key) {
    return "\"extensions\":{\"KHR_materials_" + name + "\":{\"" + key + "\":";
  };
  std::vector<Factor> factors = {
      {pbr("metallicFactor"), "}", 1, "metallicFactor"},
      {pbr("roughnessFactor"), "}", 1, "roughnessFactor"},
      {pbr("baseColorFactor") + "[1,1,1,", "]}", 1, "baseColorFactor"},
      {"\"alphaCutoff\":", "", 1e30, "alphaCutoff"},
  };
  struct Extension {
    std::string name, key;
    double most;
  };
  for (const Extension& e : {Extension{"emissive_strength", "emissiveStrength", 1e30},
                             {"ior", "ior", 1000},
                             {"transmission", "transmissionFactor", 1},
                             {"volume", "thicknessFactor", 1e30},
                             {"specular", "specularFactor", 1},
                             {"clearcoat", "clearcoatFactor", 1},
                             {"clearcoat", "clearcoatRoughnessFactor", 1},
                             {"anisotropy", "anisotropyStrength", 1},
                             {"iridescence", "iridescenceFactor", 1},
                             {"iridescence", "iridescenceIor", 1000},
                             {"iridescence", "iridescenceThicknessMinimum", 1e5},
                             {"iridescence", "iridescenceThicknessMaximum", 1e5},
                             {"dispersion", "dispersion", 20},
                             {"sheen", "sheenRoughnessFactor", 1}})
    factors.push_back({extension(e.name, e.key), "}}", e.most, e.key});
  for (const auto& [before, after] :
       {std::pair<std::string, std::string>{"", ",1,1"}, {"1,", ",1"}, {"1,1,", ""}}) {
    factors.push_back({pbr("baseColorFactor") + "[" + before, after + ",1]}", 1, ""});
    factors.push_back({"\"emissiveFactor\":[" + before, after + "]", 1e30, ""});
    factors.push_back({extension("sheen", "sheenColorFactor") + "[" + before, after + "]}}", 1, ""});
    factors.push_back({extension("specular", "specularColorFactor") + "[" + before, after + "]}}", 1e30, ""});
  }
  for (const Factor& factor : factors) {
    const std::string material = factor.before + "#" + factor.after;
    const std::string wrong =
        "a.glb: materials[0]: " + (factor.name.empty() ? "expected a colour of three numbers in range"
                                                       : "'" + factor.name + "' is out of range");
    EXPECT_EQ(error(material, 0), "no error") << material;
    EXPECT_EQ(error(material, factor.most), "no error") << material;
    EXPECT_EQ(error(material, std::nextafter(factor.most, INFINITY)), wrong) << material;
    EXPECT_EQ(error(material, -1e-9), wrong) << material;
  }
  // What emits is the product.
  for (const char* color : {"[#,0,0]", "[0,#,0]", "[0,0,#]"})
    EXPECT_EQ(error(std::string("\"emissiveFactor\":") + color + "," +
                        extension("emissive_strength", "emissiveStrength") + "1e20}}",
                    1e20),
              "a.glb: materials[0]: its emission is out of range");
}

TEST(GltfError, Numbers) {
  const GltfFiles files;
  const auto error = [&](std::size_t at, auto value) {
    std::string bytes = good_binary();
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return files.error(glb_of(good_json(), bytes));
  };
  EXPECT_EQ(error(16, std::nanf("")), "a.glb: accessors[0]: element 1: expected a finite number, found nan");
  EXPECT_EQ(error(32, 2e30f),
            "a.glb: accessors[0]: element 2: coordinate out of range: 2e+30 (magnitude at most 1e30)");
  EXPECT_EQ(error(40, std::uint32_t{3}),
            "a.glb: accessors[1]: element 1: vertex index 3 is out of range: there are 3 vertices");
  EXPECT_EQ(error(80, -INFINITY), "a.glb: accessors[2]: element 2: expected a finite number, found -inf");
}

TEST(GltfError, TextFilesSayTheLine) {
  const GltfFiles files;
  EXPECT_EQ(files.error("{\"asset\":\n{\"version\" 2}}", "a.gltf"),
            "a.gltf:2:12: expected other JSON text here");
  EXPECT_EQ(files.error("", "a.gltf"), "a.gltf:1:1: expected other JSON text here");
  EXPECT_EQ(files.error("[]", "a.gltf"), "a.gltf: expected a JSON object that describes a glTF scene");
  EXPECT_EQ(files.error(std::string(100000, '['), "a.gltf"),
            "a.gltf: the JSON is nested deeper than 64 levels");
}

TEST(GltfError, Chunks) {
  const GltfFiles files;
  const std::string good = glb_of(good_json(), good_binary());
  EXPECT_EQ(files.error(good), "no error");
  for (std::size_t size = 4; size < good.size(); size += 7)
    EXPECT_NE(files.error(good.substr(0, size)), "no error") << size;
  EXPECT_EQ(files.error(good.substr(0, 11)), "a.glb: the file ends within its header, at byte 11");
  const auto changed = [&](std::size_t at, std::uint32_t value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return files.error(bytes);
  };
  const std::string size = std::to_string(good.size());
  EXPECT_EQ(changed(4, 1), "a.glb: expected version 2 of the format, found 1");
  EXPECT_EQ(changed(8, 0xffffffff),
            "a.glb: byte 8: the file should have 4294967295 bytes, but ends at byte " + size);
  EXPECT_EQ(changed(8, 12), "a.glb: expected a chunk with the JSON behind the header");
  EXPECT_EQ(changed(12, 0xfffffff0),
            "a.glb: byte 12: a chunk of 4294967280 bytes, but the file ends at byte " + size);
  EXPECT_EQ(changed(16, 7), "a.glb: byte 16: expected the chunk with the JSON first");
}

// A few bytes that ask for much get an error, not the memory.
TEST(GltfError, NothingIsAllocatedThatTheFileDoesNotJustify) {
  const GltfFiles files;
  with_little_memory([&] {
    // Nodes that show the same mesh as one.
    GltfWriter out;
    std::vector<std::uint8_t> corners(30000, 0);
    out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    out.array(corners, kUint8, "SCALAR", 1);
    std::string nodes, numbers;
    for (int i = 0; i < 3000; ++i) {
      nodes += i == 0 ? "{\"mesh\":0}" : ",{\"mesh\":0}";
      numbers += (i == 0 ? "" : ",") + std::to_string(i);
    }
    const std::string rest =
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"nodes\":[" +
        nodes + "],\"scenes\":[{\"nodes\":[" + numbers + "]}]";
    EXPECT_EQ(files.error(out.glb(rest)),
              "a.glb: its objects show 30000000 triangles, of which 10000 are different; too many for one "
              "mesh, but "
              "'include' keeps them as instances");
    EXPECT_EQ(files.scene(out.glb(rest)).placements.size(), 3000u);
    // Primitives that share the indices.
    std::string primitives;
    for (int i = 0; i < 3000; ++i)
      primitives += std::string(i == 0 ? "" : ",") + "{\"attributes\":{\"POSITION\":0},\"indices\":1}";
    EXPECT_NE(files.error(out.glb(one_node(primitives))).find("too many for"), std::string::npos);
  });
}

// Buffers and images stand where scenes may read files from.
TEST(GltfError, FilesOutsideOfTheRootAreRefused) {
  const GltfFiles files;
  EXPECT_EXIT(
      {
        std::filesystem::create_directory(files.files.dir.file("in"));
        files.files.dir.write("out.bin", good_binary());
        std::string json = good_json();
        const std::string part = "\"byteLength\":84";
        json.replace(json.find(part), part.size(), part + ",\"uri\":\"../out.bin\"");
        const std::string path = files.files.dir.write("in/a.gltf", json);
        confine_files(files.files.dir.file("in"));
        try {
          load_mesh(path);
        } catch (const Error& e) {
          std::fputs(e.what(), stderr);
          std::_Exit(3);
        }
        std::_Exit(0);
      },
      testing::ExitedWithCode(3), "it lies outside of the folder that files may be read from");
}

// What the specification forbids, but leaves no doubt or nothing to see.

/// The warnings of a triangle with morph targets whose JSON holds `mesh` and `rest`.
std::vector<std::string> warnings_with(const std::string& primitive, const std::string& mesh,
                                       const std::string& rest) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.array(std::vector<std::uint8_t>(12), kUint8, "VEC4", 4);
  out.array(std::vector<float>(12), kFloat, "VEC4", 4);
  return files.warnings(out.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0" + primitive +
                                "}]" + mesh + "}]," + rest));
}

TEST(GltfError, WhatIsForbiddenButReadIsSaid) {
  const std::string node = "\"nodes\":[{\"mesh\":0}]";
  const std::string targets = "},\"targets\":[{\"POSITION\":0}]";
  using Lines = std::vector<std::string>;
  const auto said = [](const std::string& what) { return Lines{"a.glb: warning: " + what}; };
  EXPECT_EQ(warnings_with("}", "", node), Lines{});
  const std::string place = "meshes[0].primitives[0]: ";
  EXPECT_EQ(warnings_with(",\"OTHER\":0}", "", node), said(place + "the attribute 'OTHER' is not known"));
  EXPECT_EQ(warnings_with(",\"COLOR_00\":2}", "", node),
            said(place + "the attribute 'COLOR_00' is not known"));
  EXPECT_EQ(warnings_with(",\"JOINTS_0\":1}", "", node),
            said(place + "JOINTS_0 and WEIGHTS_0 belong together; the one that is there is not read"));
  EXPECT_EQ(warnings_with(",\"JOINTS_0\":1,\"WEIGHTS_0\":2,\"WEIGHTS_1\":2}", "", node),
            said(place + "JOINTS_1 and WEIGHTS_1 belong together; the one that is there is not read"));
  EXPECT_EQ(warnings_with(targets, ",\"weights\":[0,0]", node),
            said("meshes[0]: 2 weights for 1 morph targets; the last ones are left out"));
  EXPECT_EQ(warnings_with(targets, "", "\"nodes\":[{\"mesh\":0,\"weights\":[0,0,0]}]"),
            said("nodes[0]: 3 weights for 1 morph targets; the last ones are left out"));
  EXPECT_EQ(warnings_with(targets + "},{\"attributes\":{\"POSITION\":0}", "", node),
            said("meshes[0]: its primitives have different numbers of morph targets"));
  EXPECT_EQ(
      warnings_with("}", "", "\"nodes\":[{\"mesh\":0},{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]"),
      said("scenes[0]: nodes[0] is a child of nodes[1], with which it moves"));
  const std::string matrix = "\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,";
  EXPECT_EQ(warnings_with("}", "", "\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2]," + matrix + "1]}]"),
            said("nodes[0]: its scale is not read, as it has a matrix"));
  EXPECT_EQ(warnings_with("}", "", "\"nodes\":[{\"mesh\":0," + matrix + "2]}]"),
            said("nodes[0]: the last row of its matrix is not 0, 0, 0, 1, as which it is read"));
  EXPECT_EQ(warnings_with("}", "", "\"nodes\":[{\"mesh\":0," + matrix + "0.99999997]}]"), Lines{});
  EXPECT_EQ(warnings_with("}", "",
                          "\"nodes\":[{\"mesh\":0," + matrix +
                              "1]}],\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,"
                              "\"path\":\"scale\"}}],\"samplers\":[{\"input\":0,\"output\":0}]}]"),
            said("animations[0].channels[0]: nodes[0] has a matrix; it is not animated"));
}

// The greatest number of a type ends a strip elsewhere.
TEST(GltfError, IndicesThatMustNotBeUsedAreSaid) {
  const GltfFiles files;
  for (const bool is_short : {false, true})
    for (const int less : {0, 1}) {
      const std::uint32_t greatest = is_short ? 0xffff : 0xff;
      GltfWriter out;
      std::vector<Vec3f> points(greatest + 1, Vec3f{0, 0, 0});
      points[greatest - static_cast<std::uint32_t>(less)] = {1, 0, 0}, points[1] = {0, 1, 0};
      out.vectors(points);
      const std::uint32_t last = greatest - static_cast<std::uint32_t>(less);
      is_short
          ? out.array(std::vector<std::uint16_t>{0, static_cast<std::uint16_t>(last), 1}, kUint16, "SCALAR",
                      1)
          : out.array(std::vector<std::uint8_t>{0, static_cast<std::uint8_t>(last), 1}, kUint8, "SCALAR", 1);
      const MeshFile file = files.load(out.glb(one_node("{\"attributes\":{\"POSITION\":0},\"indices\":1}")));
      EXPECT_EQ(file.mesh.triangle_count(), 1u);
      EXPECT_EQ(files.files.as_text(file.warnings),
                less == 1
                    ? std::vector<std::string>{}
                    : std::vector<std::string>{
                          "a.glb: warning: meshes[0].primitives[0]: the index " + std::to_string(greatest) +
                          " of its type, which must not be used, is read as that of a vertex"});
    }
}

}  // namespace
}  // namespace oktett::test::gltf_error_test
