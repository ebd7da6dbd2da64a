# SPDX-License-Identifier: BSD-3-Clause
"""The examples of the manual's page and of the docstrings do what they show."""

import doctest
import pathlib

import ode_trimesh_gpu as otg

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


def test_the_page():
    result = doctest.testfile(str(PAGE), module_relative=False, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert result.attempted > 25 and result.failed == 0


def test_the_package_docstring():
    result = doctest.testmod(otg)
    assert result.attempted > 3 and result.failed == 0
