"""Work is never lost: a build that is killed at 200 random moments, also while it writes, always goes on from what it kept,
and in the end gives the very bytes of one that was left alone. The same on a disk that is full.
Usage: resume.py RTC ROOT, in an empty folder."""

import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

RTC = pathlib.Path(sys.argv[1])
KILLS = 200
SCENE = """
sphere { radius: 1m, material: dielectric { ior: 1.5 } }
sphere { radius: 40cm, at: (1.5, 0, 0.5)m, material: metal { roughness: 20% } }
plane { at: (0, -1, 0)m }
light { at: (2, 4, 3)m, radius: 30cm, power: 90W }
"""


def arguments(samples, *more):
    return [RTC, "build", "ball.rt", "--size", "480x360", "--samples", str(samples), "-o", "ball.exr", *more]


def run(*command, code=0):
    ended = subprocess.run(command, capture_output=True, text=True)
    if ended.returncode != code:
        sys.exit(f"ended with {ended.returncode}, not {code}: {ended.stderr}")
    return ended.stderr


def kills(samples):
    """Kills it again and again; each time it goes on. Tells how often it was killed while it wrote a checkpoint."""
    checkpoint, aside = pathlib.Path("ball.exr.checkpoint"), pathlib.Path(".ball.exr.checkpoint.tmp")
    within, killed, last = 0, 0, 0
    while killed < KILLS:
        child = subprocess.Popen(
            arguments(samples, "--checkpoint", "--checkpoint-every", "1spp"),
            stderr=subprocess.PIPE,
            text=True,
        )
        if killed % 2:
            # While it writes, if it can be caught at that.
            deadline = time.monotonic() + 5
            while not aside.exists() and child.poll() is None and time.monotonic() < deadline:
                time.sleep(0.001)
            time.sleep(random.uniform(0, 0.03))
        else:
            time.sleep(random.uniform(0, 1.2))
        child.send_signal(signal.SIGKILL)
        said = child.communicate()[1]
        if child.returncode != -signal.SIGKILL:
            if child.returncode != 0:
                sys.exit(f"it could not go on after {killed} kills: {said}")
            sys.exit(f"it was done after {killed} kills: give it more samples")
        killed += 1
        within += aside.exists()
        size = checkpoint.stat().st_size if checkpoint.exists() else 0
        if size < last // 2:
            sys.exit("a checkpoint was replaced by less")
        last = size
    return within


def stopped_by(name):
    """Asked to end, it keeps what it has; told by SIGUSR1 it goes on."""
    child = subprocess.Popen(arguments(1000000, "--checkpoint=own", "--quiet"), stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    if os.path.exists("own"):
        sys.exit("there is a checkpoint before it is time")
    child.send_signal(signal.SIGUSR1)
    deadline = time.monotonic() + 20
    while not os.path.exists("own"):
        if time.monotonic() > deadline or child.poll() is not None:
            sys.exit("SIGUSR1 wrote no checkpoint")
        time.sleep(0.01)
    before = os.stat("own").st_mtime_ns
    time.sleep(0.7)
    child.send_signal(getattr(signal, name))
    said = child.communicate()[1]
    if child.returncode != 130 or os.stat("own").st_mtime_ns == before:
        sys.exit(f"{name} wrote no checkpoint, or ended with {child.returncode}: {said}")
    os.remove("own")


def full_disk():
    """On a full disk what was kept stays, it is said, and a picture that finds no room is an error."""
    disk = pathlib.Path("disk")
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=20m", "tmpfs", disk], check=True)
    try:
        shutil.copy("ball.rt", disk)
        os.chdir(disk)
        run(*arguments(8, "--checkpoint", "--quiet"))
        kept = pathlib.Path("ball.exr.checkpoint").read_bytes()
        room = os.statvfs(".")
        # Room for neither another checkpoint nor the picture.
        pathlib.Path("filler").write_bytes(bytes(room.f_bavail * room.f_frsize - 200_000))
        said = run(*arguments(16, "--checkpoint", "--checkpoint-every", "1spp", "--quiet"), code=2)
        if "no space left" not in said or "the samples are not kept" not in said:
            sys.exit(f"the full disk was not told of: {said}")
        if pathlib.Path("ball.exr.checkpoint").read_bytes() != kept:
            sys.exit("a full disk spoilt the checkpoint")
        os.remove("filler")
        run(*arguments(16, "--checkpoint", "--quiet"))
        done = pathlib.Path("ball.exr").read_bytes()
        os.remove("ball.exr.checkpoint")
        run(*arguments(16, "--quiet"))
        if pathlib.Path("ball.exr").read_bytes() != done:
            sys.exit("after a full disk it is another picture")
    finally:
        os.chdir("..")
        subprocess.run(["umount", disk], check=False)


def in_namespace():
    """Mounting needs leave: as it is, or as root of a namespace of one's own."""
    if os.environ.get("IN_NAMESPACE"):
        return
    for leave in (["--mount"], ["--user", "--map-root-user", "--mount"]):
        if subprocess.run(["unshare", *leave, "true"], capture_output=True).returncode == 0:
            environment = {**os.environ, "IN_NAMESPACE": "1"}
            os.execvpe("unshare", ["unshare", *leave, sys.executable, *sys.argv], environment)
    sys.exit("needs leave to mount a tmpfs: run as root, or allow user namespaces")


in_namespace()
random.seed(1)
pathlib.Path("ball.rt").write_text(SCENE)
for name in ("SIGTERM", "SIGINT"):
    stopped_by(name)
full_disk()
MOST = 30_000
within = kills(MOST)
kept = run(RTC, "build", "ball.rt", "--size", "480x360", "--samples", "1", "-o", "ball.exr", "--resume")
samples = int(kept.split(" samples")[0].rsplit(" ", 1)[-1].strip())
run(*arguments(samples + 1, "--resume", "--quiet"))
resumed = pathlib.Path("ball.exr").read_bytes()
os.remove("ball.exr.checkpoint")
run(*arguments(samples + 1, "--quiet"))
if pathlib.Path("ball.exr").read_bytes() != resumed:
    sys.exit("what was killed and went on is another picture")
if sorted(os.listdir(".")) != ["ball.exr", "ball.rt", "disk"]:
    sys.exit(f"something is left behind: {os.listdir('.')}")
print(f"  {KILLS} kills, {within} of them within a checkpoint; {samples} samples in the end, the same bytes")
