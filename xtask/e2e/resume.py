"""Work is never lost: a build that is killed at 200 random moments, also while it writes, always goes on from what it kept,
and in the end gives the very bytes of one that was left alone. The same on a disk that is full.
Usage: resume.py RTC ROOT, in an empty folder."""

import os
import pathlib
import random
import shutil
import signal
import struct
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


def kept_samples(path):
    """The most samples of a pixel that a checkpoint holds, as its head says: 0 where there is none."""
    if not path.exists():
        return 0
    with open(path, "rb") as file:
        head = file.read(1 << 16)
    # An attribute of OpenEXR: its name and type, each with a zero behind, the length, the value.
    name = b"\0rtc.samples\0string\0"
    at = head.find(name)
    if at < 0:
        sys.exit("a checkpoint does not say how many samples it has")
    start = at + len(name) + 4
    (length,) = struct.unpack_from("<i", head, start - 4)
    return int(head[start : start + length])


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
            time.sleep(random.uniform(0, 0.6))
        child.send_signal(signal.SIGKILL)
        said = child.communicate()[1]
        if child.returncode != -signal.SIGKILL:
            if child.returncode != 0:
                sys.exit(f"it could not go on after {killed} kills: {said}")
            sys.exit(f"it was done after {killed} kills: give it more samples")
        killed += 1
        within += aside.exists()
        kept = kept_samples(checkpoint)
        if kept < last:
            sys.exit(f"a checkpoint of {last} samples was replaced by one of {kept}")
        last = kept
    if within < KILLS // 20:
        sys.exit(f"only {within} of {KILLS} kills came while a checkpoint was written")
    return within


def stopped_while_writing():
    """Asked to end while it writes a checkpoint, it ends with a whole one, no smaller than the one before."""
    checkpoint, aside = pathlib.Path("own"), pathlib.Path(".own.tmp")
    command = arguments(1000000, "--checkpoint=own", "--checkpoint-every", "1spp", "--quiet")
    last, within = 0, 0
    for _ in range(10):
        child = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 20
        while not (aside.exists() and kept_samples(checkpoint) > last) and child.poll() is None:
            if time.monotonic() > deadline:
                sys.exit("no checkpoint is written")
            time.sleep(0.001)
        within += aside.exists()
        child.send_signal(signal.SIGTERM)
        said = child.communicate()[1]
        kept = kept_samples(checkpoint)
        if child.returncode != 130 or kept <= last or aside.exists():
            sys.exit(f"SIGTERM within a checkpoint: {child.returncode}, {kept} samples after {last}: {said}")
        last = kept
    if within == 0:
        sys.exit("SIGTERM never came while a checkpoint was written")
    os.remove("own")


def killed_and_whole(what, command, outputs, kills=12, longest=1.5):
    """Killed a few times and begun again, what comes about in the end has the bytes of what was left alone."""
    killed = 0
    for attempt in range(kills):
        child = subprocess.Popen([*command, "--resume", "--checkpoint-every", "100ms"], stderr=subprocess.DEVNULL)
        try:
            child.wait(random.uniform(0.1, longest))
        except subprocess.TimeoutExpired:
            killed += 1
        child.kill()
        child.wait()
    if killed < 3:
        sys.exit(f"{what}: only {killed} kills came before it was done: give it more to do")
    run(*command, "--resume", "--quiet")
    resumed = [pathlib.Path(name).read_bytes() for name in outputs]
    for name in os.listdir("."):
        if any(name.startswith((output, "." + output)) for output in outputs):
            shutil.rmtree(name) if os.path.isdir(name) else os.remove(name)
    run(*command, "--quiet")
    for name, before in zip(outputs, resumed):
        if pathlib.Path(name).read_bytes() != before:
            sys.exit(f"{what}: killed and gone on, `{name}` is another")
        os.remove(name)


def others():
    """A noise target, a transparent picture, shares and a film, killed and gone on."""
    pathlib.Path("clear.rt").write_text(SCENE + "render { background: transparent }\n")
    sized = ["--size", "320x240"]
    killed_and_whole("a noise target", [RTC, "build", "ball.rt", *sized, "--noise", "1.5%", "-o", "n.exr"], ["n.exr"])
    killed_and_whole(
        "a transparent picture", [RTC, "build", "clear.rt", *sized, "--samples", "400", "-o", "c.exr"], ["c.exr"]
    )
    killed_and_whole(
        "a share", [RTC, "build", "ball.rt", *sized, "--samples", "800", "--shard", "2/2", "-o", "s.exr"], ["s.exr"]
    )
    film = ["--sweep", "t = 0 to 1", "--frames", "6", "--size", "160x120", "--samples", "60", "-o", "film.webp"]
    pathlib.Path("film.rt").write_text("param t: number = 0\n" + SCENE.replace("(1.5, 0,", "(1.5, t,"))
    killed_and_whole("a film", [RTC, "build", "film.rt", *film], ["film.webp"])
    os.remove("clear.rt")
    os.remove("film.rt")


def full_and_killed():
    """Killed again and again on a disk that is nearly full, what was kept stays, and goes on when there is room."""
    disk = pathlib.Path("disk")
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=20m", "tmpfs", disk], check=True)
    try:
        shutil.copy("ball.rt", disk)
        os.chdir(disk)
        run(*arguments(8, "--checkpoint", "--quiet"))
        checkpoint = pathlib.Path("ball.exr.checkpoint")
        room = os.statvfs(".")
        pathlib.Path("filler").write_bytes(bytes(room.f_bavail * room.f_frsize - 400_000))
        for _ in range(20):
            child = subprocess.Popen(
                arguments(100000, "--checkpoint", "--checkpoint-every", "1spp", "--quiet"), stderr=subprocess.DEVNULL
            )
            time.sleep(random.uniform(0.05, 0.8))
            child.kill()
            child.wait()
            if kept_samples(checkpoint) < 8:
                sys.exit("on a full disk a checkpoint was replaced by less")
        os.remove("filler")
        run(*arguments(16, "--checkpoint", "--quiet"))
        left = [name for name in os.listdir(".") if name.startswith(".")]
        if left:
            sys.exit(f"left on the full disk: {left}")
    finally:
        os.chdir("..")
        subprocess.run(["umount", disk], check=False)


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
stopped_while_writing()
full_disk()
full_and_killed()
others()
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
