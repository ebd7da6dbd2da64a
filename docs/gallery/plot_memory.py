# SPDX-License-Identifier: BSD-3-Clause
"""
Which way out?
==============

A body that sinks deep into another one should leave as it came. Positions alone cannot tell; a `PairMemory` can.
"""

# %%
# A ball is pushed through a plate, step by step.

import matplotlib.pyplot as plt
import numpy as np

import ode_trimesh_gpu as otg

ball, plate = otg.generate.sphere(0.5, 3), otg.generate.box([4, 4, 0.3], 4)
heights = np.linspace(0.7, -0.6, 80)


def way_out(memory):
    """For each height: the upward part of the deepest contact's normal, and its depth."""
    rows = []
    for height in heights:
        contacts = otg.collide(ball, plate, (np.eye(3), [0, 0, height]), memory=memory)
        if len(contacts):
            deepest = contacts.depths.argmax()
            rows.append((height, contacts.normals[deepest, 2], contacts.depths[deepest]))
    return np.array(rows).T


alone, remembered = way_out(None), way_out(otg.PairMemory())

# %%
# Without a memory the ball is pushed down as soon as its middle is below the plate's. With it the ball is pushed back
# up until it sticks out below. Where it sticks out on both sides the depth is cut: no move of that size would free it.

figure, axes = plt.subplots(2, 1, figsize=(8, 6), sharex=True)
for (height, up, depth), name in ((alone, "poses alone"), (remembered, "with memory")):
    axes[0].plot(height, up, label=name)
    axes[1].plot(height, depth, label=name)
axes[0].set_ylabel("normal, upward part")
axes[1].set_ylabel("penetration depth")
axes[1].set_xlabel("height of the ball's middle above the plate's")
axes[1].invert_xaxis()
axes[0].legend()
figure.tight_layout()
plt.show()
