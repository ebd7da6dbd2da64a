# SPDX-License-Identifier: BSD-3-Clause
# Debian's MinGW-w64 for 64-bit Windows, with POSIX threads; programs run under Wine. `scripts/ci.sh mingw` uses it.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")  # the compiler's libraries inside each program: Wine need not find them
# Wine's loader lies outside PATH in some versions of Debian.
find_program(OTG_WINE NAMES wine64 wine wine64-stable PATHS /usr/lib/wine NO_CMAKE_FIND_ROOT_PATH)
if(OTG_WINE)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${OTG_WINE}")
endif()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
