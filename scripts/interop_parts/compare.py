"""What of the house is in a mesh, and whether a picture shows it."""

import math

from house import ALL_FACES, FACES, MATERIALS, dot, face_at, linear, normalized, polygon_area, srgb, texel

# Other axes and units that programs write in, tried one after the other: how to come back from them.
TURNS = {
    "": lambda p: p,
    "turned": lambda p: (p[0], p[2], -p[1]),         # y of the house became z
    "turned back": lambda p: (p[0], -p[2], p[1]),    # z of the house became y
    "turned half": lambda p: (-p[0], p[1], -p[2]),
}
SCALES = {"": 1, "1000 times": 1000, "0.001 times": 0.001}


class Found:
    """Letters for what is as it was: g(eometry), n(ormals), u(v), c(olours), m(aterials), t(exture); and remarks."""

    def __init__(self):
        self.letters, self.notes = "", []
        self.turn, self.scale = "", 1
        self.vertices = self.polygons = 0
        self.flat = False                # normals of the faces in place of the house's
        self.has_normals = False
        self.colors_of = {}              # face: colour of its material
        self.textured = {}               # face: whether its material has a texture
        self.reflected = {}              # face: what its material gives back, if more than arrives
        self.color_curve = None

    def note(self, text):
        if text and text not in self.notes:
            self.notes.append(text)


def place(polygon, turn, scale):
    """The polygon in the house's coordinates, and its face, 1 or -1 for its side; or None."""
    points = [tuple(x / scale for x in turn(c.position)) for c in polygon]
    area = polygon_area(points)
    normal = normalized(area)
    if dot(area, area) == 0:
        return points, None, 1
    for side in (1, -1):
        for face in ALL_FACES:
            if dot(face.normal, normal) * side > 0.99 and all(
                    abs(dot([x - y for x, y in zip(p, face.points[0])], face.normal)) < 2e-3 and face.contains(p, 2e-3) for p in points):
                return points, face, side
    return points, None, 1


def geometry(mesh, found):
    """Finds the axes and units in which the polygons are faces of the house; their places, or None."""
    best = None
    for turn, function in TURNS.items():
        for name, scale in SCALES.items():
            placed = [place(p, function, scale) for p in mesh.polygons]
            missed = sum(face is None for _, face, _ in placed)
            if best is None or missed < best[0]:
                best = (missed, turn, name, scale, placed)
    missed, found.turn, name, found.scale, placed = best
    areas = [0.0] * len(FACES)
    for (points, face, side), polygon in zip(placed, mesh.polygons):
        if face:
            areas[face.index] += side * dot(polygon_area(points), face.normal)
    wrong = [f.index for f in ALL_FACES if abs(abs(areas[f.index]) - f.area) > 2e-3 * f.area]
    if missed or wrong:
        found.note("%d polygons are not of the house" % missed if missed
                   else "faces %s have areas %s" % (wrong, [round(areas[i], 2) for i in wrong]))
        return None
    found.note(found.turn)
    found.note(name)
    if all(side < 0 for _, _, side in placed):
        found.note("inside out")
    elif any(side < 0 for _, _, side in placed):
        found.note("some faces turned over")
    found.letters += "g"
    return placed


def judge(found, letter, name, values, expected, close, others=()):
    """Adds the letter if all values are as expected; notes what else they are."""
    given = [v for v in values if v is not None]
    if not given:
        return
    if len(given) < len(values):
        found.note("%s of some corners only" % name)
        return
    if all(close(v, e) for v, e in zip(values, expected)):
        found.letters += letter
        return
    for what, other in others:
        if all(close(v, e) for v, e in zip(values, other)):
            found.note(what)
            return
    worst = next((v, e) for v, e in zip(values, expected) if not close(v, e))
    found.note("%s wrong: (%s) for (%s)" % (name, *(", ".join("%.3g" % x for x in v) for v in worst)))


def attributes(mesh, placed, found, usual_curve):
    corners = [(p, c, face) for (points, face, _), polygon in zip(placed, mesh.polygons) for p, c in zip(points, polygon)]
    turn = TURNS[found.turn]
    normals = [turn(c.normal) if c.normal else None for _, c, _ in corners]
    near = lambda tolerance: lambda a, b: all(abs(x - y) < tolerance for x, y in zip(a, b))
    found.has_normals = any(normals)
    flat = [f.normal for _, _, f in corners]
    found.flat = all(n and near(0.02)(n, f) for n, f in zip(normals, flat))
    judge(found, "n", "normals", normals, [f.shading_normal(p) for p, _, f in corners], near(0.02), [
        ("normals of faces", flat), ("normals turned over", [tuple(-x for x in f.shading_normal(p)) for p, _, f in corners])])
    uvs = [f.uv(p) for p, _, f in corners]
    roof = [i for i, (_, _, f) in enumerate(corners) if f.material == 1]
    given = [c.uv for _, c, _ in corners]
    judge(found, "u", "uv", given, uvs, near(2e-3), [("v upside down", [(u, 1 - v) for u, v in uvs])])
    upside_down = [m.upside_down for m in mesh.materials if m.texture is True]
    if any(upside_down):
        found.note("picture upside down")
    if "v upside down" in found.notes and all(upside_down) and upside_down:
        found.notes = [n for n in found.notes if n != "v upside down" and n != "picture upside down"]
        found.note("v and picture upside down")  # which shows the same
        found.letters += "u"
    if "u" not in found.letters and any(given) and all(given[i] and near(2e-3)(given[i], uvs[i]) for i in roof):
        found.notes = [n for n in found.notes if not n.startswith("uv ")]
        found.letters += "u"
        found.note("uv of textured faces only")
    colors = [f.color(p) for p, _, f in corners]
    given = [c.color for _, c, _ in corners]
    curve = [tuple(srgb(x) for x in c) for c in colors]
    for name, expected in (("linear", colors), ("sRGB", curve)):
        if all(given) and all(near(0.006)(a, b) for a, b in zip(given, expected)):
            found.color_curve = name
            found.letters += "c"
            if name != usual_curve:
                found.note("colours as %s numbers" % name)
            return
    judge(found, "c", "colours", given, colors, near(0.006), [("white colours", [(1, 1, 1)] * len(colors))])


def materials(mesh, placed, found, curve=False):
    for (_, face, _), slot in zip(placed, mesh.slots):
        material = mesh.materials[slot] if 0 <= slot < len(mesh.materials) else None
        if material:
            found.colors_of[face.index], found.textured[face.index] = material.color, material.texture
            found.reflected[face.index] = max(material.reflected, 1)
            if material.opacity != 1:
                found.note("opacity %g" % material.opacity)
    if not found.colors_of:
        return
    close = lambda a, b, to: all(abs(x - to(y)) < 0.006 for x, y in zip(a, b))
    right = lambda to: all(
        f.index in found.colors_of and close(found.colors_of[f.index], MATERIALS[f.material][1], to) for f in ALL_FACES)
    if right(lambda x: x):
        found.letters += "m"
    elif right(srgb):
        found.note("material colours by the sRGB curve")
    elif right(linear):
        found.note("material colours darkened")
    else:
        colors = sorted({"(%s)" % ", ".join("%.3g" % x for x in c) for c in found.colors_of.values()})
        found.note("materials " + ", ".join(colors))
    textured = [found.textured.get(f.index, False) for f in ALL_FACES]
    if textured == [bool(MATERIALS[f.material][2]) for f in ALL_FACES]:
        found.letters += "t"
    elif any(textured):
        found.note(next((t for t in textured if isinstance(t, str)), "texture on the wrong faces"))


def look_at(mesh, usual_curve="sRGB"):
    """What of the house a mesh holds. Colours are numbers by this curve unless the writer means something else."""
    found = Found()
    found.vertices, found.polygons = mesh.vertices, len(mesh.polygons)
    placed = geometry(mesh, found)
    if placed:
        attributes(mesh, placed, found, usual_curve)
        materials(mesh, placed, found)
    return found


class View:
    """An orthographic camera; the faces that each pixel's centre sees."""

    def __init__(self, eye, target, width=48, height=36, extent=6.0):
        self.eye, self.target, self.width, self.height, self.extent = eye, target, width, height, extent
        forward = normalized([t - e for t, e in zip(target, eye)])
        right = normalized((-forward[2], 0, forward[0]))
        up = (right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2],
              right[0] * forward[1] - right[1] * forward[0])
        self.faces = []
        for y in range(height):
            for x in range(width):
                a, b = ((x + 0.5) / width - 0.5) * extent * width / height, (0.5 - (y + 0.5) / height) * extent
                self.faces.append(self.nearest([e + a * r + b * u for e, r, u in zip(eye, right, up)], forward))

    @staticmethod
    def nearest(origin, direction):
        hits = []
        for face in ALL_FACES:
            slope = dot(direction, face.normal)
            t = dot([p - o for p, o in zip(face.points[0], origin)], face.normal) / slope if slope else -1
            if t > 0 and face.contains(tuple(o + t * d for o, d in zip(origin, direction)), 0):
                hits.append((t, face.index))
        return min(hits)[1] if hits else None

    def inner(self, i):
        """Whether the pixel's neighbours see the same."""
        x, y = i % self.width, i // self.width
        return 0 < x < self.width - 1 and 0 < y < self.height - 1 and all(
            self.faces[i + dx + dy * self.width] == self.faces[i] for dx in (-1, 0, 1) for dy in (-1, 0, 1))


VIEWS = [View((8, 7, 12), (2, 1.5, 1.5)), View((-6, -3, -8), (2, 1.5, 1.5))]


def expected_albedo(found, face, p, times_color):
    """By the file's own words, or None where they say nothing."""
    color = found.colors_of.get(face.index)
    if color is None:
        return None
    if found.textured.get(face.index) is True:
        if "u" not in found.letters:
            return None
        texture = texel(face.uv(p))
        if texture is None:
            return None
        color = tuple(a * b for a, b in zip(color, texture))
    if times_color and found.color_curve == "sRGB":  # which a picture cannot be told from, as numbers between corners differ
        return None
    if times_color and found.color_curve:
        color = tuple(a * b for a, b in zip(color, face.color(p)))
    return color


def check_picture(view, channels, found, times_color, has_colors=True):
    """The first difference between a picture and what the file says; None if there is none."""
    turn = TURNS[found.turn]
    for i, index in enumerate(view.faces):
        if not view.inner(i):
            continue
        hit = math.isfinite(channels["Z"][i])
        if hit != (index is not None):
            return "pixel %d: %s" % (i, "a hole" if index is not None else "a hit beside the house")
        if not hit:
            continue
        p, face = tuple(channels["P." + k][i] for k in "XYZ"), ALL_FACES[index]
        if face_at(p) is not face and abs(dot([a - b for a, b in zip(p, face.points[0])], face.normal)) > 2e-3:
            return "pixel %d: position (%.3g, %.3g, %.3g)" % (i, *p)
        normal = tuple(channels["N." + k][i] for k in "XYZ")
        wanted = face.shading_normal(p) if "n" in found.letters else face.normal if found.flat or not found.has_normals else None
        if wanted and abs(dot(normal, wanted)) < 0.995:
            return "normal (%.3g, %.3g, %.3g) for (%.3g, %.3g, %.3g)" % (*normal, *wanted)
        color = expected_albedo(found, face, p, times_color) if has_colors or not times_color or not found.color_curve else None
        seen = tuple(channels["Albedo." + k][i] for k in "RGB")
        # A material that gives back more light than arrives is darker by what is too much.
        if color and any(not b / found.reflected[index] - 0.02 < a < b + 0.02 for a, b in zip(seen, color)):
            return "albedo (%.3g, %.3g, %.3g) for (%.3g, %.3g, %.3g)" % (*seen, *color)
    return None
