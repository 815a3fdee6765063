"""meshio."""
import meshio
import numpy as np
from house_json import BACK, OUT, attempt, house, told

print(meshio.__version__)
colors = np.round(255 * np.array(house["corner_srgb_colors"])).astype(np.uint8)
data = {"red": colors[:, 0], "green": colors[:, 1], "blue": colors[:, 2]}
for i, name in enumerate(("nx", "ny", "nz")):
    data[name] = np.array(house["corner_normals"], np.float32)[:, i]
for i, name in enumerate("st"):
    data[name] = np.array(house["corner_uvs"], np.float32)[:, i]
positions, cells = np.array(house["corner_positions"], np.float32), [("triangle", np.array(house["triangles"]))]
attempt("ply", lambda: meshio.Mesh(positions, cells, point_data=data).write(OUT + "house.ply"))
attempt("ply", lambda: meshio.Mesh(positions, cells, point_data=data).write(OUT + "text.ply", binary=False))
with_normals = {"obj:vn": np.array(house["corner_normals"]), "obj:vt": np.array(house["corner_uvs"])}
attempt("obj", lambda: meshio.Mesh(positions, cells, point_data=with_normals).write(OUT + "house.obj"))
attempt("stl", lambda: meshio.Mesh(positions, cells).write(OUT + "house.stl"))
attempt("stl", lambda: meshio.Mesh(positions, cells).write(OUT + "bytes.stl", binary=True))


def read(form):
    m = meshio.read("%shouse.%s" % (BACK, form))
    d = m.point_data
    column = lambda *names: np.stack([d[n] for n in names], 1) if all(n in d for n in names) else None
    normals, uvs, colors = column("nx", "ny", "nz"), column("s", "t") if "s" in d else column("u", "v"), column("red", "green", "blue")
    if colors is not None and colors.dtype == np.uint8:
        colors = colors / 255
    told(form, np.concatenate([c.data for c in m.cells if c.type == "triangle"]), m.points[:, :3],
         d.get("obj:vn", normals), d.get("obj:vt", uvs), colors)


for form in ("obj", "ply", "stl"):
    attempt("read " + form, lambda: read(form))
