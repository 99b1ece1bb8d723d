"""Renders an exported scene with Mitsuba.

Usage: peer.py VARIANT THREADS SAMPLES SEED SCENE.xml OUT.npy

Writes to OUT.npy.json the seconds to load the scene, of the first picture (which compiles its kernel), and of a second
one, which is the one written.
"""

import json
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

variant, threads, samples, seed, scene, out = sys.argv[1:]
mi.set_variant(variant)
dr.set_thread_count(int(threads))

start = time.perf_counter()
scene = mi.load_file(scene)
loaded = time.perf_counter()


def picture(seed):
    return np.array(mi.render(scene, spp=int(samples), seed=seed))[:, :, :3]


picture(int(seed) + 1000)
first = time.perf_counter()
result = picture(int(seed))
second = time.perf_counter()
np.save(out, result)
# Not to standard output, where progress is drawn.
with open(out + ".json", "w") as file:
    json.dump({"load": loaded - start, "first": first - loaded, "second": second - first}, file)
