"""The scene that every renderer shows, as it is given to cube3, and what is measured of two pictures.

The head as 256³ bytes, white, opacity of a unit length 0 up to 80 and 0.75 from 100 on; one white light at the eye, two-sided; parallel rays,
512×512 pixels of 0.75 voxel, from a·sin and −a·cos about z and 20° above the horizon.
"""

import math
import os
import struct
import subprocess
import zlib
from pathlib import Path

import nrrd
import numpy as np

SIDE = 256
PIXELS = 512
PIXEL_VOXEL = 0.75
TILT_DEG = 20
# Points [value, opacity of a unit length].
OPACITY = [[80, 0.0], [100, 0.75]]
AMBIENT, DIFFUSE, SPECULAR, SHININESS = 0.1, 0.7, 0.2, 10
HEAD = "vhf_head_256x256x234_i16.nrrd"
HEADER = {"space dimension": 3, "space directions": np.eye(3), "space origin": np.zeros(3), "encoding": "raw"}


class Missing(Exception):
    """Something is not installed; the text says how to get it."""


def find_head(given):
    """The file of the head: as given, or in what CUBE3_DATA names, a folder or the file itself. None where there is none."""
    place = given or os.environ.get("CUBE3_DATA")
    if not place:
        return None
    path = Path(place)
    path = path / HEAD if path.is_dir() else path
    if not path.is_file():
        raise SystemExit(f"{path}: no such file; name {HEAD} or the folder that has it")
    return path


def volume(head, cube3, folder):
    """256³ bytes, x first, with a border of zeros, and their file.

    A value of the head becomes min(255, v // 14); above its 234 planes there are zeros. The outermost voxels are set to 0: what a renderer takes
    to be beyond the volume, and how it ends a ray there, is then not in the picture.
    """
    if head:
        values, _ = nrrd.read(str(head))
    else:
        phantom = folder / "phantom.nrrd"
        run([cube3, "volume", "phantom", "head", "--size", str(SIDE), "--out", phantom])
        values, _ = nrrd.read(str(phantom))
    if values.dtype != np.uint8:
        values = np.clip(values // 14, 0, 255).astype(np.uint8)
    voxels = np.zeros((SIDE,) * 3, np.uint8)
    inner = tuple(slice(1, min(n, SIDE - 1)) for n in values.shape)
    voxels[inner] = values[inner]
    for axis, n in enumerate(values.shape):
        if n >= SIDE:
            np.moveaxis(voxels, axis, 0)[SIDE - 1] = 0
    path = folder / "volume.nrrd"
    nrrd.write(str(path), voxels, HEADER)
    return voxels, path


def frame(yaw_deg):
    """Unit vectors of a view: from the centre to the eye, to the picture's right, and up in it."""
    a, e = math.radians(yaw_deg), math.radians(TILT_DEG)
    eye = np.array([math.sin(a) * math.cos(e), -math.cos(a) * math.cos(e), math.sin(e)])
    right = np.array([math.cos(a), math.sin(a), 0.0])
    return eye, right, np.cross(eye, right)


def opacity(value):
    """Opacity of a unit length."""
    return np.interp(value, [point[0] for point in OPACITY], [point[1] for point in OPACITY])


def ours(cube3, volume_path, yaw_deg, shaded, step, folder):
    """cube3's picture: rows from the top, 0 to 255 in whole numbers, as its PNG file has them, which is linear."""
    scene = folder / "scene.toml"
    scene.write_text(
        f"""schema = 2
mode = "composite"
background = [0.0, 0.0, 0.0]

[view]
yaw_deg = {yaw_deg}
tilt_deg = {TILT_DEG}

[image]
width_px = {PIXELS}
height_px = {PIXELS}
pixel_size_voxel = {PIXEL_VOXEL}

[transfer]
opacity_correction = true
opacity = {OPACITY}
colour = [{{ value = 0.0, rgb = [1.0, 1.0, 1.0] }}]

[material]
shaded = {"true" if shaded else "false"}
ambient = {AMBIENT}
diffuse = {DIFFUSE}
specular = {SPECULAR}
shininess = {SHININESS}
two_sided = true
"""
    )
    out = folder / "cube3"
    run([cube3, "render", "--method", f"image-order:{step}", "--scene", scene, "--volume", volume_path, "--out", out])
    return red_of_png(out / "image.png")


def run(command):
    """Runs a program; what it says on stderr is said where it fails."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{command[0]} failed with {done.returncode}: {done.stderr.strip()[-600:]}")
    return done.stdout


def red_of_png(path):
    """The red channel of an 8-bit RGB file."""
    data, place, packed = path.read_bytes(), 8, b""
    while place < len(data):
        (length,), kind = struct.unpack(">I", data[place : place + 4]), data[place + 4 : place + 8]
        body = data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", body[:10])
            assert (bits, colour) == (8, 2), f"{path} is not 8-bit RGB"
        elif kind == b"IDAT":
            packed += body
        place += 12 + length
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    picture, above = np.zeros((height, width)), [0] * width
    for y, row in enumerate(rows):
        line, left, diagonal = [], 0, 0
        for red, up in zip(row[1::3].tolist(), above):
            nearest = min((left, up, diagonal), key=lambda near: abs(left + up - diagonal - near))
            left = (red + [0, left, up, (left + up) // 2, nearest][row[0]]) & 255
            diagonal = up
            line.append(left)
        picture[y], above = line, line
    return picture


def measure(a, b):
    """Root of the mean square, the largest and the mean of b − a, in 1/255."""
    difference = b - a
    return math.sqrt(np.mean(difference**2)), np.abs(difference).max(), difference.mean()
