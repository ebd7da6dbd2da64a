# SPDX-License-Identifier: BSD-3-Clause
"""
Contacts of two gears
=====================

Two meshes, two poses, contacts with penetration depths and normals.
"""

# %%
# The gears mesh: the second one is turned by half a tooth, and pushed a little too far in.

import matplotlib.pyplot as plt
import numpy as np
import pyvista

import ode_trimesh_gpu as otg

gear = otg.generate.gear(teeth=16, pitch_radius=0.3, tooth_depth=0.06, width=0.1, bore_radius=0.08)
half_tooth = np.pi / 16
turn = np.array(
    [[np.cos(half_tooth), -np.sin(half_tooth), 0], [np.sin(half_tooth), np.cos(half_tooth), 0], [0, 0, 1]]
)
beside = (turn, [0.585, 0, 0])
contacts = otg.collide(gear, gear, None, beside)
print(contacts)
print(contacts.to_frame()[["positions_x", "positions_y", "depths", "regions", "features"]].head())

# %%
# Each arrow is a normal. It points into the first gear: that gear has to move there, by the depth, to be free at this
# place. Contacts of one connected overlap share a region.

plotter = pyvista.Plotter(off_screen=True, window_size=(1024, 640))
otg.show([gear, (gear, beside)], contacts, arrows=0.06, opacity=0.6, plotter=plotter)
plotter.view_xy()
plotter.camera.zoom(1.4)
plt.figure(figsize=(8, 5))
plt.imshow(plotter.screenshot())
plt.axis("off")
plt.title(f"{len(contacts)} contacts in {contacts.regions.max() + 1} regions")
plt.tight_layout()
plt.show()
