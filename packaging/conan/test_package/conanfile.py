# SPDX-License-Identifier: BSD-3-Clause
"""What `conan create` does with the new package: builds the README's lines in C, shared and static, and runs them."""
import os
from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout


class Test(ConanFile):
    settings = "os", "arch", "compiler", "build_type"

    def requirements(self):
        self.requires(self.tested_reference_str)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        root = Path(self.recipe_folder).parents[2]
        snippet = (root / "README.md").read_text().split("```c\n")[1].split("```")[0]
        Path(self.generators_folder, "readme_snippet.h").write_text(snippet)
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False  # nothing of a build among the sources
        toolchain.cache_variables["SNIPPET_DIR"] = self.generators_folder
        toolchain.cache_variables["PROGRAM"] = str(root / "tests/robustness/installed_package/main.c")
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def test(self):
        if can_run(self):
            for program in ("shared", "static"):
                self.run(os.path.join(self.cpp.build.bindir, program), env="conanrun")
