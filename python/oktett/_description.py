"""Descriptions of scenes as dicts, which become the text of scene files."""

import json
from typing import Any, Dict, List, Tuple

import numpy as np


def to_text(description: Dict[str, Any]) -> Tuple[str, Dict[str, bytes]]:
    """The text of a scene file, and the files that stand for the arrays of its meshes."""
    if not isinstance(description, dict):
        raise ValueError(f"expected a dict with the keys of scene files, found {type(description).__name__}")
    files: Dict[str, bytes] = {}
    tree = {"oktett": 1, **description}
    return json.dumps(_plain(tree, files), ensure_ascii=False, allow_nan=False, indent=1), files


def _plain(node: Any, files: Dict[str, bytes]) -> Any:
    """The same with dicts, lists, numbers and strings alone."""
    if isinstance(node, dict):
        if "vertices" in node or "faces" in node:
            node = _mesh_in_file(node, files)
        return {str(key): _plain(value, files) for key, value in node.items()}
    if isinstance(node, (list, tuple)):
        return [_plain(value, files) for value in node]
    if isinstance(node, (np.ndarray, np.generic)):
        return _plain(node.tolist(), files)
    if node is None or isinstance(node, (str, int, float)):
        return node
    if hasattr(node, "__fspath__"):
        return node.__fspath__()
    raise ValueError(f"a scene cannot hold a {type(node).__name__}")


def _mesh_in_file(node: Dict[str, Any], files: Dict[str, bytes]) -> Dict[str, Any]:
    """A mesh of arrays as one of a binary PLY file."""
    carried = ("normals", "uvs", "colors", "attributes")
    rest = {key: value for key, value in node.items() if key not in ("vertices", "faces", *carried)}
    if "vertices" not in node or "faces" not in node or "file" in node:
        raise ValueError("mesh: expected both vertices and faces, or a file")
    places = np.asarray(node["vertices"])
    vertices = _rows(places, "vertices", _type_of_places(places.dtype), "fiu")
    faces = _rows(node["faces"], "faces", "<i8", "iu")
    if faces.size and not (0 <= faces.min() and faces.max() < len(vertices)):
        raise ValueError(f"faces: expected indices of vertices, 0 to {len(vertices)} - 1")
    if len(vertices) > 1 << 31:
        raise ValueError(f"vertices: {len(vertices)} are too many")
    columns = _columns({key: node[key] for key in carried if node.get(key) is not None}, len(vertices), len(faces))
    if any(owner == "corner" for owner, _, _ in columns):
        # Each corner becomes a vertex of its own.
        columns = [_at_corners(column, faces) for column in columns]
        vertices, faces = vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3)
    of_vertices = [("vertex", ["x", "y", "z"], vertices)] + [c for c in columns if c[0] == "vertex"]
    of_faces = [c for c in columns if c[0] == "face"]
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\n{_properties(of_vertices)}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\n{_properties(of_faces)}end_header\n"
    )
    records = _records(of_faces, len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    records["count"] = 3
    records["corners"] = faces
    name = f"<mesh {len(files)}>.ply"
    files[name] = header.encode() + _records(of_vertices, len(vertices), []).tobytes() + records.tobytes()
    return {"file": name, **rest}


# What numbers belong to ("vertex", "face" or "corner"), the names of their properties, and their rows.
_Column = Tuple[str, List[str], np.ndarray]
_TYPES = {"u1": "uchar", "u2": "ushort", "f4": "float", "f8": "double"}


def _columns(carried: Dict[str, Any], vertices: int, faces: int) -> List[_Column]:
    columns = []
    for key, last, names in (("normals", (3,), ["nx", "ny", "nz"]), ("uvs", (2,), ["s", "t"])):
        if key in carried:
            owner, array = _owned(key, carried[key], vertices, faces, last)
            if owner == "face":
                raise ValueError(f"{key}: expected those of vertices or of the corners of faces")
            columns.append((owner, names, array.astype("<f4")))
    if "colors" in carried:
        owner, array = _owned("colors", carried["colors"], vertices, faces, (3, 4))
        kind = array.dtype.str[1:]
        if array.dtype.kind != "f" and kind not in _TYPES:
            raise ValueError(f"colors: expected floats, uint8 or uint16, found elements of type {array.dtype}")
        array = array.astype("<f4" if array.dtype.kind == "f" else "<" + kind)
        columns.append((owner, ["red", "green", "blue", "alpha"][: array.shape[1]], array))
    attributes = carried.get("attributes", {})
    if not isinstance(attributes, dict):
        raise ValueError("attributes: expected a dict of arrays")
    for name, value in attributes.items():
        if not isinstance(name, str) or not name or name.split() != [name]:
            raise ValueError(f"attributes: expected names without blanks, found {name!r}")
        owner, array = _owned(f"attributes[{name!r}]", value, vertices, faces, (1, 2, 3, 4))
        size = array.shape[1]
        names = [name] if size == 1 else [f"{name}.{k}" for k in range(size)]
        columns.append((owner, names, array.astype("<f4")))
    return columns


def _owned(name: str, value: Any, vertices: int, faces: int, last: Tuple[int, ...]) -> Tuple[str, np.ndarray]:
    """What the rows of an array belong to, and the rows."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{name}: expected numbers, found elements of type {array.dtype}")
    rows = array[:, None] if array.ndim == 1 and 1 in last else array
    if rows.ndim == 3 and rows.shape[:2] == (faces, 3) and rows.shape[2] in last:
        return "corner", rows.reshape(-1, rows.shape[2])
    if rows.ndim == 2 and rows.shape[1] in last:
        if len(rows) == vertices:
            return "vertex", rows
        if len(rows) == faces:
            return "face", rows
    raise ValueError(f"{name}: found the shape {array.shape} for {vertices} vertices and {faces} faces")


def _at_corners(column: _Column, faces: np.ndarray) -> _Column:
    owner, names, rows = column
    if owner == "face":
        return column
    return "vertex", names, rows[faces.ravel()] if owner == "vertex" else rows


def _properties(columns: List[_Column]) -> str:
    return "".join(f"property {_TYPES[rows.dtype.str[1:]]} {name}\n" for _, names, rows in columns for name in names)


def _records(columns: List[_Column], count: int, first: List[Any]) -> np.ndarray:
    parts = [(f"part {i}", rows.dtype, (rows.shape[1],)) for i, (_, _, rows) in enumerate(columns)]
    records = np.empty(count, first + parts)
    for i, (_, _, rows) in enumerate(columns):
        records[f"part {i}"] = rows
    return records


def _type_of_places(dtype: Any) -> str:
    """Doubles unless they are floats: the reader takes a centre off places far from the origin, then rounds."""
    return "<f4" if dtype.kind == "f" and dtype.itemsize <= 4 else "<f8"


def _rows(value: Any, name: str, kind: str, allowed: str) -> np.ndarray:
    array = np.asarray(value)
    if array.size == 0:
        array = array.reshape(-1, 3).astype(kind)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in allowed:
        raise ValueError(
            f"{name}: expected numbers of shape ({name[0] == 'v' and 'n' or 'm'}, 3), "
            f"found {array.dtype} of the shape {array.shape}"
        )
    return array.astype(kind)
