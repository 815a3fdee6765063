"""The compiled part of oktett."""

import os
from typing import Any, Callable, Dict, List, Literal, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._results import ClosestPoints, HitLists, Hits, Places

__version__: str

# Or "attribute:NAME".
Field = Union[
    Literal["t", "object", "primitive", "instance", "uv", "normal", "position", "texcoord", "color"], str
]
PointField = Union[
    Literal["distance", "point", "object", "primitive", "instance", "uv", "normal", "texcoord", "color"], str
]
InsideRule = Literal["crossings", "winding"]
Quality = Literal["fast", "balanced", "best", "compact"]

def set_threads(count: int) -> None: ...
def isa() -> str: ...

class Scene:
    def __init__(
        self,
        vertices: Optional[npt.ArrayLike] = None,
        faces: Optional[npt.ArrayLike] = None,
        *,
        transform: Optional[npt.ArrayLike] = None,
        quality: Quality = "balanced",
        normals: Optional[npt.ArrayLike] = None,
        uvs: Optional[npt.ArrayLike] = None,
        colors: Optional[npt.ArrayLike] = None,
        attributes: Optional[Mapping[str, npt.ArrayLike]] = None,
        material: Optional[Union[str, Mapping[str, Any]]] = None,
    ) -> None: ...
    @staticmethod
    def from_file(
        path: Union[str, os.PathLike[str]],
        *,
        definitions: Mapping[str, str] = {},
        quality: Quality = "balanced",
    ) -> Scene: ...
    @staticmethod
    def from_text(
        text: str,
        *,
        name: str = "<text>.yaml",
        files: Mapping[str, bytes] = {},
        definitions: Mapping[str, str] = {},
        quality: Quality = "balanced",
    ) -> Scene: ...
    @staticmethod
    def from_dict(
        description: Mapping[str, Any],
        *,
        name: str = "<dict>.yaml",
        files: Mapping[str, bytes] = {},
        definitions: Mapping[str, str] = {},
        quality: Quality = "balanced",
    ) -> Scene: ...
    def add_mesh(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        *,
        transform: Optional[npt.ArrayLike] = None,
        name: str = "",
        normals: Optional[npt.ArrayLike] = None,
        uvs: Optional[npt.ArrayLike] = None,
        colors: Optional[npt.ArrayLike] = None,
        attributes: Optional[Mapping[str, npt.ArrayLike]] = None,
        material: Optional[Union[str, Mapping[str, Any]]] = None,
    ) -> int: ...
    def set_transform(self, object: int, transform: Optional[npt.ArrayLike]) -> None: ...
    def set_vertices(
        self,
        object: int,
        vertices: npt.ArrayLike,
        first: int = 0,
        *,
        normals: Optional[npt.ArrayLike] = None,
    ) -> None: ...
    def enable(self, object: int) -> None: ...
    def disable(self, object: int) -> None: ...
    def remove(self, object: int) -> None: ...
    def set_mask(self, object: int, mask: int) -> None: ...
    def build(self) -> None: ...
    @property
    def bounds(self) -> Optional[Places]: ...
    @property
    def origin(self) -> npt.NDArray[np.float64]: ...
    @property
    def objects(self) -> List[str]: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def primitive_count(self) -> int: ...
    @property
    def source(self) -> str: ...
    def closest_hit(
        self,
        rays: npt.ArrayLike,
        tmin: npt.ArrayLike = 0.0,
        tmax: npt.ArrayLike = ...,
        *,
        fields: Sequence[Field] = ...,
        mask: npt.ArrayLike = 0xFFFFFFFF,
        ignore: Optional[Mapping[int, npt.ArrayLike]] = None,
    ) -> Hits: ...
    def any_hit(
        self,
        rays: npt.ArrayLike,
        tmin: npt.ArrayLike = 0.0,
        tmax: npt.ArrayLike = ...,
        *,
        mask: npt.ArrayLike = 0xFFFFFFFF,
        ignore: Optional[Mapping[int, npt.ArrayLike]] = None,
    ) -> npt.NDArray[np.bool_]: ...
    def count_hits(
        self,
        rays: npt.ArrayLike,
        tmin: npt.ArrayLike = 0.0,
        tmax: npt.ArrayLike = ...,
        *,
        mask: npt.ArrayLike = 0xFFFFFFFF,
        ignore: Optional[Mapping[int, npt.ArrayLike]] = None,
    ) -> npt.NDArray[np.uint32]: ...
    def all_hits(
        self,
        rays: npt.ArrayLike,
        tmin: npt.ArrayLike = 0.0,
        tmax: npt.ArrayLike = ...,
        *,
        fields: Sequence[Field] = ...,
        mask: int = 0xFFFFFFFF,
        ignore: Optional[Mapping[int, npt.ArrayLike]] = None,
    ) -> HitLists: ...
    def closest_point(
        self, points: npt.ArrayLike, *, fields: Sequence[PointField] = ...
    ) -> ClosestPoints: ...
    def inside(self, points: npt.ArrayLike, *, rule: InsideRule = "crossings") -> npt.NDArray[np.bool_]: ...
    def winding_number(self, points: npt.ArrayLike, *, error: float = 1e-4) -> npt.NDArray[np.float32]: ...
    def signed_distance(
        self, points: npt.ArrayLike, *, sign: InsideRule = "crossings"
    ) -> npt.NDArray[np.float32]: ...
    def _repr_png_(self) -> Optional[bytes]: ...
    def render(
        self,
        width: Optional[int] = None,
        height: Optional[int] = None,
        *,
        samples: Optional[int] = None,
        depth: Optional[int] = None,
        seed: Optional[int] = None,
        integrator: Optional[str] = None,
        camera: Optional[Dict[str, Any]] = None,
        planes: Optional[Sequence[str]] = None,
        progress: Optional[Callable[[float], object]] = None,
    ) -> Dict[str, npt.NDArray[Any]]: ...
