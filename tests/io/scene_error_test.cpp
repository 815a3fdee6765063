#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_error_test {
namespace {

using test::expect_errors;
using test::expect_starts;
using test::SceneFiles;

TEST(SceneError, FilesThatCannotBeRead) {
  SceneFiles files;
  const auto expect = [&](const std::string& path, const std::string& message) {
    try {
      load_scene_file(path);
      ADD_FAILURE() << path;
    } catch (const Error& e) {
      EXPECT_EQ(files.without_directory(e.what()), message);
      EXPECT_EQ(e.kind(), ErrorKind::io);
    }
  };
  expect(files.dir.file("none.yaml"), "none.yaml: no such file");
  std::filesystem::create_directory(files.dir.path() / "dir.yaml");
  expect(files.dir.file("dir.yaml"), "dir.yaml: is a directory");
  expect("/dev/zero", "/dev/zero: is not a regular file");
  if (geteuid() != 0) {
    const std::string secret = files.dir.write("secret.yaml", "oktett: 1\n");
    std::filesystem::permissions(secret, std::filesystem::perms::none);
    expect(secret, "secret.yaml: permission denied");
  }
}

TEST(SceneError, TextThatIsNoScene) {
  SceneFiles files;
  const auto expect = [&](const std::string& text, const std::string& message) {
    SCOPED_TRACE(text);
    expect_starts(files.error(text), message);
  };
  expect("", "scene.yaml:1:1: the file is empty");
  expect("# nothing\n\n", "scene.yaml:1:1: the file is empty");
  expect("hello", "scene.yaml:1:1: expected a map that begins with 'oktett: 1', found 'hello'");
  expect("[1, 2]", "scene.yaml:1:1: expected a map that begins with 'oktett: 1', found a list");
  expect("oktett: 1\ncamera: [1, 2\n", "scene.yaml:3:1: not valid YAML: ");
  expect("oktett: 1\n  film: {}\n", "scene.yaml:2:7: not valid YAML: ");
  expect("oktett: 1\nfilm: {width: *w}\n", "scene.yaml:2:15: not valid YAML: ");
  expect("oktett: 1\nfilm: {a: \"abc\n", "scene.yaml:3:1: not valid YAML: ");
  expect("oktett: 1\nfilm: !!map {}\n", "scene.yaml:2:7: tags are not supported");
  expect("oktett: 1\n---\noktett: 1\n", "scene.yaml:2:1: a second document starts here");
  expect("oktett: 1\n? [a]\n: b\n", "scene.yaml:2:3: expected a name as key, found a list");
  expect(std::string("\x7f"
                     "ELF\x02\x01\0\0",
                     8),
         "scene.yaml:1:1: not a text file: byte 0x7f");
  expect(std::string("oktett: 1\nfilm: \0", 17), "scene.yaml:2:7: not a text file: byte 0x00");
  expect("oktett: 1\nfilm: \x04", "scene.yaml:2:7: not a text file: byte 0x04");
  for (const char* bad :
       {"\xff", "\xc0\xaf", "\xed\xa0\x80", "\xe2\x82", "\xf5\x80\x80\x80", "\x80", "\xf0\x80\x80\x80"})
    expect(std::string("oktett: 1\n# \xc3\xa9 ") + bad, "scene.yaml:2:5: not UTF-8 text: byte 0x");
}

/// Columns count characters, not bytes, so that an editor goes to the right place.
TEST(SceneError, ColumnsCountCharacters) {
  expect_errors(
      {{"objects: [{name: \"h\xc3\xa9t\xc3\xa9\", spere: {}}]", "scene.yaml:2:26: unknown key 'spere'"},
       {"objects: [{name: \"\xf0\x9f\x90\x87\", sphere: {radius: x}}]",
        "scene.yaml:2:40: expected a number"}});
  SceneFiles files;
  expect_starts(files.error("\xef\xbb\xbfoktett: 2\n"),
                "scene.yaml:1:9: expected format version 1, found '2'");
  expect_starts(files.error("oktett: 1\r\nfilm: {with: 3}\r\n"),
                "scene.yaml:2:8: unknown key 'with' in film; did you");
}

TEST(SceneError, FormatVersion) {
  SceneFiles files;
  EXPECT_EQ(files.error("film: {}\n"), "scene.yaml:1:1: the format version is missing: expected 'oktett: 1'");
  EXPECT_EQ(files.error("film: {}\noktett: 2\n"), "scene.yaml:2:9: expected format version 1, found '2'");
  EXPECT_EQ(files.error("oktett: [1]\n"), "scene.yaml:1:9: expected format version 1, found a list");
  EXPECT_EQ(files.error("oktett:\n"), "scene.yaml:1:1: expected format version 1, found nothing");
}

TEST(SceneError, UnknownKeysNameTheNearest) {
  expect_errors({
      {"camra: {}", "scene.yaml:2:1: unknown key 'camra' in a scene; did you mean 'camera'?"},
      {"camera: {form: [0, 0, 1]}", "scene.yaml:2:10: unknown key 'form' in camera; did you mean 'from'?"},
      {"film: {with: 3}", "scene.yaml:2:8: unknown key 'with' in film; did you mean 'width'?"},
      {"integrator: {sample: 3}",
       "scene.yaml:2:14: unknown key 'sample' in integrator; did you mean 'samples'?"},
      {"materials: {a: {colour: [1, 1, 1]}}",
       "scene.yaml:2:17: unknown key 'colour' in a material; did you mean 'color'?"},
      {"lights: [{area: {}}]",
       "scene.yaml:2:11: unknown key 'area' in a light; known are point, spot, directional, "},
      {"lights: [{pont: {}}]", "scene.yaml:2:11: unknown key 'pont' in a light; did you mean 'point'?"},
      {"lights: [{point: {positon: [0,0,0]}}]",
       "scene.yaml:2:19: unknown key 'positon' in a point light; did you mean"},
      {"objects: [{spher: {}}]", "scene.yaml:2:12: unknown key 'spher' in an object; did you mean 'sphere'?"},
      {"objects: [{qqqqqqq: {}}]",
       "scene.yaml:2:12: unknown key 'qqqqqqq' in an object; shapes are mesh, triangle"},
      {"objects: [{sphere: {radios: 1}}]",
       "scene.yaml:2:21: unknown key 'radios' in sphere; did you mean 'radius'?"},
      {"objects: [{sphere: {}, transform: [{move: 1}]}]",
       "scene.yaml:2:37: unknown key 'move' in a transform; known"},
      {"objects: [{sphere: {}, materiel: a}]",
       "scene.yaml:2:24: unknown key 'materiel' in an object; did you mean 'material'?"},
  });
}

TEST(SceneError, WrongTypes) {
  expect_errors({
      {"camera: 3", "scene.yaml:2:9: expected a map for camera, found '3'"},
      {"camera: {from: 3}", "scene.yaml:2:16: expected a list of 3 numbers, found '3'"},
      {"camera: {from: }", "scene.yaml:2:10: expected a list of 3 numbers, found nothing"},
      {"camera: {fov: [1]}", "scene.yaml:2:15: expected a number, found a list"},
      {"camera: {fov: wide}", "scene.yaml:2:15: expected a number, found 'wide'"},
      {"camera: {projection: fish}",
       "scene.yaml:2:22: expected perspective or orthographic or fisheye or ultra_wide_angle or omnimax or "
       "panoramic or cylindrical or spherical or mesh, found 'fish'"},
      {"integrator: {kind: paht}",
       "scene.yaml:2:20: expected whitted or path or ao or normal or depth or albedo or uv or position or "
       "object or primitive or facing or wire, found 'paht'; did you mean "
       "'path'?"},
      {"objects: {sphere: {}}", "scene.yaml:2:10: expected a list for objects, found a map"},
      {"objects: [sphere]", "scene.yaml:2:11: expected a map for an object, found 'sphere'"},
      {"objects: [{}]", "scene.yaml:2:11: an object needs a shape: one of mesh, "},
      {"objects:\n  -\n", "scene.yaml:4:1: an object needs a shape"},
      {"objects: [{group: {}}]", "scene.yaml:2:19: expected a list for group, found a map"},
      {"materials: []", "scene.yaml:2:12: expected a map for materials, found a list"},
      {"background: red", "scene.yaml:2:13: expected a colour, [r, g, b] or \"#rrggbb\", found 'red'"},
      {"background: \"#12345\"", "scene.yaml:2:13: expected a colour"},
      {"background: \"#12345g\"", "scene.yaml:2:13: expected a colour"},
      {"background: #123456\n",
       "scene.yaml:2:1: expected a colour, [r, g, b] or \"#rrggbb\", found nothing (a colour that starts "
       "with # must"},
      {"lights: [{point: {position: [0, 0, 0], falloff: 1}}]",
       "scene.yaml:2:49: expected true or false, found '1'"},
      {"lights: [{}]", "scene.yaml:2:10: expected one of point, spot, directional, environment, "},
      {"lights: [{point: {}}]", "scene.yaml:2:18: a point light needs 'position'"},
      {"objects: [{sphere: {}, material: [a]}]",
       "scene.yaml:2:34: expected the name of a material or a map, found a list"},
      {"objects: [{sphere: {}, transform: 3}]", "scene.yaml:2:35: expected a list for transform, found '3'"},
      {"objects: [{mesh: {}}]", "scene.yaml:2:18: mesh needs 'file'"},
      {"objects: [{polygon: {}}]", "scene.yaml:2:21: polygon needs 'vertices'"},
      {"objects: [{spheres: {}}]", "scene.yaml:2:21: spheres needs 'centers'"},
      {"objects: [{spheres: {file: x, radius: 2}}]", "scene.yaml:2:39: spheres from a file have no 'radius'"},
      {"params: {r: [1]}", "scene.yaml:2:13: expected a number or text, found a list"},
      {"params: {\"a b\": 1}", "scene.yaml:2:10: a name consists of letters"},
      {"include: materials.yaml", "scene.yaml:2:10: expected a list for include"},
  });
}

TEST(SceneError, WrongCounts) {
  expect_errors({
      {"camera: {from: [1, 2]}", "scene.yaml:2:16: expected 3 numbers, found 2"},
      {"film: {crop: [0, 1, 0]}", "scene.yaml:2:14: expected 4 numbers, found 3"},
      {"background: [1, 1, 1, 1]", "scene.yaml:2:13: expected 3 numbers, found 4"},
      {"objects: [{triangle: {vertices: [[0, 0, 0]]}}]", "scene.yaml:2:33: expected 3 vertices, found 1"},
      {"objects: [{polygon: {vertices: [[0, 0, 0], [1, 0, 0]]}}]",
       "scene.yaml:2:32: expected 3 to 4096 vertices, found 2"},
      {"objects: [{sphere: {}, transform: {matrix: [1, 2, 3]}}]",
       "scene.yaml:2:44: expected 12 or 16 numbers, row by row, found 3"},
  });
}

TEST(SceneError, NumbersOutOfRange) {
  expect_errors({
      {"objects: [{sphere: {radius: -1}}]", "scene.yaml:2:29: expected a number of at least 0, found '-1'"},
      {"objects: [{sphere: {radius: .inf}}]", "scene.yaml:2:29: expected a finite number, found '.inf'"},
      {"objects: [{sphere: {radius: .nan}}]", "scene.yaml:2:29: expected a finite number, found '.nan'"},
      {"objects: [{sphere: {radius: nan}}]", "scene.yaml:2:29: expected a finite number, found 'nan'"},
      {"objects: [{sphere: {radius: 1e999}}]", "scene.yaml:2:29: number out of range: '1e999'"},
      {"objects: [{sphere: {center: [0, -1e19, 0]}}]",
       "scene.yaml:2:33: number out of range: '-1e19' (magnitude at most 1e+18)"},
      {"objects: [{sphere: {radius: \"1/0\"}}]", "scene.yaml:2:29: expected a finite number, found '1/0'"},
      {"objects: [{disk: {radius: -2}}]", "scene.yaml:2:27: expected a number of at least 0"},
      {"objects: [{box: {min: [0, 2, 0]}}]", "scene.yaml:2:23: the box has min > max along y"},
      {"objects: [{spheres: [{radius: -1}]}]", "scene.yaml:2:31: expected a number of at least 0"},
      {"camera: {fov: 0}", "scene.yaml:2:15: expected a number greater than 0 and less than 180, found '0'"},
      {"camera: {fov: 180}", "scene.yaml:2:15: expected a number greater than 0 and less than 180"},
      {"camera: {height: 0}", "scene.yaml:2:18: expected a number greater than 0"},
      {"camera: {from: [0, 0, 0]}", "scene.yaml:2:9: the camera looks from where it looks at"},
      {"camera: {up: [0, 0, 0]}", "scene.yaml:2:9: the camera's 'up' is zero"},
      {"camera: {up: [0, 0, 3]}", "scene.yaml:2:9: the camera's 'up' is parallel"},
      {"film: {width: 0}", "scene.yaml:2:15: expected a whole number from 1 to 65536, found '0'"},
      {"film: {width: 65537}", "scene.yaml:2:15: expected a whole number from 1 to 65536"},
      {"film: {width: 1.5}", "scene.yaml:2:15: expected a whole number from 1 to 65536"},
      {"film: {width: 1e300}", "scene.yaml:2:15: expected a whole number from 1 to 65536"},
      {"film: {width: 65536, height: 65536}", "scene.yaml:2:7: the film has more than 2^30 pixels"},
      {"film: {crop: [0.5, 0.5, 0, 1]}", "scene.yaml:2:14: the crop window is empty"},
      {"film: {crop: [0, 2, 0, 1]}", "scene.yaml:2:18: expected a number from 0 to 1, found '2'"},
      {"integrator: {samples: 0}", "scene.yaml:2:23: expected a whole number from 1 to 65536"},
      {"integrator: {caustics: {photons: 0}}", "scene.yaml:2:34: expected a whole number from 1 to 67108864"},
      {"integrator: {caustics: {passes: 4097}}", "scene.yaml:2:33: expected a whole number from 1 to 4096"},
      {"integrator: {caustics: {radius: 0}}", "scene.yaml:2:33: expected a number greater than 0"},
      {"integrator: {caustics: 3}", "scene.yaml:2:24: expected true or false"},
      {"integrator: {caustics: {photon: 3}}", "scene.yaml:2:25: unknown key 'photon' in caustics"},
      {"integrator: {depth: 65}", "scene.yaml:2:21: expected a whole number from 0 to 64"},
      {"integrator: {seed: -1}", "scene.yaml:2:20: expected a whole number from 0 to 4294967295"},
      {"background: [0, -1, 0]", "scene.yaml:2:17: expected a number of at least 0"},
      {"materials: {a: {reflection: 1.5}}", "scene.yaml:2:29: expected a number from 0 to 1"},
      {"materials: {a: {ior: 0}}", "scene.yaml:2:22: expected a number greater than 0"},
      {"materials: {a: {ior: 1e-300}}", "scene.yaml:2:22: expected a number greater than 0"},
      {"lights: [{directional: {direction: [0, 0, 0]}}]", "scene.yaml:2:36: the direction must not be zero"},
  });
}

TEST(SceneError, UnknownAndDuplicateNames) {
  expect_errors({
      {"materials: {gold: {}}\nobjects: [{sphere: {}, material: glod}]",
       "scene.yaml:3:34: unknown material 'glod'; did you mean 'gold'?"},
      {"objects: [{sphere: {}, material: gold}]", "scene.yaml:2:34: unknown material 'gold'"},
      {"define: {plant: {sphere: {}}}\nobjects: [{instance: plan}]",
       "scene.yaml:3:22: unknown prototype 'plan'; did you mean 'plant'?"},
      {"objects: [{sphere: {}, box: {}}]",
       "scene.yaml:2:24: an object has one shape, but 'sphere' and 'box' are given"},
      {"film: {width: 3,\n width: 4}", "scene.yaml:3:2: duplicate key 'width'; first at line 2"},
      {"materials:\n  a: {}\n  a: {}\n", "scene.yaml:4:3: duplicate key 'a'; first at line 3"},
      {"oktett: 1\n", "scene.yaml:2:1: duplicate key 'oktett'; first at line 1"},
      {"objects: [{sphere: {}, name: a}, {box: {}, name: a}]",
       "scene.yaml:2:50: object 'a' is defined twice; first at scene.yaml:2:30"},
  });
}

TEST(SceneError, PrototypesThatHoldThemselvesOrLaterOnes) {
  expect_errors({
      {"define: {a: {group: [{instance: a}]}}", "scene.yaml:2:33: prototype 'a' contains itself"},
      {"define:\n  a: {instance: b}\n  b: {instance: a}\n",
       "scene.yaml:3:17: prototype 'b' is defined only later, at line 4; a prototype may hold instances of "
       "those before it"},
  });
  std::string chain = "define:\n  p0: {sphere: {}}\n";
  for (int i = 1; i < 40; ++i)
    chain += "  p" + std::to_string(i) + ": {instance: p" + std::to_string(i - 1) + "}\n";
  EXPECT_EQ(SceneFiles().error_v1(chain), "scene.yaml:36:19: instances are nested deeper than 32 levels");
}

TEST(SceneError, BadTransforms) {
  expect_errors({
      {"objects: [{sphere: {}, transform: {scale: 2, rotate: [0, 0, 0]}}]",
       "scene.yaml:2:35: expected one of translate, scale, rotate and matrix; several make a list"},
      {"objects: [{sphere: {}, transform: [{}]}]", "scene.yaml:2:36: expected one of translate"},
      {"objects: [{sphere: {}, transform: [{rotate: {axis: [0, 0, 0], angle: 1}}]}]",
       "scene.yaml:2:52: the axis of a rotation must not be zero"},
      {"objects: [{sphere: {}, transform: [{rotate: {axis: [0, 0, 1]}}]}]",
       "scene.yaml:2:45: rotate needs 'angle'"},
      {"objects: [{sphere: {}, transform: {rotate: 90}}]", "scene.yaml:2:44: expected a list of 3 numbers"},
      {"objects: [{sphere: {}, transform: {matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1]}}]",
       "scene.yaml:2:87: the last row of a matrix must be 0, 0, 0, 1"},
  });
}

TEST(SceneError, BadExpressionsPointAtTheColumn) {
  SceneFiles files;
  EXPECT_EQ(files.error_v1("objects: [{sphere: {radius: \"2*+)\"}}]"),
            "scene.yaml:2:33: bad expression: expected a number, a name or '(' (column 4)\n  2*+)\n     ^");
  EXPECT_EQ(
      files.error_v1("params: {r: \"1+\"}\nobjects: [{sphere: {radius: \"2*(${r})\"}}]"),
      "scene.yaml:3:29: bad expression: expected a number, a name or '(' (column 6)\n  2*(1+)\n       ^");
  expect_starts(files.error_v1("camera: {fov: sqroot(2)}"),
                "scene.yaml:2:15: bad expression: unknown name 'sqroot'; did you mean 'sqrt'? (column 1)");
  expect_starts(files.error_v1("camera: {fov: 40 deg}"),
                "scene.yaml:2:18: bad expression: expected an operator");
  expect_starts(files.error_v1("camera: {fov: \"\"}"), "scene.yaml:2:16: bad expression: expected a number");
  const std::string deep(500, '(');
  expect_starts(files.error_v1("camera: {fov: \"" + deep + "\"}"),
                "scene.yaml:2:216: bad expression: nested deeper");
}

TEST(SceneError, Parameters) {
  expect_errors({
      {"params: {radius: 1}\nobjects: [{sphere: {radius: \"2*${radios}\"}}]",
       "scene.yaml:3:32: no value for '${radios}'; did you mean 'radius'?; give one in 'params' or with -D"},
      {"objects: [{sphere: {radius: \"${r\"}}]", "scene.yaml:2:30: '${' without '}'"},
      {"params: {a: \"${b}\", b: 1}", "scene.yaml:2:14: no value for '${b}'"},
  });
  SceneFiles files;
  EXPECT_EQ(files.error_v1("", {{"a b", "1"}}), "-D a b: a name consists of letters, digits, '_' and '-'");
}

TEST(SceneError, MissingFiles) {
  expect_errors({
      {"objects: [{mesh: {file: none.obj}}]", "scene.yaml:2:25: 'none.obj': no such file"},
      {"objects: [{mesh: {file: .}}]", "scene.yaml:2:25: '.': is a directory"},
      {"objects: [{mesh: {file: scene.yaml}}]",
       "scene.yaml:2:25: unknown kind of mesh file; expected .obj, .ply, .stl, .off, .3mf, .gltf or .glb, "
       "also "
       "packed as "
       ".gz"},
      {"objects: [{mesh: {file: \"scene.yaml\\0.obj\"}}]", "scene.yaml:2:25: not a path"},
      {"objects: [{mesh: {file: \"\"}}]", "scene.yaml:2:25: expected the path of a file, found nothing"},
      {"objects: [{spheres: {file: none.txt}}]", "scene.yaml:2:28: 'none.txt': no such file"},
      {"materials: {a: {map_color: none.png}}", "scene.yaml:2:28: 'none.png': no such file"},
      {"materials: {a: {map_color: {scale: 2}}}", "scene.yaml:2:28: a texture needs 'file'"},
      {"include: [none.yaml]", "scene.yaml:2:11: 'none.yaml': no such file"},
      {"include: [/dev/zero]", "scene.yaml:2:11: '/dev/zero': is not a regular file"},
  });
  SceneFiles files;
  try {
    files.load_v1("objects: [{mesh: {file: none.obj}}]");
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::bad_input);
    EXPECT_EQ(e.where(), (Location{files.dir.file("scene.yaml"), 2, 25}));
  }
}

TEST(SceneError, Includes) {
  SceneFiles files;
  files.dir.write("a.yaml", "oktett: 1\ninclude: [sub/b.yaml]\n");
  files.dir.write("sub/b.yaml", "oktett: 1\ninclude:\n  - ../a.yaml\n");
  EXPECT_EQ(files.error_v1("include: [a.yaml]"),
            "sub/b.yaml:3:5: include cycle: a.yaml -> sub/b.yaml -> sub/../a.yaml");
  EXPECT_EQ(files.error_v1("include: [scene.yaml]"),
            "scene.yaml:2:11: include cycle: scene.yaml -> scene.yaml");
  files.dir.write("m.yaml", "oktett: 1\nmaterials: {gold: {}}\ndefine: {p: {sphere: {}}}\n");
  EXPECT_EQ(files.error_v1("include: [m.yaml]\nmaterials: {gold: {}}"),
            "scene.yaml:3:13: material 'gold' is defined twice; first at m.yaml:2:13");
  EXPECT_EQ(files.error_v1("include: [m.yaml]\ndefine: {p: {box: {}}}"),
            "scene.yaml:3:10: prototype 'p' is defined twice; first at m.yaml:3:10");
  files.dir.write("old.yaml", "materials: {}\n");
  EXPECT_EQ(files.error_v1("include: [old.yaml]"),
            "old.yaml:1:1: the format version is missing: expected 'oktett: 1'");
}

}  // namespace
}  // namespace oktett::scene_error_test
