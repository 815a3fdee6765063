"""What scripts of programs in Python share: the house as arrays, and how they say what they have read."""
import json
import os
import traceback

house = json.load(open(os.environ["HOUSE"] + "/house.json"))
OUT, BACK = os.environ["OUT"] + "/", os.environ["BACK"] + "/"


def attempt(what, call):
    """Calls it, and goes on if it fails."""
    try:
        call()
    except Exception:
        print("FAILED", what, flush=True)
        traceback.print_exc()


def told(form, triangles, positions, normals=None, uvs=None, colors=None, by_corner=False, materials=(), slots=None):
    """Notes what was read of $BACK/house.FORM: arrays for the vertices, or uvs by corner of triangles."""
    polygons = []
    for i, triangle in enumerate(triangles):
        polygons.append([[list(map(float, positions[v])), list(map(float, normals[v])) if normals is not None else None,
                          list(map(float, uvs[3 * i + k if by_corner else v]))[:2] if uvs is not None else None,
                          list(map(float, colors[v]))[:3] if colors is not None else None] for k, v in enumerate(triangle)])
    data = {"vertices": len(positions), "polygons": polygons, "materials": list(materials)}
    if slots is not None:
        data["slots"] = list(map(int, slots))
    json.dump(data, open("%sread_%s.json" % (OUT, form), "w"))
