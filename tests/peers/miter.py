"""teem-miter, made to show what cube3 shows.

- Kernels: `tent` is trilinear interpolation, and `cendif` its central difference over one voxel to either side.
- Steps: `-step`, and `-ref` 1, the length that opacities are given for. Both are 0.01 without.
- The transfer function is a table without interpolation: it has 65536 entries here.
- A ray ends at an opacity of 0.99 without `-n1`.
- The result's colour is divided by its opacity.
"""

import shutil

import nrrd
import numpy as np

import scene

NAME = "teem-miter"
SHADED = (True,)
HINT = "teem-miter is not installed: apt-get install teem-apps"
ENTRIES = 65536
DISTANCE = 400.0


def version():
    """What is installed; the program has no option that says it."""
    if shutil.which("teem-miter") is None:
        raise scene.Missing(HINT)
    unu = shutil.which("teem-unu") or shutil.which("unu")
    lines = scene.run([unu, "about"]).splitlines() if unu else []
    return next((line.strip().split(",")[0] for line in lines if "version" in line), "an unknown version")


def pictures(ours, voxels, path, yaw_deg, shaded, step, threads, folder):
    """Our picture and its, with a name: rows from the top, 0 to 255; its is not rounded."""
    values = np.linspace(0, 255, ENTRIES)
    table = folder / "opacity.nrrd"
    header = f"""NRRD0004
type: float
dimension: 2
sizes: 1 {ENTRIES}
axis mins: NaN 0
axis maxs: NaN 255
labels: "A" "gage(scalar:v)"
endian: little
encoding: raw

"""
    table.write_bytes(header.encode() + scene.opacity(values).astype("<f4").tobytes())
    centre = (np.array(voxels.shape) - 1) / 2
    eye, _, _ = scene.frame(yaw_deg)
    half = scene.PIXELS * scene.PIXEL_VOXEL / 2
    out = folder / "miter.nrrd"
    scene.run(
        ["teem-miter", "-i", path, "-txf", table, "-o", out]
        + ["-fr", *(centre + DISTANCE * eye), "-at", *centre, "-up", 0, 0, 1, "-rh", "-or", "-ar", "-dn", -250, "-di", 0, "-df", 250]
        + ["-ur", -half, half, "-vr", -half, half, "-is", scene.PIXELS, scene.PIXELS]
        + ["-ads", scene.AMBIENT, scene.DIFFUSE, scene.SPECULAR, "-sp", scene.SHININESS, "-side", 0]
        + ["-k00", "tent", "-k11", "cendif", "-step", step, "-ref", 1, "-n1", 0.9999999, "-nt", threads]
    )
    channels, _ = nrrd.read(str(out))
    return [("picture", ours, (channels[0] * channels[3]).T * 255)]
