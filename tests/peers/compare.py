#!/usr/bin/env python3
"""cube3's `image-order` beside renderers that others wrote, on one scene.

    cargo build --release --bin cube3
    python3 tests/peers/compare.py --volume FOLDER        # or CUBE3_DATA=FOLDER; without either the head is a phantom

Prints, of each peer and view, the root of the mean square, the largest and the mean difference (peer − cube3) in 1/255, and ends with 1 where the
first of them is above 5, or what --limit says. The README beside this file says what is needed. A peer that is not there is left out, and a line says how to get it;
with CUBE3_REQUIRE_TOOLS set that is an error.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

import miter
import scene
import vtk_fixed_point

PEERS = {"miter": miter, "vtk": vtk_fixed_point}


def arguments():
    root = Path(__file__).resolve().parents[2]
    built = Path(os.environ.get("CARGO_TARGET_DIR", root / "target")) / "release" / "cube3"
    parser = argparse.ArgumentParser(description="cube3's image-order beside miter and VTK")
    parser.add_argument("--volume", help=f"{scene.HEAD}, or the folder that has it; CUBE3_DATA without it")
    parser.add_argument("--cube3", default=built, type=Path, help="the program; target/release/cube3 without it")
    parser.add_argument("--peer", choices=PEERS, action="append", help="one of the peers; all of them without it")
    parser.add_argument("--views", default="0,30,45,90", help="angles a in degrees, with commas between")
    parser.add_argument("--step", default=0.125, type=float, help="of every renderer, in voxels")
    parser.add_argument("--limit", default=5.0, type=float, help="of the root of the mean square, in 1/255")
    parser.add_argument("--threads", default=os.cpu_count(), type=int, help="of miter; VTK has one")
    return parser.parse_args()


def compare(peer, shaded, views, given, voxels, path, folder):
    """The rows of a peer, shaded or not; whether each is within the limit."""
    within = True
    for yaw_deg in views:
        ours = scene.ours(given.cube3, path, yaw_deg, shaded, given.step, folder)
        pairs = peer.pictures(ours, voxels, path, yaw_deg, shaded, given.step, given.threads, folder)
        for index, (what, here, there) in enumerate(pairs):
            rms, largest, mean = scene.measure(here, there)
            print(f"| {peer.NAME} | {what} | {yaw_deg:g}° | {rms:.3f} | {largest:.1f} | {mean:+.3f} |", flush=True)
            # The first is what the renderer computes; the others say where the rest comes from.
            within &= index > 0 or rms <= given.limit
    return within


def main():
    given = arguments()
    if not given.cube3.is_file():
        sys.exit(f"{given.cube3}: no such program; cargo build --release --bin cube3, or name it with --cube3")
    head = scene.find_head(given.volume)
    if head is None:
        print("no --volume and no CUBE3_DATA: the built-in phantom in place of the head")
    views = [float(angle) for angle in given.views.split(",")]
    within, missing = True, False
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        voxels, path = scene.volume(head, given.cube3, folder)
        print(f"{path.name}: {100 * (voxels > scene.OPACITY[0][0]).mean():.2f} % of the voxels are not transparent; step {given.step:g}")
        for peer in [PEERS[name] for name in given.peer or PEERS]:
            try:
                version = peer.version()
            except scene.Missing as why:
                print(f"\nleft out: {why}")
                missing = True
                continue
            for shaded in peer.SHADED:
                print(f"\n{peer.NAME}: {version}, {'shaded' if shaded else 'unshaded'}\n")
                print("| peer | what | a | RMS, 1/255 | largest | mean |\n| --- | --- | --- | --- | --- | --- |")
                within &= compare(peer, shaded, views, given, voxels, path, folder)
    if not within:
        sys.exit(f"more than {given.limit:g}/255 apart")
    if missing and os.environ.get("CUBE3_REQUIRE_TOOLS"):
        sys.exit("CUBE3_REQUIRE_TOOLS is set, and a peer is missing")


if __name__ == "__main__":
    main()
