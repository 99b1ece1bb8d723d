"""What a thousand to ten million balls of balls.rt take, each of its own material. Usage: many.py RTC ROOT.

Read is `rtc check`: the text, the loops, the scene, and what is probably not meant. The first pixel is a build of one pixel at
one sample, from the start of the process to its file.
"""

import os
import subprocess
import sys
import tempfile
import time

RTC, ROOT = sys.argv[1:]
ROUNDS = 2


def run(arguments):
    """Seconds and most bytes of memory that a command took; the least of several rounds, or of one that takes long."""
    least = None
    for _ in range(ROUNDS):
        start = time.monotonic()
        process = subprocess.Popen([RTC, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        said = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        took = time.monotonic() - start
        if status:
            sys.exit(f"rtc {' '.join(arguments)}: {said.decode()[-2000:]}")
        # Linux counts in KiB.
        found = (took, used.ru_maxrss * 1024)
        least = found if least is None else tuple(map(min, least, found))
        if took > 5:
            break
    return least


def main():
    print("| balls | read in s | first pixel after s | most memory, MB | bytes a ball |", flush=True)
    print("|---|---|---|---|---|", flush=True)
    bare = None
    with tempfile.TemporaryDirectory() as desk:
        for count in [1, 10**3, 10**4, 10**5, 10**6, 10**7]:
            limits = ["--max-items", str(10**7), "--max-things", str(10**7 + 10)]
            scene = [f"{ROOT}/xtask/compare/balls.rt", "--set", f"count={count}", *limits]
            read, _ = run(["check", *scene])
            pixel, memory = run(["build", *scene, "--crop", "320,240,1,1", "--samples", "1", "-o", f"{desk}/balls.exr"])
            # What the process takes anyway is not the balls'.
            bare = memory if bare is None else bare
            if count > 1:
                print(f"| {count} | {read:.3f} | {pixel:.3f} | {memory / 1e6:.0f} | {(memory - bare) / count:.0f} |", flush=True)


main()
