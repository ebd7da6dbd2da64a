/* SPDX-License-Identifier: BSD-3-Clause */
/* How the functions of this library are declared: C linkage, and visible outside the shared library. */
#ifndef ODE_TRIMESH_GPU_EXPORT_H
#define ODE_TRIMESH_GPU_EXPORT_H

/* Everything that is not marked OTG_API is hidden in the shared library. Define OTG_STATIC when you link the static one
 * on Windows; elsewhere it makes no difference. */
#if defined(_WIN32) && !defined(OTG_STATIC)
#if defined(OTG_BUILDING_LIBRARY)
#define OTG_API __declspec(dllexport)
#else
#define OTG_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define OTG_API __attribute__((visibility("default")))
#else
#define OTG_API
#endif

#endif /* ODE_TRIMESH_GPU_EXPORT_H */
