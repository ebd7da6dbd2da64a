# SPDX-License-Identifier: BSD-3-Clause
# One interface target with the flags that every target of this project is compiled with.
add_library(otg_flags INTERFACE)
target_compile_options(otg_flags INTERFACE
  # Contraction would let the compiler fuse a*b+c on one side (host, device, another host) and not on the other: the
  # error bounds of the filters and the equality of results between backends both depend on it being off.
  -ffp-contract=off
  -Wall -Wextra -Wpedantic -Wundef
  # g++ takes an enumerator of an enum class for something that shadows a global of the same name (it cannot).
  $<IF:$<COMPILE_LANG_AND_ID:CXX,GNU>,-Wshadow=local,-Wshadow>
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast>)
if(WIN32)
  target_compile_definitions(otg_flags INTERFACE _USE_MATH_DEFINES)  # M_PI
endif()
if(OTG_WARNINGS_AS_ERRORS)
  target_compile_options(otg_flags INTERFACE -Werror)
endif()
if(OTG_SANITIZE)
  target_compile_options(otg_flags INTERFACE -fsanitize=${OTG_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    # The instrumented code makes g++ see reads of uninitialised memory inside <regex>, which Catch2 uses.
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>)
  target_link_options(otg_flags INTERFACE -fsanitize=${OTG_SANITIZE})
endif()
