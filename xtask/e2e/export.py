"""Renders exported scenes with Mitsuba or reads what POV-Ray rendered, and compares with our own picture.

Usage: export.py mitsuba SCENE.xml OURS.pfm | export.py pov THEIRS.exr OURS.pfm

Both pictures hold linear radiance. The mean of each channel may differ by 0.8 %, and the root of the mean squared
error of blocks of 8×8 pixels, relative to the mean, by 3 %: what noise at the samples rendered leaves.
"""

import sys

import mitsuba as mi
import numpy as np

MEANS = 0.008
BLOCKS = 0.03
BLOCK = 8

mi.set_variant("scalar_rgb")


def read(path):
    bitmap = mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    return np.array(bitmap)


def blocks(picture):
    height, width, _ = picture.shape
    height, width = height // BLOCK * BLOCK, width // BLOCK * BLOCK
    cut = picture[:height, :width]
    return cut.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def main():
    how, theirs, ours = sys.argv[1:]
    if how == "mitsuba":
        theirs = np.array(mi.render(mi.load_file(theirs)))[:, :, :3]
    else:
        theirs = read(theirs)
    ours = read(ours)
    if ours.shape != theirs.shape:
        sys.exit(f"{ours.shape} against {theirs.shape}")
    ratio = theirs.mean(axis=(0, 1)) / ours.mean(axis=(0, 1))
    a, b = blocks(ours), blocks(theirs)
    error = np.sqrt(((a - b) ** 2).mean()) / a.mean()
    print(f"means {ratio.round(4).tolist()}, blocks {error:.4f}")
    if abs(ratio - 1).max() > MEANS or error > BLOCKS:
        sys.exit("the pictures differ")


main()
