"""Plain readers of OBJ, PLY, STL, glTF and EXR files. They are the second opinion of scripts/interop on what a file says, so they
share nothing with Oktett, and take only what programs write that are given the house."""

import base64
import json
import struct
import urllib.parse
import zlib
from dataclasses import dataclass, field

from house import TEXELS, normalized


@dataclass
class Corner:
    position: tuple
    normal: tuple = None
    uv: tuple = None
    color: tuple = None  # as it stands in the file, bytes as parts of 1


@dataclass
class Material:
    name: str = ""
    color: tuple = (1.0, 1.0, 1.0)
    texture: bool = False  # or text that says what is wrong with it
    upside_down: bool = False
    opacity: float = 1.0
    reflected: float = 0.0  # Kd and Ks of MTL together, at most


def upper_left(data):
    """The first pixel of a PNG file of 8 bits, or None."""
    if data[:8] != b"\x89PNG\r\n\x1a\n" or data[24] != 8:
        return None
    packed, palette, at = b"", b"", 8
    while at + 12 <= len(data) and data[at - 8:at - 4] != b"IEND":
        size, kind = struct.unpack_from(">I4s", data, at)
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        palette += data[at + 8:at + 8 + size] if kind == b"PLTE" else b""
        at += 12 + size
    row = zlib.decompress(packed)
    return tuple(palette[3 * row[1]:3 * row[1] + 3]) if palette else tuple(row[1:4])  # filters change nothing here


def is_upside_down(data):
    """Whether this is the house's texture with its first row last."""
    pixel = upper_left(data)
    return pixel is not None and max(abs(a - b) for a, b in zip(pixel, TEXELS[0])) < 30


@dataclass
class Mesh:
    vertices: int = 0
    polygons: list = field(default_factory=list)   # lists of corners
    slots: list = field(default_factory=list)      # for each polygon: a material's index or -1
    materials: list = field(default_factory=list)


def add_texture(material, path):
    if path.is_file():
        material.texture, material.upside_down = True, is_upside_down(path.read_bytes())
    else:
        material.texture = "missing: " + path.name


def read_mtl(path):
    materials = []
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if not words or not materials and words[0] != "newmtl":
            continue
        if words[0] == "newmtl":
            materials.append(Material(line.split(None, 1)[1].strip()))
        elif words[0] == "Kd":
            materials[-1].color = tuple(map(float, words[1:4]))
        elif words[0] == "Ks":
            material = materials[-1]
            material.reflected = max(map(float, words[1:4])) + max(material.color)
        elif words[0] == "d":
            materials[-1].opacity = float(words[-1])
        elif words[0] == "map_Kd":
            add_texture(materials[-1], path.parent / words[-1].replace("\\", "/"))
    return materials


def read_obj(path):
    mesh, positions, colors, uvs, normals, slot = Mesh(), [], [], [], [], -1
    at = lambda values, word: values[int(word) - 1 if int(word) > 0 else int(word)] if word else None
    for line in path.read_text(errors="replace").replace("\\\n", " ").splitlines():
        words = line.split("#")[0].split() if not line.startswith(("usemtl", "mtllib")) else line.split()
        if not words:
            continue
        if words[0] == "v":
            positions.append(tuple(map(float, words[1:4])))
            colors.append(tuple(map(float, words[4:7])) if len(words) >= 7 else None)
        elif words[0] == "vt":
            uvs.append(tuple(map(float, words[1:3])))
        elif words[0] == "vn":
            normals.append(tuple(map(float, words[1:4])))
        elif words[0] == "mtllib":
            library = path.parent / line.split(None, 1)[1].strip()
            mesh.materials += read_mtl(library) if library.is_file() else []
        elif words[0] == "usemtl":
            name = line.split(None, 1)[1].strip() if len(words) > 1 else ""
            slot = next((i for i, m in enumerate(mesh.materials) if m.name == name), -1)
        elif words[0] == "f":
            polygon = []
            for word in words[1:]:
                parts = (word.split("/") + ["", ""])[:3]
                polygon.append(Corner(at(positions, parts[0]), at(normals, parts[2]), at(uvs, parts[1]), at(colors, parts[0])))
            mesh.polygons.append(polygon)
            mesh.slots.append(slot)
    mesh.vertices = len(positions)
    return mesh


PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
             "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}


class PlyBody:
    def __init__(self, data, form):
        self.at, self.data, self.words = 0, data, None
        self.order = ">" if "big" in form else "<"
        if form == "ascii":
            self.words = iter(data.split())

    def take(self, kind):
        if self.words:
            word = next(self.words)
            return float(word) if kind in "fd" else int(float(word))
        value, = struct.unpack_from(self.order + kind, self.data, self.at)
        self.at += struct.calcsize(kind)
        return value


def read_ply(path):
    data = path.read_bytes()
    end = data.index(b"end_header")
    end = data.index(b"\n", end) + 1
    elements, form = [], ""
    mesh = Mesh()
    for line in data[:end].decode(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
        elif words[:2] == ["comment", "TextureFile"]:
            mesh.materials.append(Material("image"))
            add_texture(mesh.materials[-1], path.parent / line.split("TextureFile", 1)[1].strip())
    body, vertices = PlyBody(data[end:], form), []
    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            for p in properties:
                if p[0] == "list":
                    row[p[3]] = [body.take(PLY_TYPES[p[2]]) for _ in range(body.take(PLY_TYPES[p[1]]))]
                else:
                    row[p[1]] = body.take(PLY_TYPES[p[0]])
            if name == "vertex":
                vertices.append(ply_vertex(row, dict((p[1], PLY_TYPES[p[0]]) for p in properties if p[0] != "list")))
            elif name == "face":
                add_ply_face(mesh, row, vertices, dict((p[1], PLY_TYPES[p[0]]) for p in properties if p[0] != "list"))
    mesh.vertices = len(vertices)
    return mesh


def ply_color(row, types):
    for names in (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"), ("color.r", "color.g", "color.b")):
        if all(n in row for n in names):
            scale = {"B": 255, "H": 65535}.get(types[names[0]], 1)
            return tuple(row[n] / scale for n in names)
    return None


def ply_vertex(row, types):
    corner = Corner((row["x"], row["y"], row["z"]), color=ply_color(row, types))
    if "nx" in row:
        corner.normal = (row["nx"], row["ny"], row["nz"])
    for u, v in (("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t")):
        if u in row:
            corner.uv = (row[u], row[v])
    return corner


def add_ply_face(mesh, row, vertices, types):
    indices = row.get("vertex_indices", row.get("vertex_index"))
    polygon = [Corner(**vars(vertices[i])) for i in indices]
    wedges = row.get("texcoord")
    for k, corner in enumerate(polygon):
        if wedges:
            corner.uv = (wedges[2 * k], wedges[2 * k + 1])
        color = ply_color(row, types)
        if color and corner.color is None:
            corner.color = color
    mesh.polygons.append(polygon)
    mesh.slots.append(row.get("texnumber", 0 if mesh.materials else -1))


def read_stl(path):
    data, mesh = path.read_bytes(), Mesh()
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        for at in range(84, len(data), 50):
            v = struct.unpack_from("<12f", data, at)
            mesh.polygons.append([Corner(v[k:k + 3]) for k in (3, 6, 9)])
    else:
        words = data.decode(errors="replace").split()
        points = [tuple(map(float, words[i + 1:i + 4])) for i, word in enumerate(words) if word == "vertex"]
        mesh.polygons = [[Corner(p) for p in points[i:i + 3]] for i in range(0, len(points), 3)]
    mesh.vertices = len({c.position for polygon in mesh.polygons for c in polygon})
    mesh.slots = [-1] * len(mesh.polygons)
    return mesh


class Gltf:
    def __init__(self, path):
        data, binary = path.read_bytes(), b""
        if data[:4] == b"glTF":
            length, = struct.unpack_from("<I", data, 12)
            self.json, binary = json.loads(data[20:20 + length]), data[28 + length:]
        else:
            self.json = json.loads(data)
        self.folder = path.parent
        self.buffers = [self.bytes_of(b["uri"]) if "uri" in b else binary for b in self.json.get("buffers", [])]

    def bytes_of(self, uri):
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.folder / urllib.parse.unquote(uri)).read_bytes()

    def accessor(self, index):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        kind = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}[a["componentType"]]
        form = "<%d%s" % ({"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]], kind)
        stride = view.get("byteStride", struct.calcsize(form))
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        values = [struct.unpack_from(form, self.buffers[view["buffer"]], start + i * stride) for i in range(a["count"])]
        if a.get("normalized"):
            most = {"b": 127, "B": 255, "h": 32767, "H": 65535}[kind]
            values = [tuple(max(x / most, -1) for x in v) for v in values]
        return values

    def image(self, image):
        if "uri" in image:
            return self.bytes_of(image["uri"])
        view = self.json["bufferViews"][int(image["bufferView"])]
        start = view.get("byteOffset", 0)
        return self.buffers[view["buffer"]][start:start + view["byteLength"]]

    def materials(self):
        for m in self.json.get("materials", []):
            pbr = m.get("pbrMetallicRoughness", {})
            gloss = m.get("extensions", {}).get("KHR_materials_pbrSpecularGlossiness", {})
            color = pbr.get("baseColorFactor", gloss.get("diffuseFactor", (1, 1, 1, 1)))
            texture = pbr.get("baseColorTexture", gloss.get("diffuseTexture"))
            material = Material(m.get("name", ""), tuple(color[:3]), opacity=color[3] if m.get("alphaMode") == "BLEND" else 1.0)
            if texture:
                entry = self.json["textures"][texture["index"]]
                image = self.json["images"][entry.get("source", entry.get("extensions", {}).get("EXT_texture_webp", {}).get("source"))]
                try:
                    material.texture, material.upside_down = True, is_upside_down(self.image(image))
                except OSError:
                    material.texture = "missing: " + image["uri"]
            yield material

    def nodes(self):
        scene = self.json.get("scenes", [{"nodes": range(len(self.json["nodes"]))}])[self.json.get("scene", 0)]
        stack = [(i, IDENTITY) for i in scene.get("nodes", [])]
        while stack:
            index, above = stack.pop()
            node = self.json["nodes"][index]
            matrix = multiply(above, node_matrix(node))
            yield node, matrix
            stack += [(child, matrix) for child in node.get("children", [])]


IDENTITY = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))


def multiply(a, b):
    return tuple(tuple(sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)) for i in range(4))


def node_matrix(node):
    if "matrix" in node:
        return tuple(tuple(node["matrix"][4 * j + i] for j in range(4)) for i in range(4))
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    s, t = node.get("scale", (1, 1, 1)), node.get("translation", (0, 0, 0))
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return tuple(tuple(rows[i][j] * s[j] for j in range(3)) + (t[i],) for i in range(3)) + ((0, 0, 0, 1),)


def read_gltf(path):
    gltf, mesh, counted = Gltf(path), Mesh(), set()
    mesh.materials = list(gltf.materials())
    for node, m in gltf.nodes():
        move = lambda p: tuple(sum(m[i][j] * p[j] for j in range(3)) + m[i][3] for i in range(3))
        turn = lambda n: normalized(tuple(sum(m[i][j] * n[j] for j in range(3)) for i in range(3)))  # scales are alike on all axes
        for primitive in gltf.json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            if primitive.get("mode", 4) != 4 or "KHR_draco_mesh_compression" in primitive.get("extensions", {}):
                raise ValueError("not plain triangles")
            a = primitive["attributes"]
            # Oktett names colours `_color` that would otherwise multiply those of a material which another format shows alone.
            names = ("POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0" if "COLOR_0" in a else "_color")
            columns = [gltf.accessor(a[n]) if n in a else None for n in names]
            vertices = [Corner(move(columns[0][i]), *(c[i] if c else None for c in columns[1:])) for i in range(len(columns[0]))]
            for v in vertices:
                v.normal = turn(v.normal) if v.normal else None
                v.uv = (v.uv[0], 1 - v.uv[1]) if v.uv else None
                v.color = v.color[:3] if v.color else None
            order = [i for i, in gltf.accessor(primitive["indices"])] if "indices" in primitive else range(len(vertices))
            for k in range(0, len(order) - 2, 3):
                mesh.polygons.append([vertices[i] for i in order[k:k + 3]])
                mesh.slots.append(primitive.get("material", -1))
            mesh.vertices += 0 if a["POSITION"] in counted else len(vertices)
            counted.add(a["POSITION"])
    return mesh


READERS = {".obj": read_obj, ".ply": read_ply, ".stl": read_stl, ".gltf": read_gltf, ".glb": read_gltf}


def read_mesh(path):
    return READERS[path.suffix.lower()](path)


def read_exr(path):
    """Width, and the channels as lists, of a picture that Oktett wrote."""
    data, at, header = path.read_bytes(), 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<I", data, at)
        header[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    names, types, list_at, listed = [], [], 0, header["channels"]
    while listed[list_at]:
        name = listed[list_at:].split(b"\0", 1)[0]
        list_at += len(name) + 1
        names.append(name.decode())
        types.append(("I", "e", "f")[struct.unpack_from("<I", listed, list_at)[0]])
        list_at += 16
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    lines = {0: 1, 2: 1, 3: 16}[header["compression"][0]]
    channels = {n: [] for n in names}
    row_bytes = sum(struct.calcsize(t) for t in types) * width
    for offset in struct.unpack_from("<%dQ" % -(-height // lines), data, at + 1):
        y, size = struct.unpack_from("<iI", data, offset)
        block, rows = data[offset + 8:offset + 8 + size], min(lines, y1 + 1 - y)
        if size < rows * row_bytes:
            block = bytearray(zlib.decompress(block))
            for i in range(1, len(block)):
                block[i] = (block[i - 1] + block[i] - 128) & 255
            half = (len(block) + 1) // 2
            whole = bytearray(len(block))
            whole[0::2], whole[1::2] = block[:half], block[half:]
            block = bytes(whole)
        place = 0
        for _ in range(rows):
            for name, t in zip(names, types):
                channels[name] += struct.unpack_from("<%d%s" % (width, t), block, place)
                place += width * struct.calcsize(t)
    return width, channels
