#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# build_pyode.sh FOLDER: PyODE 1.2 with triangle meshes, which Debian's python3-pyode has switched off, as FOLDER/ode.so for
# Debian's interpreter. What is to use it runs with PYTHONPATH=FOLDER. Fetches PyODE's sources and Cython from PyPI; needs
# libode-dev, python3-dev and python3-venv.
set -euo pipefail
mkdir -p "${1:?usage: build_pyode.sh FOLDER}"
folder=$(cd "$1" && pwd)
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
cd "$scratch"
/usr/bin/python3 -m venv venv
venv/bin/pip --quiet install 'cython<3'
venv/bin/pip --quiet download --no-deps --no-binary :all: --no-build-isolation Py3ODE==1.2.0.dev15
tar xf Py3ODE-1.2.0.dev15.tar.gz
cd Py3ODE-1.2.0.dev15
printf 'include "trimeshdata.pyx"\ninclude "trimesh.pyx"\n' >_trimesh_switch.pyx
../venv/bin/cython -3 -o ode.c -I. -Isrc src/ode.pyx
include=$(/usr/bin/python3 -c 'import sysconfig; print(sysconfig.get_paths()["include"])')
# shellcheck disable=SC2046
cc -O2 -w -fPIC -shared -I"$include" $(pkg-config --cflags ode) ode.c -o "$folder/ode.so" $(pkg-config --libs ode)
