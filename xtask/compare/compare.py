"""Renders the same scenes with `rtc` and with other renderers, in turns, and prints what each took.

Usage: compare.py RTC PYTHON ROOT DESK ROUNDS [SCENE…]

PYTHON is one that has Mitsuba and NumPy, DESK a folder to write in. All rows of a table come from one run; a ratio is
the median over the rounds of the pairs' ratios, with the least and the greatest behind it.

Wall time is that of the whole process, from its start to the written picture, text read and picture encoded. For
Mitsuba, whose start compiles a kernel, the second picture of a process is timed too ("warm"): only tracing.
The error is that of the picture against one with many samples of another seed: relMSE is the mean of
(x − r)² / (r² + 0.01), "median" the median of the pixels of the same.
"""

import json
import os
import re
import statistics
import subprocess
import sys
import time

import numpy as np

RTC, PYTHON, ROOT, DESK, ROUNDS = sys.argv[1:6]
WANTED = sys.argv[6:]
ROUNDS = int(ROUNDS)
HERE = os.path.dirname(os.path.abspath(__file__))
THREADS = 2


class Scene:
    """A scene, how it is rendered, and with whom it is compared."""

    def __init__(self, name, path, samples, flags=(), sets=(), peers=(), reference=4096, export=()):
        self.name, self.path, self.samples = name, path, samples
        self.flags, self.sets, self.peers = list(flags), list(sets), list(peers)
        self.reference, self.export = reference, list(export)


def example(name):
    return os.path.join(ROOT, "examples", name)


def own(name):
    return os.path.join(HERE, name)


SIZE = ["--size", "640x480"]
SCENES = [
    Scene(
        "room",
        os.path.join(ROOT, "tests/references/room.rt"),
        64,
        flags=SIZE,
        peers=["llvm_ad_rgb", "scalar_rgb"],
        reference=8192,
    ),
    *(
        Scene(
            f"balls-{count}",
            own("balls.rt"),
            16,
            sets=[f"count={count}"],
            peers=["povray", "llvm_ad_rgb"] if count <= 1000 else ["povray"],
            reference=256,
            export=["--approximate"],
        )
        for count in (1000, 100_000, 1_000_000)
    ),
    Scene(
        "hyperboloids",
        own("hyperboloids.rt"),
        16,
        peers=["povray", "llvm_ad_rgb"],
        reference=1024,
        export=["--approximate", "--tessellate", "64"],
    ),
    Scene(
        "sphereflake",
        example("sphereflake.rt"),
        16,
        flags=SIZE,
        peers=["llvm_ad_rgb"],
        reference=512,
        export=["--approximate"],
    ),
    Scene(
        "one-weekend",
        example("one-weekend.rt"),
        10,
        flags=["--size", "400x225"],
        peers=["llvm_ad_rgb"],
        reference=1024,
        export=["--approximate"],
    ),
    Scene("lights", own("lights.rt"), 16, peers=["llvm_ad_rgb"], reference=1024, export=["--approximate"]),
]


def run(command):
    """Runs a process to its end: its output, its seconds and its most memory in MB.

    A small process between tells the memory of this child alone.
    """
    teller = (
        "import json,resource,subprocess,sys,time\n"
        "s=time.perf_counter()\n"
        "p=subprocess.run(sys.argv[1:],capture_output=True,text=True)\n"
        "w=time.perf_counter()-s\n"
        "m=resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss/1024\n"
        "print(json.dumps([p.returncode,p.stdout,p.stderr,w,m]))\n"
    )
    command = list(map(str, command))
    told = subprocess.run([sys.executable, "-c", teller, *command], capture_output=True, text=True, check=True)
    code, out, err, wall, mb = json.loads(told.stdout)
    if code:
        sys.exit(f"{' '.join(command)}\nended with {code}:\n{out}{err}")
    return out, wall, mb


def pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) < 0
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1].astype(np.float64)


def errors(picture, reference):
    squares = ((picture - reference) ** 2 / (reference**2 + 0.01)).mean(axis=2)
    return float(squares.mean()), float(np.median(squares))


def path(scene, ending):
    return os.path.join(DESK, f"{scene.name}.{ending}")


def ours(scene, samples, seed, flags=()):
    out = path(scene, "pfm")
    sets = [flag for value in scene.sets for flag in ("--set", value)]
    command = [RTC, "build", "--quiet", scene.path, *scene.flags, *sets, *flags]
    command += ["-j", THREADS, "--samples", samples, "--seed", seed, "-o", out]
    _, wall, mb = run(command)
    return {"wall": wall, "mb": mb, "picture": pfm(out)}


def exported(scene, ending, sets=(), flags=()):
    """The scene for another renderer."""
    out = path(scene, ending)
    values = [flag for value in [*scene.sets, *sets] for flag in ("--set", value)]
    run([RTC, "export", scene.path, *values, *flags, "-o", out])
    if ending == "xml" and "--size" in scene.flags:
        width, height = scene.flags[scene.flags.index("--size") + 1].split("x")
        text = open(out).read()
        for name, value in (("width", width), ("height", height)):
            text, found = re.subn(
                rf'(<integer name="{name}" value=")\d+', rf"\g<1>{value}", text, count=1
            )
            assert found == 1, name
        open(out, "w").write(text)
    return out


def mitsuba(scene, variant, export, samples, seed):
    out = path(scene, "npy")
    script = os.path.join(HERE, "peer.py")
    _, wall, mb = run([PYTHON, script, variant, THREADS, samples, seed, export, out])
    with open(out + ".json") as file:
        times = json.load(file)
    return {"wall": wall - times["second"], "warm": times["second"], "mb": mb, "picture": np.load(out)}


def povray(scene, export, samples):
    side = round(samples**0.5)
    size = [] if "--size" not in scene.flags else scene.flags[1].split("x")
    width, height = size or (640, 480)
    # A grid of side × side rays in every pixel, without a test whether they are wanted.
    command = ["povray", f"+W{width}", f"+H{height}", "+A0.0", "+AM1", f"+R{side}", "-D", "-GA", "+FE"]
    command += [f"+WT{THREADS}", f"+I{export}", f"+O{path(scene, 'pov.exr')}"]
    _, wall, mb = run(command)
    return {"wall": wall, "mb": mb}


def spread(values):
    return f"{statistics.median(values):.3g} ({min(values):.3g}–{max(values):.3g})"


def compare(scene):
    print(f"\n## {scene.name}, {scene.samples} samples, {THREADS} threads, {ROUNDS} rounds\n", flush=True)
    reference = ours(scene, scene.reference, 1001)["picture"]
    pixels = reference.shape[0] * reference.shape[1]
    exports = {}
    if any(peer != "povray" for peer in scene.peers):
        exports["xml"] = exported(scene, "xml", flags=scene.export)
    if "povray" in scene.peers:
        exports["pov"] = exported(scene, "pov", ["straight=true"], ["--approximate"])
    rows = {name: [] for name in ("rtc", *scene.peers)}
    if "povray" in scene.peers:
        rows["rtc, straight"] = []
    for seed in range(1, ROUNDS + 1):
        rows["rtc"].append(ours(scene, scene.samples, seed))
        for peer in scene.peers:
            if peer == "povray":
                rows[peer].append(povray(scene, exports["pov"], scene.samples))
                rows["rtc, straight"].append(ours(scene, scene.samples, seed, ["--set", "straight=true"]))
            else:
                rows[peer].append(mitsuba(scene, peer, exports["xml"], scene.samples, seed))

    print("| renderer | wall s | warm s | Ms/s | relMSE | median | MB | red, green, blue of the reference's |")
    print("|---|---|---|---|---|---|---|---|")
    for name, found in rows.items():
        walls = [row["wall"] for row in found]
        warm = [row.get("warm", row["wall"]) for row in found]
        rate = pixels * scene.samples / statistics.median(warm) / 1e6
        cells = [name, f"{statistics.median(walls):.3g}", f"{statistics.median(warm):.3g}", f"{rate:.3g}"]
        if name in ("povray", "rtc, straight"):
            cells += ["", ""]
        else:
            found_errors = [errors(row["picture"], reference) for row in found]
            cells += [f"{statistics.median(e[i] for e in found_errors):.3g}" for i in (0, 1)]
        cells.append(f"{statistics.median(row['mb'] for row in found):.0f}")
        if "picture" in found[0] and name != "rtc, straight":
            mean = np.mean([row["picture"] for row in found], axis=0)
            ratio = mean.mean(axis=(0, 1)) / reference.mean(axis=(0, 1))
            cells.append(", ".join(f"{value:.3f}" for value in ratio))
        else:
            cells.append("")
        print("| " + " | ".join(cells) + " |", flush=True)

    print()
    for peer in scene.peers:
        if peer == "povray":
            print("Straight light alone, times as fast as POV-Ray: ", end="")
            print(spread([b["wall"] / a["wall"] for a, b in zip(rows["rtc, straight"], rows[peer])]))
            continue
        pairs = list(zip(rows["rtc"], rows[peer]))
        print(f"Times as fast as {peer}: wall {spread([b['wall'] / a['wall'] for a, b in pairs])}, ", end="")
        print(f"warm {spread([b['warm'] / a['wall'] for a, b in pairs])}")
        sooner(scene, peer, rows[peer], reference)


def sooner(scene, peer, found, reference):
    """How much sooner we have the error that a peer's pictures have, by renders with ever more samples."""
    ladder = []
    samples = 1
    while samples <= scene.reference // 4 and (not ladder or ladder[-1][0] < 20):
        row = ours(scene, samples, 77)
        ladder.append((row["wall"], *errors(row["picture"], reference)))
        samples *= 4
    for column, what in ((1, "relMSE"), (2, "median")):
        for row in found[:1]:
            theirs = errors(row["picture"], reference)[column - 1]
            wall = reached(ladder, column, theirs)
            if wall is None:
                print(f"The {what} {theirs:.3g} of {peer} is not reached within {ladder[-1][0]:.3g} s")
            else:
                print(
                    f"The {what} {theirs:.3g} of {peer}, {row['wall']:.3g} s ({row['warm']:.3g} warm): after {wall:.3g} s, "
                    f"{row['wall'] / wall:.3g} × sooner ({row['warm'] / wall:.3g})"
                )


def reached(ladder, column, wanted):
    """The seconds after which an error is reached, between the renders on both sides of it."""
    for (before, after) in zip(ladder, ladder[1:]):
        if after[column] <= wanted:
            if before[column] <= wanted:
                return before[0]
            share = np.log(before[column] / wanted) / np.log(before[column] / after[column])
            return float(np.exp(np.log(before[0]) * (1 - share) + np.log(after[0]) * share))
    return None


def start():
    """A whole process for a picture of 16×16 at one sample."""
    scene = SCENES[0]
    walls = []
    for _ in range(max(ROUNDS, 20)):
        out = path(scene, "png")
        _, wall, _ = run(
            [RTC, "build", "--quiet", scene.path, "--size", "16x16", "--samples", 1, "-o", out]
        )
        walls.append(wall * 1000)
    print(f"Start, 16×16 at one sample: {spread(walls)} ms")


def main():
    unknown = set(WANTED) - {scene.name for scene in SCENES} - {"start"}
    if unknown:
        sys.exit(f"no scene is called {', '.join(sorted(unknown))}; there are start, "
                 + ", ".join(scene.name for scene in SCENES))
    if not WANTED or "start" in WANTED:
        start()
    for scene in SCENES:
        if not WANTED or scene.name in WANTED:
            compare(scene)


main()
