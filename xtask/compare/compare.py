"""Renders the same scenes with `rtc` and with other renderers, in turns, and prints what each took.

Usage: compare.py RTC PYTHON DESK ROUNDS BUDGET [SCENE…]

PYTHON is one that has Mitsuba and NumPy, DESK a folder to write in. A scene's rounds end when there were ROUNDS, or
after BUDGET seconds. All rows of a table come from one run, in which the renderers took turns; a ratio is the median
over the rounds of the ratios within each, with the least and the greatest behind it, so that a busy machine harms it
little.

Wall time is that of the whole process, from its start to the written picture, text read and picture encoded; processor
time that of all its threads together. For Mitsuba, whose start loads libraries and compiles kernels, tracing alone is
told too ("warm"). The error is that of a picture against one with many samples of another seed, which is kept between
runs: relMSE is the mean of (x − r)² / (r² + 0.01), "median" the median of the pixels of the same.
"""

import os
import platform
import statistics
import sys
import time

import numpy as np

from runs import THREADS, Desk, errors
from scenes import LLVM, POVRAY, SCENES

RTC, PYTHON, DESK, ROUNDS, BUDGET = sys.argv[1:6]
WANTED = sys.argv[6:]
ROUNDS, BUDGET = int(ROUNDS), float(BUDGET)
DESK = Desk(RTC, PYTHON, DESK)
STRAIGHT = "rtc, straight"
# Most seconds of a picture of the ladder on which the time to a peer's error is found.
LONGEST = 30


def number(value):
    return "" if value is None else f"{value:.3g}"


def table(head, rows):
    print("\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    sys.stdout.flush()


def spread(values):
    return f"{statistics.median(values):.3g} ({min(values):.3g}–{max(values):.3g})"


def middle(found, what):
    values = [row[what] for row in found if what in row]
    return statistics.median(values) if values else None


def rounds(work, budget=BUDGET):
    """Does something for each seed until there were enough, or too little time is left for another."""
    start = time.monotonic()
    for seed in range(1, ROUNDS + 1):
        work(seed)
        spent = time.monotonic() - start
        if spent + spent / seed > budget:
            break


def compare(scene):
    reference = DESK.reference(scene) if scene.reference else None
    rows, exports = turns(scene)
    count = len(rows["rtc"])
    print(f"\n## {scene.name}\n\n{scene.samples} samples, {THREADS} threads, {count} rounds", end="")
    print(f", load average {os.getloadavg()[0]:.1f}", flush=True)
    pixels = rows["rtc"][0]["picture"].size / 3
    lines = []
    for name, found in rows.items():
        wall, cpu, warm, warm_cpu = (middle(found, what) for what in ("wall", "cpu", "warm", "warm_cpu"))
        cells = [name, *map(number, (wall, cpu, warm, warm_cpu))]
        cells += [number(pixels * scene.samples / 1e6 / seconds) for seconds in (warm or wall, warm_cpu or cpu)]
        if reference is not None and name not in (POVRAY, STRAIGHT):
            told = [errors(row["picture"], reference) for row in found]
            cells += [number(statistics.median(error[i] for error in told)) for i in (0, 1)]
            mean = np.mean([row["picture"] for row in found], axis=0).mean(axis=(0, 1))
            colours = ", ".join(f"{value:.3f}" for value in mean / reference.mean(axis=(0, 1)))
        else:
            cells += ["", ""]
            colours = ""
        lines.append([*cells, f"{middle(found, 'mb'):.0f}", colours])
    head = ["renderer", "wall s", "cpu s", "warm wall s", "warm cpu s", "Ms/s wall", "Ms/s cpu"]
    table([*head, "relMSE", "median", "MB", "r, g, b of the reference's"], lines)
    ratios(scene, rows)
    loading(scene, rows, exports)
    for peer in scene.peers:
        if peer != POVRAY and reference is not None:
            sooner(scene, peer, rows[peer], reference)


def turns(scene):
    """What everyone took, round by round, and the scene as the others read it."""
    exports = {}
    if any(peer != POVRAY for peer in scene.peers):
        exports["xml"] = DESK.exported(scene, "xml", flags=scene.export)
    if POVRAY in scene.peers:
        exports["pov"] = DESK.exported(scene, "pov", ["straight=true"], ["--approximate"])
    rows = {name: [] for name in ("rtc", *scene.peers)}
    if POVRAY in scene.peers:
        rows[STRAIGHT] = []

    def turn(seed):
        rows["rtc"].append(DESK.ours(scene, scene.samples, seed))
        for peer in scene.peers:
            if peer == POVRAY:
                rows[peer].append(DESK.povray(scene, exports["pov"], scene.samples))
                straight = DESK.ours(scene, scene.samples, seed, ["--set", "straight=true"])
                rows[STRAIGHT].append(straight)
            else:
                rows[peer].append(DESK.mitsuba(scene, peer, exports["xml"], scene.samples, seed))

    rounds(turn)
    return rows, exports


def ratios(scene, rows):
    lines = []
    for peer in scene.peers:
        mine = rows[STRAIGHT if peer == POVRAY else "rtc"]
        pairs = list(zip(mine, rows[peer]))
        cells = [spread([b[what] / a[what] for a, b in pairs]) for what in ("wall", "cpu")]
        if "warm" in rows[peer][0]:
            cells += [spread([b["warm" + of] / a[what] for a, b in pairs]) for what, of in (("wall", ""), ("cpu", "_cpu"))]
        else:
            cells += ["", ""]
        lines.append([peer + (", straight light alone" if peer == POVRAY else ""), *cells])
    table(["times as fast as", "wall", "cpu", "its warm wall", "its warm cpu"], lines)


def loading(scene, rows, exports):
    """Reading the scene: whole processes for a picture of 16×16 at one sample."""
    mine = DESK.ours(scene, 1, 1, size="16x16")
    cells = [f"rtc {mine['wall']:.3g} s, {mine['mb']:.0f} MB"]
    for peer in scene.peers:
        if peer == POVRAY:
            took = DESK.povray(scene, exports["pov"], 1, size="16x16")
            cells.append(f"{peer} {took['wall']:.3g} s, {took['mb']:.0f} MB")
        else:
            cells.append(f"{peer} {middle(rows[peer], 'load'):.3g} s without its start")
    print("\nTo load: " + "; ".join(cells) + ".", flush=True)


def sooner(scene, peer, found, reference):
    """How much sooner we have the error that a peer's pictures have, by renders with ever more samples."""
    theirs = [statistics.median(errors(row["picture"], reference)[i] for row in found) for i in (0, 1)]
    ladder = []
    samples = 1
    while samples <= scene.reference // 4:
        row = DESK.ours(scene, samples, 77)
        ladder.append((row["wall"], row["cpu"], *errors(row["picture"], reference)))
        if row["wall"] > LONGEST or all(ladder[-1][2 + i] <= theirs[i] for i in (0, 1)):
            break
        samples *= 2
    lines = []
    for i, what in enumerate(("relMSE", "median")):
        cells = [f"{what} {theirs[i]:.3g}"]
        for column, of, warm in ((0, "wall", "warm"), (1, "cpu", "warm_cpu")):
            took = reached(ladder, column, 2 + i, theirs[i])
            whole, traced = middle(found, of), middle(found, warm)
            if took is None:
                cells += [f"> {ladder[-1][column]:.3g}", f"{whole:.3g}", f"{traced:.3g}", ""]
            else:
                cells += [f"{took:.3g}", f"{whole:.3g}", f"{traced:.3g}", f"{whole / took:.3g} ({traced / took:.3g})"]
        lines.append(cells)
    head = [f"the error of {peer}"]
    for of in ("wall", "cpu"):
        head += [f"rtc, {of} s", "it", "warm", "× sooner (than warm)"]
    table(head, lines)


def reached(ladder, column, error, wanted):
    """The seconds after which an error is reached, between the renders on both sides of it."""
    if ladder[0][error] <= wanted:
        return ladder[0][column]
    for before, after in zip(ladder, ladder[1:]):
        if after[error] <= wanted:
            share = np.log(before[error] / wanted) / np.log(before[error] / after[error])
            return float(np.exp(np.log(before[column]) * (1 - share) + np.log(after[column]) * share))
    return None


def start():
    """Whole processes for a picture of 16×16 at one sample, and two threads beside one."""
    room = SCENES[0]
    mine = [DESK.ours(room, 1, 1, size="16x16") for _ in range(20)]
    xml = DESK.exported(room, "xml", flags=room.export)
    mitsuba = [DESK.mitsuba(room, LLVM, xml, 1, 1, size="16x16") for _ in range(3)]
    hyperboloids = next(scene for scene in SCENES if scene.name == "hyperboloids")
    pov = DESK.exported(hyperboloids, "pov", ["straight=true"], ["--approximate"])
    povray = [DESK.povray(hyperboloids, pov, 1, size="16x16") for _ in range(5)]
    print("\n## start\n\nWhole processes for a picture of 16×16 at one sample.")
    rows = [("the room by rtc", mine), (f"the room by {LLVM}", mitsuba), (f"hyperboloids by {POVRAY}", povray)]
    times = [[name, *(spread([row[of] * 1000 for row in found]) for of in ("wall", "cpu"))] for name, found in rows]
    table(["", "wall ms", "cpu ms"], times)
    pairs = []
    rounds(lambda seed: pairs.append([DESK.ours(room, 16, seed, threads=threads) for threads in (1, 2)]), 60)
    print("\nThe room at 16 samples with two threads, times as fast as with one, of", len(pairs), "rounds: wall", end=" ")
    print(f"{spread([one['wall'] / two['wall'] for one, two in pairs])}; processor seconds of two over one", end=" ")
    print(f"{spread([two['cpu'] / one['cpu'] for one, two in pairs])}.", flush=True)


def main():
    names = ["start", *(scene.name for scene in SCENES)]
    unknown = set(WANTED) - set(names)
    if unknown:
        sys.exit(f"no scene is called {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    models = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    print(f"{len(models)} processors: {models[0] if models else platform.processor()}", flush=True)
    began = time.monotonic()
    if not WANTED or "start" in WANTED:
        start()
    for scene in SCENES:
        if not WANTED or scene.name in WANTED:
            compare(scene)
    print(f"\n{(time.monotonic() - began) / 60:.1f} minutes in all.")


main()
