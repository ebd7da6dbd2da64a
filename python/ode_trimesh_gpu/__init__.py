# SPDX-License-Identifier: BSD-3-Clause
"""Triangle-mesh collision for the Open Dynamics Engine (ODE), on the CPU and on OpenCL devices.

>>> import numpy as np, ode_trimesh_gpu as otg
>>> box = otg.generate.box([1, 1, 1])
>>> up = np.eye(4)
>>> up[2, 3] = 0.99
>>> contacts = otg.collide(box, box, up)
>>> contacts.depths.max().round(6).item()
0.01
"""

import atexit as _atexit

from . import _core, generate
from .contacts import FEATURES, ContactBatch, Contacts
from .errors import ArgumentError, BusyError, Error, MeshError, OdeError, PoseError, SceneError
from .mesh import MassProperties, Mesh, MeshReport, Problem
from .options import Options, devices, get_threads, set_backend, set_threads
from .queries import (
    ClosestPoints,
    Distance,
    PairMemory,
    RayHits,
    cast_rays,
    closest_points,
    collide,
    collide_many,
    distance,
    inside,
    overlaps,
)
from .recording import Recording
from .scene import Run, simulate
from .view import show
from .world import (
    Body,
    Box,
    Capsule,
    Cylinder,
    Joint,
    Plane,
    Sphere,
    State,
    Terrain,
    World,
    WorldContacts,
)

__version__ = _core.version()
_atexit.register(_core.close)

__all__ = [
    "FEATURES",
    "ArgumentError",
    "Body",
    "Box",
    "BusyError",
    "Capsule",
    "ClosestPoints",
    "ContactBatch",
    "Contacts",
    "Cylinder",
    "Distance",
    "Error",
    "Joint",
    "MassProperties",
    "Mesh",
    "MeshError",
    "MeshReport",
    "OdeError",
    "Options",
    "PairMemory",
    "Plane",
    "PoseError",
    "Problem",
    "RayHits",
    "Recording",
    "Run",
    "SceneError",
    "Sphere",
    "State",
    "Terrain",
    "World",
    "WorldContacts",
    "cast_rays",
    "closest_points",
    "collide",
    "collide_many",
    "devices",
    "distance",
    "generate",
    "get_threads",
    "inside",
    "overlaps",
    "set_backend",
    "set_threads",
    "show",
    "simulate",
]
