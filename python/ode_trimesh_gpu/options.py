# SPDX-License-Identifier: BSD-3-Clause
"""How meshes collide, and where that is computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from . import _core
from .errors import ArgumentError

Backend = Literal["default", "auto", "cpu", "opencl"]

_BACKENDS = {"default": 0, "auto": 1, "cpu": 2, "opencl": 3}
_MODELS = {"auto": 0, "pairwise": 1, "solid": 2}
_REDUCTIONS = {"none": 0, "binning": 1, "cone": 2}


def _number(table: dict[str, int], name: str, value: str) -> int:
    try:
        return table[value]
    except (KeyError, TypeError):
        raise ArgumentError(f"{name} must be one of {', '.join(table)}, not {value!r}") from None


@dataclass(frozen=True)
class Options:
    """How a mesh collides. Two meshes with different options meet as dGpuTriMeshParams (params.h) says."""

    #: "auto", "solid" (contacts of the overlap as a whole) or "pairwise" (of each pair of triangles).
    contact_model: Literal["auto", "pairwise", "solid"] = "auto"
    #: At most this many contacts for a pair of meshes, 1 to 65535.
    max_contacts: int = 65535
    #: At most this many contacts for one connected overlap, 1 to 64.
    contacts_per_region: int = 16
    #: Overlaps nearer to each other than this length count as one. 0: off.
    region_merge: float = 0.0
    #: How many contacts become few: "none", "binning" or "cone".
    reduction: Literal["none", "binning", "cone"] = "binning"
    #: For "binning": bins along x, y, z of position, then of normal; 1 to 64 each.
    bins: tuple[int, int, int, int, int, int] = (3, 3, 3, 3, 3, 3)
    #: Whether earlier queries of a pair guide the next one. Outside of worlds that takes a PairMemory, too.
    history: bool = True
    #: "default" (what `set_backend` says), "auto", "cpu" or "opencl".
    backend: Backend = "default"
    #: Pairs of triangles whose boxes overlap; a pair of meshes with more is an error.
    max_pairs: int = 16777216

    def _params(self, *, history: bool = True) -> _core.Params:
        params = _core.Params()
        params.contact_model = _number(_MODELS, "contact_model", self.contact_model)
        params.max_contacts = self.max_contacts
        params.contacts_per_region = self.contacts_per_region
        params.region_merge = self.region_merge
        params.reduction = _number(_REDUCTIONS, "reduction", self.reduction)
        params.bins = list(self.bins)
        params.history = int(self.history and history)
        params.backend = _number(_BACKENDS, "backend", self.backend)
        params.max_pairs = self.max_pairs
        return params


def set_backend(backend: Literal["auto", "cpu", "opencl"], *, wait: bool = True) -> bool:
    """Chooses where queries are computed that have no choice of their own.

    "auto" and "opencl" open an OpenCL device, which takes tens of seconds the first time on a machine: kernels are
    built and kept on disk. "auto" opens in the background; `wait` waits for it. Results do not depend on the choice.

    Returns whether a device is open now.
    """
    _core.set_backend(_number({k: v for k, v in _BACKENDS.items() if k != "default"}, "backend", backend))
    # In short pieces, so that Ctrl-C is noticed.
    while wait and _core.wait_for_devices(200) == 3:
        pass
    return backend != "cpu" and len(_core.open_devices()) > 0


def devices() -> list[dict[str, object]]:
    """The open OpenCL devices: index, name, switched_off, queries, failed_queries, mesh_bytes, memory_bytes."""
    return list(_core.open_devices())


def set_threads(count: int) -> None:
    """How many threads work on one batch, 1 to 1024; 0: one for each core. Results do not depend on it."""
    _core.set_threads(count)


def get_threads() -> int:
    """How many threads work on one batch."""
    return _core.get_threads()
