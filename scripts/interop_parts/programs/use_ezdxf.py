"""ezdxf: its mesh exchange."""
import os

import ezdxf
from ezdxf.addons import meshex
from ezdxf.render import MeshBuilder
from house_json import BACK, OUT, attempt, house, told

print(ezdxf.__version__)
mesh = MeshBuilder()
mesh.vertices = list(map(ezdxf.math.Vec3, house["positions"]))
mesh.faces = house["faces"]
attempt("obj", lambda: open(OUT + "house.obj", "w").write(meshex.obj_dumps(mesh)))
attempt("stl", lambda: open(OUT + "house.stl", "wb").write(meshex.stl_dumpb(mesh)))
attempt("stl", lambda: open(OUT + "text.stl", "w").write(meshex.stl_dumps(mesh)))
attempt("ply", lambda: open(OUT + "house.ply", "wb").write(meshex.ply_dumpb(mesh)))


def read(form, load):
    vertices, faces = [], []
    loaded = load(BACK + "house." + form)
    for m in loaded if isinstance(loaded, list) else [loaded]:
        faces += [[len(vertices) + k for k in f] for f in m.faces]
        vertices += [list(v) for v in m.vertices]
    told(form, faces, vertices)


attempt("read obj", lambda: read("obj", meshex.obj_readfile))
attempt("read stl", lambda: read("stl", meshex.stl_readfile))
