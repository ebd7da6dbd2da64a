# SPDX-License-Identifier: BSD-3-Clause
"""The interpreter's lock, threads, Ctrl-C, progress, another ODE in the process, what is in the package."""

import importlib.metadata
import importlib.resources
import os
import subprocess
import sys
import sysconfig
import textwrap
import threading
import time

import numpy as np
import pytest
from conftest import pose, random_poses

import ode_trimesh_gpu as otg


def run_python(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, env={**os.environ, **environment}
    )


def share_of_longest_pause(call):
    """The longest time for which another thread could not run while `call` ran, as a part of the call's time."""
    stop, ready, longest = threading.Event(), threading.Event(), [0.0]

    def watch():
        last = time.perf_counter()
        ready.set()
        while not stop.is_set():
            time.sleep(0.001)
            now = time.perf_counter()
            longest[0] = max(longest[0], now - last)
            last = now

    thread = threading.Thread(target=watch)
    thread.start()
    ready.wait()
    start = time.perf_counter()
    call()
    taken = time.perf_counter() - start
    stop.set()
    thread.join()
    return longest[0] / taken


def test_long_calls_let_other_threads_run():
    """With the lock held for the whole of one compiled call the share would be 1 or more."""
    from ode_trimesh_gpu import _core

    lump = otg.generate.lump(0.5, 5, 0.3, 3)
    geoms = _core.Geoms([lump._core, lump._core], otg.Options()._params(history=False))
    geoms.place(np.stack([pose(0.1), np.eye(4)]))
    pairs = np.tile(np.array([[0, 1]], np.int32), (15, 1))
    large = otg.generate.sphere(0.5, 7)
    for call in (
        lambda: geoms.collide(pairs, 16),
        lambda: geoms.overlaps(np.tile(pairs, (500, 1))),
        lambda: _core.Mesh.build(large.vertices, large.faces.astype(np.uint32), False),
    ):
        assert min(share_of_longest_pause(call) for _ in range(3)) < 0.8


def test_threads_ask_at_once_and_get_the_same_bytes(ball):
    places = random_poses(200, 0.6, 13)
    expected = otg.collide_many(ball, ball, places).contacts.positions.tobytes()
    results = []

    def ask():
        results.append(otg.collide_many(ball, ball, places).contacts.positions.tobytes())

    threads = [threading.Thread(target=ask) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 6


def test_worlds_in_threads_have_the_bytes_of_one_after_the_other(box):
    def build():
        world = otg.World()
        world.add(otg.Plane())
        for i in range(4):
            world.add(box, pose(0.1 * i, 0, 0.5 + i))
        return world

    alone = build()
    alone.step(steps=150)
    worlds = [build() for _ in range(4)]
    threads = [threading.Thread(target=world.step, kwargs={"steps": 150}) for world in worlds]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {world.poses.tobytes() for world in worlds} == {alone.poses.tobytes()}


def test_one_world_is_used_by_one_thread_at_a_time(box):
    world = otg.World()
    errors = []

    def poke(contacts):
        world.add(box, pose(0, 0, 100))  # between collide and solve: the world is free
        return None

    world.add(otg.Plane())
    world.add(box, pose(0, 0, 0.5))
    world.contact_callback = poke
    world.step(steps=2)
    assert len(world.bodies) == 4 and not errors


@pytest.mark.parametrize(
    "work",
    [
        "otg.collide_many(lump, lump, np.tile(at, (1000000, 1, 1)))",
        "otg.distance(lump, lump, np.tile(at, (1000000, 1, 1)))",
        "otg.closest_points(lump, np.zeros((30000000, 3)))",
        "world.step(steps=100000000)",
        "otg.simulate(scene, steps=100000000)",
    ],
)
def test_ctrl_c_stops_long_calls(work):
    """A signal while a call runs that would take hours; the process lives on and works."""
    code = f"""
        import numpy as np, ode_trimesh_gpu as otg, os, signal, threading
        lump = otg.generate.lump(0.5, 3, 0.3, 3)
        at = np.eye(4)[None].copy(); at[:, 0, 3] = 0.3
        world = otg.World(); world.add(otg.Plane()); world.add(lump, (np.eye(3), [0, 0, 1]))
        scene = {{"planes": [{{}}], "bodies": [{{"name": "a", "sphere": 0.5}}]}}
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background processes ignore it
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            {work}
        except KeyboardInterrupt:
            print("stopped", len(otg.collide(lump, lump, at[0])))
        """
    result = run_python(code)
    assert result.stdout.startswith("stopped"), result.stderr


def test_progress_bars(ball, capfd):
    otg.collide_many(ball, ball, random_poses(50, 1, 14), progress=True)
    otg.World().step(steps=3, progress=True)
    text = capfd.readouterr().err
    assert "50/50" in text and "3/3" in text


def test_another_ode_in_the_process():
    """A copy of ODE that everybody sees: the package works, with the same contacts."""
    library = "/usr/lib/x86_64-linux-gnu/libode.so.8"
    if not os.path.exists(library):
        pytest.skip("ODE is not installed")
    code = """
        import numpy as np, ode_trimesh_gpu as otg
        world = otg.World(); world.add(otg.Plane()); world.add(otg.generate.box([1, 1, 1]), (np.eye(3), [0, 0, 0.7]))
        world.step(steps=100)
        print(world.poses.tobytes().hex(), len(world.contacts))
        """
    alone, beside = run_python(code), run_python(code, LD_PRELOAD=library)
    assert alone.returncode == 0 and alone.stdout and alone.stdout == beside.stdout, beside.stderr


def test_an_ode_of_single_precision_is_refused(tmp_path):
    """Everybody sees a library that says that it is ODE in single precision."""
    source = tmp_path / "single.c"
    source.write_text(
        "#include <string.h>\n"
        'int dCheckConfiguration(const char* token) { return strcmp(token, "ODE_single_precision") == 0; }\n'
        'const char* dGetConfiguration(void) { return "ODE ODE_single_precision"; }\n'
    )
    library = tmp_path / "single.so"
    compiler = (sysconfig.get_config_var("CC") or "cc").split()[0]
    try:
        subprocess.run([compiler, "-shared", "-fPIC", "-o", library, source], check=True)
    except FileNotFoundError:
        pytest.skip("no C compiler")
    result = run_python("import ode_trimesh_gpu", LD_PRELOAD=str(library))
    assert result.returncode != 0 and "dReal" in result.stderr and "Error" in result.stderr


def test_nothing_shows_but_the_module():
    from ode_trimesh_gpu import _core

    try:
        found = subprocess.run(
            ["nm", "-D", "--defined-only", _core.__file__], capture_output=True, text=True, check=True
        )
    except FileNotFoundError:
        pytest.skip("nm is not there")
    names = {line.split()[-1] for line in found.stdout.splitlines()}
    assert "PyInit__core" in names
    assert not [name for name in names if name.startswith(("dG", "dW", "dB", "dCreate", "dMass")) or "otg" in name]


def test_the_package_has_its_licences_and_types():
    if not (importlib.resources.files(otg) / "py.typed").is_file():
        pytest.fail("py.typed is missing")
    stub = (importlib.resources.files(otg) / "_core.pyi").read_text()
    assert "class Geoms" in stub and "NDArray" in stub
    try:
        files = importlib.metadata.files("ode_trimesh_gpu")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("not installed from a wheel")
    texts = {file.name: file.read_text() for file in files if "licenses" in file.parts}
    assert "Russell L. Smith" in texts["libode-dev.txt"] and "Daniel Fiser" in texts["libccd2.txt"]
    assert "Mozilla Public License" in texts["libeigen3-dev.txt"] + texts["MPL-2.0.txt"]
    assert {"LICENSE", "nanobind.txt", "libfmt-dev.txt", "libtinygltf-dev.txt", "libstb0.txt"} <= set(texts)


def test_the_version_is_that_of_the_package():
    try:
        version = importlib.metadata.version("ode_trimesh_gpu")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("not installed from a wheel")
    assert otg.__version__ == version


def test_everything_public_is_documented():
    for name in otg.__all__:
        thing = getattr(otg, name)
        assert isinstance(thing, tuple) or thing.__doc__, name
        if isinstance(thing, type) and thing.__module__.startswith("ode_trimesh_gpu."):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert value.__doc__, f"{name}.{member}"


def test_pictures(tmp_path, box):
    pytest.importorskip("pyvista")
    world = otg.World()
    world.add(otg.Plane())
    world.add(box, pose(0, 0, 0.5))
    world.step(steps=10)
    run = otg.simulate({"planes": [{}], "bodies": [{"name": "a", "sphere": 0.5}], "steps": 2})
    meshes = [box, (box, pose(0, 0, 0.95))]
    world.show(screenshot=tmp_path / "world.png")
    run.show(screenshot=tmp_path / "run.png")
    box.show(screenshot=tmp_path / "mesh.png")
    otg.show(meshes, otg.collide(box, box, None, pose(0, 0, 0.95)), screenshot=tmp_path / "pair.png")
    for name in ("world", "run", "mesh", "pair"):
        assert (tmp_path / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(otg.ArgumentError):
        otg.show([3], screenshot=tmp_path / "none.png")


def test_sigint_handler_is_left_alone():
    # A process of its own: one that a shell starts in the background ignores the signal.
    program = """
import signal
def handler(*_): pass
signal.signal(signal.SIGINT, handler)
import ode_trimesh_gpu as otg
world = otg.World()
world.add(otg.Plane())
world.step(steps=10)
assert signal.getsignal(signal.SIGINT) is handler
"""
    subprocess.run([sys.executable, "-c", program], check=True)
