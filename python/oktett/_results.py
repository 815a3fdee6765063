"""What queries return."""

from typing import Any, Dict, NamedTuple, Optional

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Places = npt.NDArray[np.floating[Any]]  # float64 if the scene has an origin, else float32
Ids = npt.NDArray[np.uint32]


class _Carried:
    """What meshes carry at hits; not among the fields of the tuples, whose number stays the same."""

    texcoord: Optional[Floats]
    color: Optional[Floats]
    attributes: Optional[Dict[str, Floats]]

    def __new__(
        cls,
        *columns: Any,
        texcoord: Optional[Floats] = None,
        color: Optional[Floats] = None,
        attributes: Optional[Dict[str, Floats]] = None,
        **named: Any,
    ) -> Any:
        self = super().__new__(cls, *columns, **named)
        self.texcoord, self.color, self.attributes = texcoord, color, attributes
        return self

    def __repr__(self) -> str:
        carried = {"texcoord": self.texcoord, "color": self.color, "attributes": self.attributes}
        given = "".join(f", {name}={value!r}" for name, value in carried.items() if value is not None)
        return super().__repr__()[:-1] + given + ")"


class _HitColumns(NamedTuple):
    t: Optional[Floats] = None
    object: Optional[Ids] = None
    primitive: Optional[Ids] = None
    instance: Optional[Ids] = None
    uv: Optional[Floats] = None
    normal: Optional[Floats] = None
    position: Optional[Places] = None


class Hits(_Carried, _HitColumns):
    """The nearest hit of each ray, see Scene.closest_hit. Fields that were not asked for are None."""


class _PointColumns(NamedTuple):
    distance: Optional[Floats] = None
    point: Optional[Places] = None
    object: Optional[Ids] = None
    primitive: Optional[Ids] = None
    instance: Optional[Ids] = None
    uv: Optional[Floats] = None
    normal: Optional[Floats] = None


class ClosestPoints(_Carried, _PointColumns):
    """The nearest point of all surfaces, see Scene.closest_point. Fields that were not asked for are None."""


class _ListColumns(NamedTuple):
    splits: npt.NDArray[np.int64]
    t: Optional[Floats] = None
    object: Optional[Ids] = None
    primitive: Optional[Ids] = None
    instance: Optional[Ids] = None
    uv: Optional[Floats] = None
    normal: Optional[Floats] = None
    position: Optional[Places] = None


class HitLists(_Carried, _ListColumns):
    """All hits of each ray, see Scene.all_hits. Fields that were not asked for are None."""

    @property
    def ray_ids(self) -> npt.NDArray[np.int64]:
        """The ray of each hit."""
        return np.repeat(np.arange(len(self.splits) - 1), np.diff(self.splits))
