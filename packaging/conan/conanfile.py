# SPDX-License-Identifier: BSD-3-Clause
"""Recipe for Conan 2: `conan create packaging/conan`.

ODE, Eigen and OpenCL's headers come from the system's packages, as ODE has no package of Conan. The package has the
shared library and the archive, and its own CMake package: `find_package(ode_trimesh_gpu)` gives the targets of every
other installation.
"""
import re
from pathlib import Path

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy
from conan.tools.system.package_manager import Apt


class OdeTrimeshGpu(ConanFile):
    name = "ode_trimesh_gpu"
    description = "Triangle-mesh collision for the Open Dynamics Engine"
    license = "BSD-3-Clause"
    topics = ("physics", "collision-detection", "opencl")
    settings = "os", "arch", "compiler", "build_type"

    def _root(self):
        return Path(self.recipe_folder).parents[1]

    def set_version(self):
        header = (self._root() / "ode_trimesh_gpu/include/ode_trimesh_gpu/version.h").read_text()
        self.version = ".".join(re.search(rf"VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "PATCH"))

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "cmake/*", "kernels/*", "ode_trimesh_gpu/*", "packaging/*", "LICENSE", "*.md",
                        "docs/*.md", "examples/*"):
            copy(self, pattern, self._root(), self.export_sources_folder, excludes=("build*", "out"))

    def validate(self):
        check_min_cppstd(self, 20)

    def system_requirements(self):
        Apt(self).install(["libode-dev", "libeigen3-dev", "opencl-c-headers", "pkg-config"], check=True)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False  # nothing of a build among the sources
        for what in ("TESTS", "DEMOS", "BENCHMARKS"):
            toolchain.cache_variables[f"OTG_BUILD_{what}"] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, Path(self.package_folder) / "licenses")

    def package_info(self):
        self.cpp_info.set_property("cmake_find_mode", "none")  # the package's own files are the ones to find
        self.cpp_info.builddirs = ["lib/cmake/ode_trimesh_gpu"]
        self.cpp_info.libs = ["ode_trimesh_gpu"]
        self.cpp_info.system_libs = ["ode"]
