/* SPDX-License-Identifier: BSD-3-Clause */
/* The version of these headers, and of the library that is loaded. CMakeLists.txt reads the numbers here. */
#ifndef ODE_TRIMESH_GPU_VERSION_H
#define ODE_TRIMESH_GPU_VERSION_H

#include "export.h"

/* Semantic versioning. Until 1.0.0 a new minor version may change the API, and has another SONAME. */
#define dGPUTRIMESH_VERSION_MAJOR 0
#define dGPUTRIMESH_VERSION_MINOR 1
#define dGPUTRIMESH_VERSION_PATCH 0

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief The version of the library that is loaded.
 * @returns For example "0.1.0"; the text lives as long as the library.
 * @remarks From any thread, also before dGpuTriMeshInit(). dGPUTRIMESH_VERSION_MAJOR, _MINOR and _PATCH are those of
 * the headers that the program was compiled with.
 * @ingroup gputrimesh
 */
OTG_API const char* dGpuTriMeshGetVersion(void);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_VERSION_H */
