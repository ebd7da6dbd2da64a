# SPDX-License-Identifier: BSD-3-Clause
"""What the package raises, beside MemoryError, OSError and TypeError."""

from . import _core


class Error(RuntimeError):
    """Something that the library cannot do; base of the package's errors."""


class MeshError(Error, ValueError):
    """A mesh, or a mesh file, that cannot be worked with."""


class PoseError(Error, ValueError):
    """A pose that is not finite, or whose rotation is none."""


class SceneError(Error, ValueError):
    """A scene that is wrong, or that ODE cannot step."""


class ArgumentError(Error, ValueError):
    """A value that a function does not take."""


class BusyError(Error):
    """An object that another thread, or the step that runs, is using."""


class OdeError(Error):
    """A point at which ODE would have ended the program."""


_core.start(Error, MeshError, PoseError, SceneError, ArgumentError, BusyError, OdeError)
