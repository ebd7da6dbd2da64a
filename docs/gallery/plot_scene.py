# SPDX-License-Identifier: BSD-3-Clause
"""
A scene as frames
=================

A scene is a dict or a JSON file. What happens comes back as pandas frames; the animation is a glTF file.
"""

# %%
# Gears, a torus and lumps fall onto hills.

import pathlib
import tempfile

import matplotlib.pyplot as plt
import numpy as np
import pyvista

import ode_trimesh_gpu as otg

scene = {
    "dt": 0.004,
    "steps": 600,
    "meshes": {
        "hills": {"generate": "ground", "size": 4, "thickness": 0.4, "hill_height": 0.1, "hill_length": 2},
        "gear": {"generate": "gear", "pitch_radius": 0.3, "tooth_depth": 0.06, "width": 0.12, "bore_radius": 0.1},
        "torus": {"generate": "torus", "major_radius": 0.25, "minor_radius": 0.09},
        "lump": {"generate": "lump", "radius": 0.25, "level": 3},
    },
    "bodies": [{"name": "hills", "mesh": "hills", "static": True}]
    + [
        {"name": f"{kind} {i}", "mesh": kind, "position": [0.8 * (i - 1), 0.8 * (k - 1), 0.7 + 0.1 * i]}
        for k, kind in enumerate(("gear", "torus", "lump"))
        for i in range(3)
    ],
}
with tempfile.TemporaryDirectory() as folder:
    animation = pathlib.Path(folder) / "run.glb"
    run = otg.simulate(scene, gltf=animation)
    print(f"{animation.name}: {animation.stat().st_size / 1000:.0f} kB")
print(run)
print(run.bodies[["name", "x", "y", "z"]].round(3))

# %%

plotter = pyvista.Plotter(off_screen=True, window_size=(900, 700))
otg.show(run, plotter=plotter, camera=[(2.6, -3.2, 2.4), (0, 0, 0.1), (0, 0, 1)])
figure, axes = plt.subplots(1, 2, figsize=(10, 4))
axes[0].imshow(plotter.screenshot())
axes[0].axis("off")
steps = run.steps
axes[1].plot(steps["time"], steps["kinetic_energy"] + steps["potential_energy"], label="energy (J)")
axes[1].plot(steps["time"], 10 * steps["contacts"], label="contacts (x 10)", alpha=0.6)
axes[1].plot(steps["time"], np.cumsum(steps["collide_ms"]), label="time colliding (ms, summed)")
axes[1].set_xlabel("seconds")
axes[1].legend()
figure.tight_layout()
plt.show()
