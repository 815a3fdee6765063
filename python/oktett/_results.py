"""What queries return."""

from typing import NamedTuple, Optional

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Ids = npt.NDArray[np.uint32]


class Hits(NamedTuple):
    """The nearest hit of each ray, see Scene.closest_hit. Fields that were not asked for are None."""

    t: Optional[Floats] = None
    object: Optional[Ids] = None
    primitive: Optional[Ids] = None
    instance: Optional[Ids] = None
    uv: Optional[Floats] = None
    normal: Optional[Floats] = None
    position: Optional[Floats] = None


class ClosestPoints(NamedTuple):
    """The nearest point of all surfaces, see Scene.closest_point. Fields that were not asked for are None."""

    distance: Optional[Floats] = None
    point: Optional[Floats] = None
    object: Optional[Ids] = None
    primitive: Optional[Ids] = None
    instance: Optional[Ids] = None
    uv: Optional[Floats] = None
    normal: Optional[Floats] = None


class HitLists(NamedTuple):
    """All hits of each ray, see Scene.all_hits. Fields that were not asked for are None."""

    splits: npt.NDArray[np.int64]
    t: Optional[Floats] = None
    object: Optional[Ids] = None
    primitive: Optional[Ids] = None
    instance: Optional[Ids] = None
    uv: Optional[Floats] = None
    normal: Optional[Floats] = None
    position: Optional[Floats] = None

    @property
    def ray_ids(self) -> npt.NDArray[np.int64]:
        """The ray of each hit."""
        return np.repeat(np.arange(len(self.splits) - 1), np.diff(self.splits))
