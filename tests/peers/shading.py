#!/usr/bin/env python3
"""Why VTK's shaded picture is not cube3's: a third caster, in numpy, that lights a sample either way, beside both.

    python3 tests/peers/shading.py --volume FOLDER        # options as of compare.py

- at the sample: the light of the interpolated gradient, as cube3 and miter have it;
- at voxels: the light of each voxel's own gradient, interpolated as a colour, as VTK has it.

One view, every fourth pixel of each way; a minute.
"""

import tempfile
from pathlib import Path

import numpy as np

import compare
import scene
import vtk_fixed_point

EVERY = 4
YAW_DEG = 30
# VTK's rays end there.
LEFT = 1 / 128


def gradients(values):
    """Central differences at voxels; 0 at the border, where this volume is empty."""
    field = np.zeros(values.shape + (3,), np.float32)
    for axis in range(3):
        along, out = np.moveaxis(values, axis, 0), np.moveaxis(field[..., axis], axis, 0)
        out[1:-1] = (along[2:] - along[:-2]) / 2
    return field


def lit(gradient, towards_light):
    """Light of white, two-sided, from the eye; the ambient part alone where the gradient vanishes."""
    length = np.linalg.norm(gradient, axis=-1)
    cosine = np.abs(gradient @ towards_light) / np.where(length > 0, length, 1)
    light = scene.AMBIENT + scene.DIFFUSE * cosine + scene.SPECULAR * cosine**scene.SHININESS
    return np.where(length > 0, light, scene.AMBIENT)


def cast(voxels, step):
    """The pictures, lit at the sample and at voxels."""
    values = voxels.astype(np.float32)
    eye, right, up = scene.frame(YAW_DEG)
    field = gradients(values)
    at_voxels = lit(field, eye.astype(np.float32))
    places = np.arange(0, scene.PIXELS, EVERY) - (scene.PIXELS - 1) / 2
    across, down = np.meshgrid(places * scene.PIXEL_VOXEL, places * scene.PIXEL_VOXEL)
    middle = (np.array(voxels.shape) - 1) / 2
    starts = (middle + across[..., None] * right - down[..., None] * up).reshape(-1, 3)
    left, by_sample, by_voxel = np.ones(len(starts)), np.zeros(len(starts)), np.zeros(len(starts))
    reach = np.linalg.norm(middle)
    for depth in np.arange(-reach, reach, step):
        rays = np.flatnonzero(left > LEFT)
        at = starts[rays] - depth * eye
        inside = ((at >= 0) & (at < np.array(voxels.shape) - 1)).all(axis=1)
        rays, at = rays[inside], at[inside]
        corner = at.astype(int)
        part = (at - corner).astype(np.float32)
        corners = [np.array(index) for index in np.ndindex(2, 2, 2)]
        weights = [np.prod(np.abs(1 - by - part), axis=1) for by in corners]

        def between(of, chosen):
            def share(by, weight):
                here = of[tuple((corner[chosen] + by).T)]
                return (here.T * weight[chosen]).T

            return sum(share(by, weight) for by, weight in zip(corners, weights))

        value = between(values, slice(None))
        seen = value > scene.OPACITY[0][0]
        if not seen.any():
            continue
        rays, alpha = rays[seen], 1 - (1 - scene.opacity(value[seen])) ** step
        by_sample[rays] += left[rays] * alpha * lit(between(field, seen), eye.astype(np.float32))
        by_voxel[rays] += left[rays] * alpha * between(at_voxels, seen)
        left[rays] *= 1 - alpha
    return [picture.reshape(across.shape) * 255 for picture in (by_sample, by_voxel)]


def main():
    given = compare.arguments()
    vtk_fixed_point.version()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        voxels, path = scene.volume(scene.find_head(given.volume), given.cube3, folder)
        ours = scene.ours(given.cube3, path, YAW_DEG, True, given.step, folder)
        (_, _, theirs), *_ = vtk_fixed_point.pictures(ours, voxels, path, YAW_DEG, True, given.step, 1, folder)
    by_sample, by_voxel = cast(voxels, given.step)
    ours, theirs = ours[::EVERY, ::EVERY], theirs[::EVERY, ::EVERY]
    print("| pictures | RMS, 1/255 | largest | mean |\n| --- | --- | --- | --- |")
    for what, a, b in [
        ("cube3, VTK", ours, theirs),
        ("cube3, lit at the sample", ours, by_sample),
        ("lit at the sample, VTK", by_sample, theirs),
        ("lit at voxels, VTK", by_voxel, theirs),
    ]:
        rms, largest, mean = scene.measure(a, b)
        print(f"| {what} | {rms:.3f} | {largest:.1f} | {mean:+.3f} |")


if __name__ == "__main__":
    main()
