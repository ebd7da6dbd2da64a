# SPDX-License-Identifier: BSD-3-Clause
"""
A gripper
=========

Two fingers on sliders close on a bumpy object, lift it, and hold it by friction.
"""

# %%
# The hand is a kinematic body: it follows its velocity. Each finger hangs on a slider with a motor. The object is a
# mesh with inner corners, so that the fingers touch it at several places.

import matplotlib.pyplot as plt
import numpy as np
import pyvista

import ode_trimesh_gpu as otg

world = otg.World(friction=1.0, iterations=60, max_correcting_velocity=0.5)
world.add(otg.Plane(), name="table")
lump = otg.generate.lump(0.05, level=3, amplitude=0.25, seed=5)
part = world.add(lump, (np.eye(3), [0, 0, 0.056]), density=400, name="part", color=(0.8, 0.25, 0.12))
hand = world.add(otg.generate.box([0.3, 0.06, 0.02]), (np.eye(3), [0, 0, 0.2]), kind="kinematic", name="hand")
pad = otg.generate.box([0.02, 0.05, 0.12], 3)
fingers, motors = [], []
for side in (-1, 1):
    finger = world.add(pad, (np.eye(3), [0.11 * side, 0, 0.085]), density=800, name=f"finger {side}")
    slider = world.add_joint("slider", hand, finger, axis=(1, 0, 0))
    fingers.append(finger)
    motors.append((slider, side))

# %%
# Close, lift, hold. The contact forces of each step are arrays.

dt = 0.002
heights, grip = [], []


def note(world):
    heights.append(part.position[2])
    contacts = world.contacts
    of_fingers = np.isin(contacts.bodies, [f.index for f in fingers]).any(axis=1)
    held = (contacts.bodies == part.index).any(axis=1) & of_fingers
    grip.append(np.abs(contacts.forces[held, 0]).sum() / 2)


def drive(speed, force=6.0):
    for slider, side in motors:
        # A slider's axis points from the second body to the first.
        slider.set_motor(side * speed, force)


drive(0.1)
world.step(dt, 150, callback=note)
if abs(fingers[0].position[0]) > 0.11:  # the axis points the other way round
    drive(-0.1)
    world.step(dt, 300, callback=note)
world.step(dt, 500, callback=note)
hand.set_velocity((0, 0, 0.1))
world.step(dt, 1000, callback=note)
hand.set_velocity((0, 0, 0))
world.step(dt, 500, callback=note)
print(f"the part hangs {heights[-1] * 100:.1f} cm above the table; its weight is {part.mass * 9.81:.2f} N")
assert heights[-1] > 0.15

# %%

plotter = pyvista.Plotter(off_screen=True, window_size=(900, 700))
otg.show(world, arrows=0.03, opacity=0.75, plotter=plotter, camera=[(0.35, -0.75, 0.45), (0, 0, 0.27), (0, 0, 1)])
figure, axes = plt.subplots(1, 2, figsize=(10, 4))
axes[0].imshow(plotter.screenshot())
axes[0].axis("off")
time = np.arange(len(heights)) * dt
axes[1].plot(time, np.array(heights) * 100, label="height of the part (cm)")
axes[1].plot(time, grip, label="grip (N)", alpha=0.7)
axes[1].set_xlabel("seconds")
axes[1].legend()
figure.tight_layout()
plt.show()
