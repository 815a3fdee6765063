"""Rays against triangle meshes and exact surfaces, by the million, and pictures of them.

Scene holds what is traced; its methods answer arrays of rays and points. The submodules oktett.open3d and
oktett.trimesh offer the same with the names and conventions of those packages.
"""

from ._oktett import Scene, __version__, isa, set_threads
from ._results import ClosestPoints, HitLists, Hits

__all__ = ["ClosestPoints", "HitLists", "Hits", "Scene", "isa", "set_threads", "__version__"]

Scene.__module__ = "oktett"
