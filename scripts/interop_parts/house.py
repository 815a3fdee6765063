"""The house that every program writes and reads: what it is, and files of it that owe nothing to Oktett.

Two materials, one with a texture of four colours; a colour and a normal at every corner; a concave front of nine corners;
and a vertex that stands twice at the ridge. On each face, texture coordinates, colours and normals are affine functions of
the position, so that they can be compared wherever a program cuts a polygon."""

import json
import math
import struct
import zlib
from pathlib import Path

POSITIONS = [
    (0, 0, 0), (4, 0, 0), (4, 2, 0), (2, 3.5, 0), (0, 2, 0),
    (0, 0, 3), (1.25, 0, 3), (1.25, 1.25, 3), (2.25, 1.25, 3), (2.25, 0, 3), (4, 0, 3), (4, 2, 3), (2, 3.5, 3), (0, 2, 3),
    (2, 3.5, 3),  # again, for the other half of the roof
]
WALL, ROOF = 0, 1
FACES = [  # corners, counter-clockwise from outside; material
    ((5, 6, 7, 8, 9, 10, 11, 12, 13), WALL),
    ((1, 0, 4, 3, 2), WALL),
    ((0, 5, 13, 4), WALL),
    ((10, 1, 2, 11), WALL),
    ((13, 12, 3, 4), ROOF),
    ((11, 2, 3, 14), ROOF),
]
MATERIALS = [("wall", (0.5, 0.25, 0.125), None), ("roof", (1.0, 1.0, 1.0), "corners.png")]
TEXELS = ((230, 40, 40), (40, 200, 40), (40, 60, 220), (220, 220, 60))  # lower left and right, upper left and right


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalized(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a) if length > 0 else a


def polygon_area(points):
    """The area times the normal."""
    total = (0.0, 0.0, 0.0)
    for a, b in zip(points, points[1:] + points[:1]):
        total = tuple(t + c / 2 for t, c in zip(total, cross(a, b)))
    return total


class Face:
    """A face of the house, with the functions of the position that its corners have."""

    def __init__(self, index):
        self.index = index
        self.corners, self.material = FACES[index]
        self.points = [POSITIONS[i] for i in self.corners]
        area = polygon_area(self.points)
        self.area = math.sqrt(dot(area, area))
        self.normal = normalized(area)

    def shading_normal(self, p):
        """Walls are flat; a roof is smooth, with the ridge pointing up."""
        if self.material == WALL:
            return self.normal
        up = (p[1] - 2) / 1.5
        return normalized(tuple(n * (1 - up) + u * up for n, u in zip(self.normal, (0, 1, 0))))

    def uv(self, p):
        if self.material == ROOF:
            return (p[2] / 3, (p[1] - 2) / 1.5) if self.index == 4 else (1 - p[2] / 3, (p[1] - 2) / 1.5)
        return (p[0] / 4, p[1] / 4) if self.index < 2 else (p[2] / 4, p[1] / 4)

    @staticmethod
    def color(p):
        """Linear."""
        return (0.1 + 0.2 * p[0], 0.1 + 0.2 * p[1], 0.9 - 0.2 * p[2])

    def contains(self, p, slack=1e-3):
        """Whether a point of the plane is inside, by crossings along an axis; points near the outline are."""
        axis = max(range(3), key=lambda k: abs(self.normal[k]))
        u, v = [k for k in range(3) if k != axis]
        inside = False
        for a, b in zip(self.points, self.points[1:] + self.points[:1]):
            edge, to = subtract(b, a), subtract(p, a)
            along = min(max(dot(edge, to) / dot(edge, edge), 0), 1)
            if math.dist(p, tuple(x + along * e for x, e in zip(a, edge))) < slack:
                return True
            if (a[v] > p[v]) != (b[v] > p[v]) and p[u] < a[u] + (p[v] - a[v]) * (b[u] - a[u]) / (b[v] - a[v]):
                inside = not inside
        return inside


ALL_FACES = [Face(i) for i in range(len(FACES))]


def face_at(p, normal=None, slack=1e-3):
    """The face that has this point and faces along `normal`, or None."""
    for face in ALL_FACES:
        if abs(dot(subtract(p, face.points[0]), face.normal)) < slack and (normal is None or dot(normal, face.normal) > 0.9):
            if face.contains(p, slack):
                return face
    return None


def srgb(linear):
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def linear(encoded):
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def texel(uv):
    """The texture's colour, linear, or None where a pixel may see two of its colours."""
    u, v = uv[0] % 1, uv[1] % 1
    if min(abs(u - k) for k in (0, 0.5, 1)) < 0.13 or min(abs(v - k) for k in (0, 0.5, 1)) < 0.13:
        return None
    return tuple(linear(c / 255) for c in TEXELS[(u > 0.5) + 2 * (v > 0.5)])


def write_texture(path):
    rows = b"".join(b"\0" + b"".join(bytes(TEXELS[(x >= 32) + 2 * (y < 32)]) for x in range(64)) for y in range(64))
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", 64, 64, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks))


def corners():
    """One vertex for each corner of each face: (vertex, position, normal, uv, colour)."""
    for face in ALL_FACES:
        for i in face.corners:
            p = POSITIONS[i]
            yield i, p, face.shading_normal(p), face.uv(p), face.color(p)


FRONT_TRIANGLES = [(0, 1, 2), (3, 4, 5), (0, 2, 8), (3, 5, 6), (2, 3, 7), (8, 2, 7), (3, 6, 7)]  # of its nine corners


def triangles(face):
    """The face's triangles, as places in its list of corners."""
    return FRONT_TRIANGLES if face == 0 else [(0, k, k + 1) for k in range(1, len(FACES[face][0]) - 1)]


def write_json(path):
    """All of it for programs that are given arrays. Corners stand one after the other, face by face."""
    every = list(corners())
    starts = [sum(len(f[0]) for f in FACES[:i]) for i in range(len(FACES))]
    path.write_text(json.dumps({
        "positions": POSITIONS,
        "faces": [f[0] for f in FACES],
        "face_materials": [f[1] for f in FACES],
        "materials": [{"name": n, "color": c, "texture": t} for n, c, t in MATERIALS],
        "colors": [Face.color(p) for p in POSITIONS],
        "srgb_colors": [[srgb(x) for x in Face.color(p)] for p in POSITIONS],
        "corner_positions": [c[1] for c in every],
        "corner_normals": [c[2] for c in every],
        "corner_uvs": [c[3] for c in every],
        "corner_colors": [c[4] for c in every],
        "corner_srgb_colors": [[srgb(x) for x in c[4]] for c in every],
        "triangles": [[starts[i] + k for k in t] for i in range(len(FACES)) for t in triangles(i)],
        "triangle_vertices": [[FACES[i][0][k] for k in t] for i in range(len(FACES)) for t in triangles(i)],
        "triangle_materials": [FACES[i][1] for i in range(len(FACES)) for _ in triangles(i)],
    }))


def write_obj(path, polygons=True):
    lines = ["mtllib house.mtl"]
    for p in POSITIONS:
        lines.append("v %.9g %.9g %.9g %.6f %.6f %.6f" % (*p, *(srgb(c) for c in Face.color(p))))
    for _, _, n, uv, _ in corners():
        lines.append("vt %.9g %.9g\nvn %.9g %.9g %.9g" % (*uv, *n))
    k, material = 0, None
    for i, face in enumerate(FACES):
        if face[1] != material:
            material = face[1]
            lines.append("usemtl " + MATERIALS[material][0])
        for cut in [range(len(face[0]))] if polygons else triangles(i):
            lines.append("f " + " ".join("%d/%d/%d" % (face[0][j] + 1, k + j + 1, k + j + 1) for j in cut))
        k += len(face[0])
    path.write_text("\n".join(lines) + "\n")
    path.with_name("house.mtl").write_text("".join(
        "newmtl %s\nKd %g %g %g\nillum 1\n%s\n" % (name, *color, "map_Kd %s\n" % image if image else "")
        for name, color, image in MATERIALS))


def write_ply(path):
    """A vertex for each corner, with colours in bytes by the sRGB curve, as most programs show them."""
    every = list(corners())
    lines = ["ply", "format ascii 1.0", "comment TextureFile corners.png", "element vertex %d" % len(every)]
    lines += ["property float " + n for n in ("x", "y", "z", "nx", "ny", "nz", "s", "t")]
    lines += ["property uchar " + n for n in ("red", "green", "blue")]
    lines += ["element face %d" % sum(len(triangles(i)) for i in range(len(FACES))),
              "property list uchar int vertex_indices", "end_header"]
    for _, p, n, uv, color in every:
        lines.append(("%.9g " * 8 + "%d %d %d") % (*p, *n, *uv, *(round(255 * srgb(c)) for c in color)))
    start = 0
    for i, face in enumerate(FACES):
        lines += ["3 %d %d %d" % tuple(start + k for k in t) for t in triangles(i)]
        start += len(face[0])
    path.write_text("\n".join(lines) + "\n")


def write_stl(path):
    lines = ["solid house"]
    for i, face in enumerate(ALL_FACES):
        for t in triangles(i):
            lines += ["facet normal %g %g %g" % face.normal, "outer loop"]
            lines += ["vertex %.9g %.9g %.9g" % face.points[k] for k in t] + ["endloop", "endfacet"]
    path.write_text("\n".join(lines + ["endsolid house"]) + "\n")


def write_glb(path):
    data, views, accessors, primitives = b"", [], [], []

    def add(values, form, kind, component):
        nonlocal data
        block = b"".join(struct.pack("<" + form, *v) for v in values)
        accessor = {"bufferView": len(views), "componentType": component, "count": len(values), "type": kind}
        if kind == "VEC3" and form == "3f":
            accessor |= {"min": [min(v[k] for v in values) for k in range(3)], "max": [max(v[k] for v in values) for k in range(3)]}
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(block)})
        accessors.append(accessor)
        data += block + bytes(-len(block) % 4)
        return len(accessors) - 1

    for material in (WALL, ROOF):
        vertices, indices = [], []
        for i, face in enumerate(ALL_FACES):
            if face.material == material:
                indices += [len(vertices) + k for t in triangles(i) for k in t]
                vertices += [(p, face.shading_normal(p), face.uv(p), face.color(p)) for p in face.points]
        primitives.append({"material": material, "indices": add([(i,) for i in indices], "H", "SCALAR", 5123), "attributes": {
            "POSITION": add([v[0] for v in vertices], "3f", "VEC3", 5126),
            "NORMAL": add([v[1] for v in vertices], "3f", "VEC3", 5126),
            "TEXCOORD_0": add([(v[2][0], 1 - v[2][1]) for v in vertices], "2f", "VEC2", 5126),
            "COLOR_0": add([v[3] for v in vertices], "3f", "VEC3", 5126)}})
    image = path.with_name("corners.png").read_bytes()
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(image)})
    data += image + bytes(-len(image) % 4)
    materials = []
    for name, color, texture in MATERIALS:
        look = {"baseColorFactor": [*color, 1], "metallicFactor": 0}
        materials.append({"name": name, "pbrMetallicRoughness": look | ({"baseColorTexture": {"index": 0}} if texture else {})})
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "house"}],
        "meshes": [{"primitives": primitives}], "accessors": accessors, "bufferViews": views, "materials": materials,
        "images": [{"bufferView": len(views) - 1, "mimeType": "image/png"}], "textures": [{"source": 0}],
        "buffers": [{"byteLength": len(data)}]}).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) +
                     struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


def write_all(folder):
    """house.json, .obj, .mtl, .ply, .stl, .glb, corners.png, and triangles.obj for programs that take no polygons."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_texture(folder / "corners.png")
    for form, write in (("json", write_json), ("obj", write_obj), ("ply", write_ply), ("stl", write_stl), ("glb", write_glb)):
        write(folder / ("house." + form))
    write_obj(folder / "triangles.obj", polygons=False)
