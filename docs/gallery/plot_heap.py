# SPDX-License-Identifier: BSD-3-Clause
"""
A heap
======

Sixty nuts, bolts and rings fall into a tray. Meshes that lock into each other are what contact models find hard.
"""

import matplotlib.pyplot as plt
import numpy as np
import pyvista

import ode_trimesh_gpu as otg

# %%
# Parts in a column above the tray, each turned in its own way.

rng = np.random.default_rng(1)
world = otg.World(iterations=30, friction=0.5, max_correcting_velocity=1.0, linear_damping=1e-3, angular_damping=1e-3)
world.add(otg.generate.tray([1.2, 1.2, 0.5], 0.1), kind="static", name="tray")
ring = otg.generate.torus(0.1, 0.03, 20, 10)
nut = otg.generate.cylinder(0.09, 0.07, 6)
lump = otg.generate.lump(0.09, 2, 0.3, 3)
colors = [(0.1, 0.35, 0.75), (0.85, 0.6, 0.08), (0.8, 0.25, 0.12)]
for i in range(60):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.linalg.det(q))
    place = [0.3 * (i % 3 - 1), 0.3 * (i // 3 % 3 - 1), 0.3 + 0.25 * (i // 9)]
    world.add([ring, nut, lump][i % 3], (q, place), density=1000, color=colors[i % 3])

# %%
# Three seconds. The energy goes down to rest, and the number of contacts up.

energies, counts, depths = [], [], []


def note(world):
    energies.append(sum(world.energy))
    counts.append(len(world.contacts))
    depths.append(world.contacts.depths.max(initial=0) * 1000)


dt = 0.004
world.step(dt, 750, callback=note)
print(world, f"{counts[-1]} contacts, {depths[-1]:.2f} mm deep at most")

# %%

plotter = pyvista.Plotter(off_screen=True, window_size=(900, 700))
otg.show(world, arrows=0.05, plotter=plotter, camera=[(1.3, -1.5, 1.6), (0, 0, 0.1), (0, 0, 1)])
figure, axes = plt.subplots(1, 2, figsize=(10, 4))
axes[0].imshow(plotter.screenshot())
axes[0].axis("off")
time = np.arange(len(counts)) * dt
axes[1].plot(time, counts, label="contacts")
axes[1].plot(time, energies, label="energy (J)")
axes[1].plot(time, np.array(depths) * 10, label="depth (0.1 mm)", alpha=0.6)
axes[1].set_xlabel("seconds")
axes[1].legend()
figure.tight_layout()
plt.show()
