# SPDX-License-Identifier: BSD-3-Clause
"""Contacts as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas

#: Names of the numbers in `Contacts.features`.
FEATURES = ("region", "vertex", "crossing", "middle", "face", "coplanar")

_Columns = TypeVar("_Columns", bound="Contacts")


@dataclass(frozen=True)
class Contacts:
    """n contacts. Positions and normals are in the world, lengths in its unit.

    The normal points into the first mesh: moving that mesh by depth * normal separates the two at this place.
    """

    positions: NDArray[np.float64]  #: (n, 3)
    normals: NDArray[np.float64]  #: (n, 3), unit
    depths: NDArray[np.float64]  #: (n,), penetration depth
    triangles: NDArray[np.int32]  #: (n, 2): faces of the first and of the second mesh
    ids: NDArray[np.uint64]  #: (n,): names that stay from step to step, for warm starting; 0 with shapes
    regions: NDArray[np.int32]  #: (n,): contacts of one connected overlap share a number
    coherence: NDArray[np.float64]  #: (n,): of the region, 1 flat, 0 a limb through a limb, -1 unknown
    features: NDArray[np.int32]  #: (n,): what the contact was made from, an index of FEATURES
    feature_sides: NDArray[np.int32]  #: (n,): whose feature, 1 or 2; 0 for neither
    vertices: NDArray[np.int32]  #: (n, 2): of the feature: a vertex and -1, or the ends of an edge; else -1
    flags: NDArray[np.int32]  #: (n,): 1 inside, 2 contained, 4 clamped, added up

    def __len__(self) -> int:
        return len(self.depths)

    @property
    def inside(self) -> NDArray[np.bool_]:
        """(n,): the feature's point lies inside the other solid, not on its surface."""
        return np.asarray((self.flags & 1) != 0)

    @property
    def contained(self) -> NDArray[np.bool_]:
        """(n,): a whole closed part of one mesh lies inside the other one."""
        return np.asarray((self.flags & 2) != 0)

    @property
    def clamped(self) -> NDArray[np.bool_]:
        """(n,): the surfaces are entangled, and the depth was cut so as not to throw bodies."""
        return np.asarray((self.flags & 4) != 0)

    def select(self: _Columns, index: Any) -> _Columns:
        """The contacts that `index` chooses: a slice, numbers or a mask."""
        return type(self)(*(getattr(self, field.name)[index] for field in fields(self)))

    def to_frame(self) -> pandas.DataFrame:
        """One row for each contact (pandas)."""
        import pandas

        columns: dict[str, Any] = {}
        for field in fields(self):
            values = getattr(self, field.name)
            if values.ndim == 1:
                columns[field.name] = values
            else:
                names = "xyz" if values.shape[1] == 3 else "12"
                columns.update({f"{field.name}_{name}": values[:, k] for k, name in enumerate(names)})
        columns["features"] = np.array(FEATURES)[self.features] if len(self) else []
        return pandas.DataFrame(columns)

    def __repr__(self) -> str:
        deepest = f", {self.depths.max():.4g} deep at most" if len(self) else ""
        return f"<{type(self).__name__}: {len(self)}{deepest}>"


def concatenate(parts: Sequence[_Columns]) -> _Columns:
    """All contacts of at least one object, in their order."""
    kind = type(parts[0])
    return kind(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(kind)))


@dataclass(frozen=True)
class ContactBatch:
    """The contacts of many pairs. `batch[i]` are those of pair i."""

    contacts: Contacts  #: of all pairs, one pair after the other
    first: NDArray[np.int64]  #: (m + 1,): where each pair's contacts begin, and the number of all

    @property
    def counts(self) -> NDArray[np.int64]:
        """(m,): how many contacts each pair has."""
        return np.diff(self.first)

    @property
    def pairs(self) -> NDArray[np.int64]:
        """(n,): the number of the pair to which each contact belongs."""
        return np.repeat(np.arange(len(self)), self.counts)

    @property
    def max_depths(self) -> NDArray[np.float64]:
        """(m,): the penetration depth of each pair's deepest contact; 0 without contacts."""
        depths = np.zeros(len(self))
        np.maximum.at(depths, self.pairs, self.contacts.depths)
        return depths

    def __len__(self) -> int:
        return len(self.first) - 1

    def __getitem__(self, pair: int) -> Contacts:
        count = len(self)
        if not -count <= pair < count:
            raise IndexError(f"there are {count} pairs")
        pair %= count
        return self.contacts.select(slice(int(self.first[pair]), int(self.first[pair + 1])))

    def __iter__(self) -> Iterator[Contacts]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<ContactBatch: {len(self.contacts)} contacts of {len(self)} pairs>"
