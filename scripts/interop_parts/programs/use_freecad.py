"""FreeCAD's mesh module, without a window."""
import sys

sys.path += ["/usr/lib/freecad-python3/lib", "/usr/lib/freecad/lib", "/usr/share/freecad/Mod", "/usr/lib/freecad-python3/Mod/Mesh", "/programs"]
import FreeCAD  # noqa: E402
import Mesh  # noqa: E402
from house_json import BACK, OUT, attempt, house, told  # noqa: E402

print(FreeCAD.Version())


def build():
    return Mesh.Mesh([[house["positions"][v] for v in t] for t in house["triangle_vertices"]])


for name in ("house.obj", "house.ply", "house.stl"):
    attempt(name, lambda: build().write(OUT + name))
attempt("text.stl", lambda: build().write(Filename=OUT + "text.stl", Format="AST"))
attempt("text.ply", lambda: build().write(Filename=OUT + "text.ply", Format="APLY"))


def read(form):
    m = Mesh.Mesh()
    m.read("%shouse.%s" % (BACK, form))
    points, facets = m.Topology
    told(form, facets, [tuple(p) for p in points])


for form in ("obj", "ply", "stl"):
    attempt("read " + form, lambda: read(form))
