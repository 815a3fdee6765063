"""Descriptions of scenes as dicts, which become the text of scene files."""

import json
from typing import Any, Dict, Tuple

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
    rest = {key: value for key, value in node.items() if key not in ("vertices", "faces")}
    if "vertices" not in node or "faces" not in node or "file" in node:
        raise ValueError("mesh: expected both vertices and faces, or a file")
    vertices = _rows(node["vertices"], "vertices", "<f4", "fiu")
    faces = _rows(node["faces"], "faces", "<i8", "iu")
    if faces.size and not (0 <= faces.min() and faces.max() < len(vertices)):
        raise ValueError(f"faces: expected indices of vertices, 0 to {len(vertices)} - 1")
    if len(vertices) > 1 << 31:
        raise ValueError(f"vertices: {len(vertices)} are too many")
    records = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    records["count"] = 3
    records["corners"] = faces
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    name = f"<mesh {len(files)}>.ply"
    files[name] = header.encode() + vertices.tobytes() + records.tobytes()
    return {"file": name, **rest}


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
