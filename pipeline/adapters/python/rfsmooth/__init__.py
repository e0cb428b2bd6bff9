"""Takes the noise out of 3-D scans: every point, every field, in the same order.

    import rfsmooth
    clean, report = rfsmooth.denoise(points)        # n x 3, float32 or float64
    print(report["noise"], report["noise_left"])

Every option of the command `rfsmooth` is a keyword of the same name. Calls release the interpreter: other threads go on,
and Ctrl-C ends one within half a second and leaves the arrays as they were.
"""

from ._error import Error
from ._functions import (
    Mesh,
    compare,
    denoise,
    denoise_structured,
    info,
    mesh,
    normals,
    read,
    reconstruct,
    smooth_mesh,
    write,
)
from ._rfsmooth import Cloud
from ._rfsmooth import version as __version__

__all__ = [
    "Cloud",
    "Error",
    "Mesh",
    "compare",
    "denoise",
    "denoise_structured",
    "info",
    "mesh",
    "normals",
    "read",
    "reconstruct",
    "smooth_mesh",
    "write",
]
