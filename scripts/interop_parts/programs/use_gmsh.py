"""Gmsh: reads the house and writes it."""
import gmsh
from house_json import BACK, OUT, attempt, told

gmsh.initialize()
print(gmsh.GMSH_API_VERSION)


def convert(source, *targets):
    gmsh.clear()
    gmsh.merge(source)
    for target in targets:
        gmsh.write(OUT + target)


attempt("write", lambda: convert(BACK + "../house/house.stl", "house.ply2", "house.stl", "house.obj", "house.ply"))


def read(form):
    gmsh.clear()
    gmsh.merge("%shouse.%s" % (BACK, form))
    tags, points, _ = gmsh.model.mesh.getNodes()
    place = {t: i for i, t in enumerate(tags)}
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    told(form, [[place[t] for t in nodes[i:i + 3]] for i in range(0, len(nodes), 3)], points.reshape(-1, 3))


for form in ("obj", "ply", "stl"):
    attempt("read " + form, lambda: read(form))
