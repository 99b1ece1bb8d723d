"""Cryptomatte by a reader that is not ours: the names are there, the mattes cover what the picture shows, and the other
channels are found by their names.

Usage: mattes.py RTC ROOT, in an empty folder, by a Python with cryptomatte-api and OpenEXR.
"""

import subprocess
import sys

import cryptomatte_api
import numpy as np
import OpenEXR

SCENE = """\
camera { from: (0, 0, 6)m, look: (0, 0, 0)m, width: 4m }
group pair {
  for i in range(2) {
    sphere ball { at: ((2 * i - 1) * 1m, 0, 0), radius: 80cm, material: if i == 0 then clay else glass }
  }
}
material clay = diffuse { color: #d94f30 }
material glass = dielectric {}
sky {}
render { size: (200, 150), samples: 64, filter: box }
"""

rtc = sys.argv[1]
with open("pair.rt", "w", encoding="utf-8") as file:
    file.write(SCENE)
channels = "depth,normal,albedo,samples,error,object,material"
subprocess.run([rtc, "build", "-q", "pair.rt", "-o", "pair.exr", "--aov", channels], check=True)

mattes = {}
for matte in cryptomatte_api.Cryptomatte.load("pair.exr"):
    mattes.update(matte.masks())
names = {"pair.for:3:3[i = 0].ball", "pair.for:3:3[i = 1].ball", "clay", "glass"}
assert set(mattes) == names, sorted(mattes)

# A ball of radius 0.8 m seen through parallel rays covers so much of the 4 m × 3 m that 200 × 150 pixels show.
disc = np.pi * 0.8**2 / (4 * 3) * 200 * 150
for name, mask in mattes.items():
    assert mask.shape == (150, 200), (name, mask.shape)
    assert 0 <= mask.min() and mask.max() <= 1 + 1e-6, name
    assert abs(mask.sum() / disc - 1) < 1e-3, (name, mask.sum(), disc)
assert np.array_equal(mattes["clay"], mattes["pair.for:3:3[i = 0].ball"])

with OpenEXR.File("pair.exr") as file:
    held = file.channels()
    wanted = {"RGB", "albedo", "depth.Z", "error.X", "normal.X", "normal.Y", "normal.Z", "samples.X"}
    assert wanted <= set(held), sorted(held)
    depth = held["depth.Z"].pixels
assert abs(depth[75, 50] - 5.2) < 1e-3 and np.isinf(depth[0, 0]), (depth[75, 50], depth[0, 0])
print(f"{len(mattes)} mattes, each within a thousandth of the disc that it covers")
