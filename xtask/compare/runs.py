"""Runs renderers: what each took, and its picture."""

import hashlib
import json
import os
import subprocess
import sys

import numpy as np

from scenes import HERE, ROOT

THREADS = 2

# Starts a process and tells of it alone: its exit code, its output, wall seconds, processor seconds of all its threads
# together, and its most memory in MB.
TELLER = """
import json,resource,subprocess,sys,time
s=time.perf_counter()
p=subprocess.run(sys.argv[1:],capture_output=True,text=True)
w=time.perf_counter()-s
r=resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps([p.returncode,p.stdout+p.stderr,w,r.ru_utime+r.ru_stime,r.ru_maxrss/1024]))
"""


def run(command):
    """Runs a process to its end: wall seconds, processor seconds, MB."""
    command = list(map(str, command))
    told = subprocess.run([sys.executable, "-c", TELLER, *command], capture_output=True, text=True, check=True)
    code, out, wall, cpu, mb = json.loads(told.stdout)
    if code:
        sys.exit(f"{' '.join(command)}\nended with {code}:\n{out}")
    return {"wall": wall, "cpu": cpu, "mb": mb}


def pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) < 0
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1].astype(np.float64)


def errors(picture, reference):
    """The relMSE of a picture, and the median of its pixels'."""
    squares = ((picture - reference) ** 2 / (reference**2 + 0.01)).mean(axis=2)
    return float(squares.mean()), float(np.median(squares))


class Desk:
    """Where pictures and scenes for others are written, and the program under test."""

    def __init__(self, rtc, python, folder):
        self.rtc, self.python, self.folder = rtc, python, folder

    def path(self, scene, ending):
        return os.path.join(self.folder, f"{scene.name}.{ending}")

    def source(self, scene):
        """The scene's file, or a copy with another filter."""
        if not scene.box:
            return scene.path
        copy = self.path(scene, "rt")
        with open(scene.path) as file, open(copy, "w") as out:
            text = file.read()
            assert text.count("render {") == 1
            out.write(text.replace("render {", "render { filter: box,"))
        return copy

    def ours(self, scene, samples, seed, flags=(), size=None, threads=THREADS):
        out = self.path(scene, "pfm")
        sets = [flag for value in scene.sets for flag in ("--set", value)]
        size = size or scene.size
        sizes = ["--size", size] if size else []
        command = [self.rtc, "build", "--quiet", self.source(scene), *sizes, *sets, *flags]
        took = run([*command, "-j", threads, "--samples", samples, "--seed", seed, "-o", out])
        return {**took, "picture": pfm(out)}

    def exported(self, scene, ending, sets=(), flags=()):
        """The scene for another renderer."""
        out = self.path(scene, ending)
        values = [flag for value in [*scene.sets, *sets] for flag in ("--set", value)]
        run([self.rtc, "export", self.source(scene), *values, *flags, "-o", out])
        return out

    def mitsuba(self, scene, variant, export, samples, seed, size=None):
        """With `warm`, a picture by a process that has compiled its kernels; `wall` is that of one that has not."""
        out = self.path(scene, "npy")
        script = os.path.join(HERE, "peer.py")
        size = size or scene.size or "scene"
        took = run([self.python, script, variant, THREADS, samples, seed, size, export, out])
        with open(out + ".json") as file:
            times = json.load(file)
        took["wall"] -= times["spare"]
        took["cpu"] -= times["spare_cpu"]
        return {**took, **times, "picture": np.load(out)}

    def povray(self, scene, export, samples, size=None):
        side = round(samples**0.5)
        width, height = (size or scene.size or "640x480").split("x")
        # A grid of side × side rays in every pixel, without a test whether they are wanted.
        command = ["povray", f"+W{width}", f"+H{height}", "+A0.0", "+AM1", f"+R{side}", "-D", "-GA", "+FE"]
        return run([*command, f"+WT{THREADS}", f"+I{export}", f"+O{self.path(scene, 'pov.exr')}"])

    def reference(self, scene):
        """A picture with many samples of a seed of its own, kept for as long as nothing that decides it changes."""
        key = hashlib.sha256(repr((scene.size, scene.sets, scene.reference, scene.box)).encode())
        folders = [os.path.join(ROOT, "src", name) for name in ("render", "scene", "lower")]
        sources = [os.path.join(at, name) for top in folders for at, _, names in os.walk(top) for name in names]
        for path in [scene.path, *sorted(source for source in sources if "/tests/" not in source)]:
            with open(path, "rb") as file:
                key.update(file.read())
        kept = self.path(scene, f"reference-{key.hexdigest()[:16]}.npy")
        if not os.path.exists(kept):
            np.save(kept, self.ours(scene, scene.reference, 1001)["picture"].astype(np.float32))
        return np.load(kept).astype(np.float64)
