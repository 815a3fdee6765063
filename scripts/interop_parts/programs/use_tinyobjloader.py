"""tinyobjloader, which reads only."""
import numpy as np
import tinyobjloader
from house_json import BACK, attempt, told


def read():
    reader = tinyobjloader.ObjReader()
    config = tinyobjloader.ObjReaderConfig()
    config.triangulate = True
    if not reader.ParseFromFile(BACK + "house.obj", config):
        raise ValueError(reader.Error())
    a = reader.GetAttrib()
    columns = [np.array(list(values)).reshape(-1, n) for values, n in ((a.vertices, 3), (a.normals, 3), (a.texcoords, 2), (a.colors, 3))]
    corners, slots = [], []
    for shape in reader.GetShapes():
        corners += [(i.vertex_index, i.normal_index, i.texcoord_index) for i in shape.mesh.indices]
        slots += list(shape.mesh.material_ids)
    materials = [[m.name, list(m.diffuse), bool(m.diffuse_texname)] for m in reader.GetMaterials()]
    v, n, t = np.array(corners).T
    told("obj", np.arange(len(corners)).reshape(-1, 3), columns[0][v], columns[1][n], columns[2][t], columns[3][v], False, materials, slots)


attempt("read", read)
