# SPDX-License-Identifier: BSD-3-Clause
"""
A depth camera
==============

A ray for each pixel: distances, normals and faces come back as arrays.
"""

# %%
# A pinhole camera looks down at a bowl with 240 x 320 rays.

import matplotlib.pyplot as plt
import numpy as np

import ode_trimesh_gpu as otg

bowl = otg.generate.bowl(0.5, 0.05, 64, 24)
rows, columns = 240, 320
eye = np.array([0.6, -0.9, 1.2])
forward = -eye / np.linalg.norm(eye)
right = np.cross(forward, [0, 0, 1])
right /= np.linalg.norm(right)
up = np.cross(right, forward)
x, y = np.meshgrid(np.linspace(-0.5, 0.5, columns), np.linspace(0.375, -0.375, rows))
directions = (forward + x[..., None] * right + y[..., None] * up).reshape(-1, 3)

hits = otg.cast_rays(bowl, eye, directions)
print(f"{hits.hit.sum()} of {len(hits)} rays hit")

# %%
# Distances as a picture, and the surface shaded by its normals. The closest point of the surface to the camera is not
# on any of these rays.

distance = np.where(hits.hit, hits.distances, np.nan).reshape(rows, columns)
light = np.array([0.3, 0.2, 0.93])
shade = np.clip(np.nan_to_num(hits.normals) @ light, 0, 1).reshape(rows, columns)
nearest = otg.closest_points(bowl, [eye])
print(f"nearest point {nearest.points[0].round(3)}, {nearest.distances[0]:.4f} away; by rays {np.nanmin(distance):.4f}")

figure, axes = plt.subplots(1, 2, figsize=(10, 4))
picture = axes[0].imshow(distance, cmap="viridis_r")
figure.colorbar(picture, ax=axes[0], label="distance (m)")
axes[1].imshow(np.where(hits.hit.reshape(rows, columns), 0.15 + 0.85 * shade, 1), cmap="gray", vmin=0, vmax=1)
for axis in axes:
    axis.axis("off")
figure.tight_layout()
plt.show()
