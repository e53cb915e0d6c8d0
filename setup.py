# SPDX-License-Identifier: Apache-2.0
"""Builds the compiled module with CMake: that target and what it needs, no program, tests or pages."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
OFF = ("BUILD_TESTS", "BUILD_BENCHMARKS", "WEB", "MPI")


def version() -> str:
    """That of the CMake project."""
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(palpate VERSION ([0-9.]+)", text).group(1)


class CMakeBuild(build_ext):
    def build_extension(self, ext: Extension) -> None:
        build = ROOT / "build" / "python"
        build.mkdir(parents=True, exist_ok=True)
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        launcher = ["-D", "CMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        configure = ["cmake", "-S", str(ROOT), "-B", str(build), *generator, *launcher, "-D", "CMAKE_BUILD_TYPE=Release",
                     "-D", "PALPATE_PYTHON=ON", "-D", f"Python_EXECUTABLE={sys.executable}"]
        os.environ.setdefault("CCACHE_SLOPPINESS", "pch_defines,time_macros")  # as CMakePresets.json
        wishes = shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run([*configure, *(f"-DPALPATE_{name}=OFF" for name in OFF), *wishes], check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run(["cmake", "--build", str(build), "--target", "palpate_python", "-j", jobs], check=True)
        target = Path(self.get_ext_fullpath(ext.name)).resolve()
        target.parent.mkdir(parents=True, exist_ok=True)
        (built,) = (build / "python" / "palpate").glob("_palpate.*.so")
        shutil.copyfile(built, target)


setup(version=version(), ext_modules=[Extension("palpate._palpate", sources=[])], cmdclass={"build_ext": CMakeBuild})
