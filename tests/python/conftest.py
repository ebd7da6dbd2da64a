# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python package share. They run against the installed package: see scripts/python.sh."""

import os
import shutil

import numpy as np
import pytest

import ode_trimesh_gpu as otg


def pose(x=0.0, y=0.0, z=0.0, axis=(0, 0, 1), angle=0.0):
    """A 4x4 matrix: a rotation about an axis (Rodrigues), then a translation."""
    k = np.array(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix[:3, 3] = x, y, z
    return matrix


def random_poses(count, reach, seed):
    """Uniform rotations (normalised Gaussian quaternions) and translations within +-reach."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(count, 4))
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    poses = np.tile(np.eye(4), (count, 1, 1))
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    for i in range(3):
        for j in range(3):
            poses[:, i, j] = rows[i][j]
    poses[:, :3, 3] = rng.uniform(-reach, reach, (count, 3))
    return poses


@pytest.fixture
def box():
    return otg.generate.box([1, 1, 1])


@pytest.fixture
def ball():
    return otg.generate.sphere(0.5, 3)


@pytest.fixture(scope="session")
def program():
    """The program `otg`, to compare with: OTG_PROGRAM names it."""
    path = os.environ.get("OTG_PROGRAM") or shutil.which("otg")
    if not path:
        pytest.skip("the program otg is not there (OTG_PROGRAM)")
    return path
