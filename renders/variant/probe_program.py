"""The smallest render that tells a variant which works from one that only loads.

A program of its own, ``python probe_program.py llvm_ad_rgb``, because a libLLVM too old for the
processor aborts the whole process at its first real kernel (LLVM 14, 15 and 16 on AVX-512:
``Cannot select ... fminimum``). It imports nothing of the house, so that set-up can run it too.

The scene is a furnace: in an environment of radiance 1 everywhere, surfaces that absorb a little
are a little darker than 1, and every variant must find the same mean. It holds what the house
renders with: a rough conductor, whose kernel is the one that bad libraries die of, a triangle
mesh, and a path integrator with several bounces. Prints one line of JSON; exits 0 if the mean
is right.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

SIDE_PX = 64
SAMPLES = 64
FURNACE_MEAN = 0.9626  # of 2048 samples in scalar_rgb and 8192 in llvm_ad_rgb alike
FIFTEEN_SIGMA = 0.005  # the mean of 64 samples scatters by 0.0003


def furnace(mi: Any) -> Any:
    """Return the scene: a rough conductor ball before a white cube, in a bright room."""
    at = mi.ScalarTransform4f()
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 6},
            "room": {"type": "constant"},
            "ball": {
                "type": "sphere",
                "radius": 0.8,
                "bsdf": {"type": "roughconductor", "alpha": 0.2, "distribution": "ggx"},
            },
            "cube": {
                "type": "cube",
                "to_world": at.translate([0.9, 0.5, -1.5]).rotate([0, 1, 0], 30),
                "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.9}},
            },
            "camera": {
                "type": "perspective",
                "fov": 45,
                "to_world": at.look_at(origin=[0, 0, 4], target=[0, 0, 0], up=[0, 1, 0]),
                "film": {
                    "type": "hdrfilm",
                    "width": SIDE_PX,
                    "height": SIDE_PX,
                    "component_format": "float32",
                    "rfilter": {"type": "box"},
                },
            },
        }
    )


def loaded_library(name: str) -> str:
    """Return the file from which a library whose name starts with ``name`` was loaded, or ""."""
    try:
        with open("/proc/self/maps") as maps:
            files = [line.split()[-1] for line in maps]
    except OSError:  # no procfs: macOS, Windows
        return ""
    return next((file for file in files if file.rpartition("/")[2].startswith(name)), "")


def leave_no_core_dump() -> None:
    """Let a bad library abort without writing gigabytes."""
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def main(variant: str) -> int:
    """Render the furnace twice, cold and warm, and print what came."""
    leave_no_core_dump()
    started = time.perf_counter()
    import mitsuba as mi
    import numpy as np

    mi.set_variant(variant)
    scene = furnace(mi)
    mean = float(np.array(mi.render(scene, spp=SAMPLES, seed=0)).mean())
    cold_s = time.perf_counter() - started

    started = time.perf_counter()
    np.array(mi.render(scene, spp=SAMPLES, seed=1))
    warm_s = time.perf_counter() - started

    library = {"llvm": "libLLVM", "cuda": "libcuda"}.get(variant.partition("_")[0])
    print(
        json.dumps(
            {
                "furnace": mean,
                "first_image_s": cold_s,
                "samples_per_s": SIDE_PX**2 * SAMPLES / warm_s,
                "library": loaded_library(library) if library else "",
            }
        )
    )
    if abs(mean - FURNACE_MEAN) < FIFTEEN_SIGMA:
        return 0
    print(f"expected a mean radiance of {FURNACE_MEAN}, got {mean}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
