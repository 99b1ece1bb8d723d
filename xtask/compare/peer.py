"""Renders an exported scene with Mitsuba.

Usage: peer.py VARIANT THREADS SAMPLES SEED WIDTHxHEIGHT|scene SCENE.xml OUT.npy

Writes to OUT.npy.json, in seconds: to load the scene (`load`), to trace the picture once kernels are compiled (`warm`),
and what a process without that distinction would not have taken (`spare`); each of the processor too (`_cpu`).
"""

import json
import re
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

variant, threads, samples, seed, size, scene, out = sys.argv[1:]
mi.set_variant(variant)
dr.set_thread_count(int(threads))
told = {}


def timed(name, work):
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    told[name], told[name + "_cpu"] = time.perf_counter() - wall, time.process_time() - cpu
    return result


def picture(samples, seed):
    return np.array(mi.render(scene, spp=samples, seed=seed))[:, :, :3]


if size != "scene":
    text = open(scene).read()
    for name, value in zip(("width", "height"), size.split("x")):
        text, found = re.subn(rf'(<integer name="{name}" value=")\d+', rf"\g<1>{value}", text, count=1)
        assert found == 1, name
    scene = scene.removesuffix(".xml") + "-sized.xml"
    open(scene, "w").write(text)
scene = timed("load", lambda: mi.load_file(scene))

samples, seed = int(samples), int(seed)
if variant.startswith("scalar"):
    told["spare"] = told["spare_cpu"] = 0
else:
    # One kernel serves all numbers of samples that are powers of two, another all others.
    few = 2 if samples & (samples - 1) == 0 else 3
    picture(few, seed + 1000)
    timed("spare", lambda: picture(few, seed + 1000))
    told["spare"], told["spare_cpu"] = 2 * told["spare"], 2 * told["spare_cpu"]
result = timed("warm", lambda: picture(samples, seed))
np.save(out, result)
# Not to standard output, where progress is drawn.
with open(out + ".json", "w") as file:
    json.dump(told, file)
