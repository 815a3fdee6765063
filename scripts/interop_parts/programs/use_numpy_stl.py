"""numpy-stl."""
import numpy as np
import stl
from house_json import BACK, OUT, attempt, house, told


mesh = stl.mesh.Mesh(np.zeros(len(house["triangles"]), stl.mesh.Mesh.dtype))
mesh.vectors[:] = np.array(house["corner_positions"])[np.array(house["triangles"])]
attempt("stl", lambda: mesh.save(OUT + "house.stl"))
attempt("stl", lambda: mesh.save(OUT + "text.stl", mode=stl.Mode.ASCII))


def read():
    m = stl.mesh.Mesh.from_file(BACK + "house.stl")
    told("stl", np.arange(3 * len(m.vectors)).reshape(-1, 3), m.vectors.reshape(-1, 3))


attempt("read", read)
