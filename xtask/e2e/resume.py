"""Work is never lost: builds that are killed at 200 random moments, also while they write, always go on from what they kept, and
in the end give the very bytes of ones that were left alone: pictures of so many samples and of so little noise, a share and a
film. The same when they are asked to end while they write, and on a disk that is full. How far a build was is judged by the
samples that its checkpoint says it has, of the least and of the most pixel: neither is ever less than before.
Usage: resume.py RTC ROOT, in an empty folder."""

import os
import pathlib
import random
import signal
import struct
import subprocess
import sys
import time

RTC = pathlib.Path(sys.argv[1])
SCENE = """
param t: number = 0
sphere { radius: 1m, material: dielectric { ior: 1.5 } }
sphere { radius: 40cm, at: (1.5 + t, 0, 0.5)m, material: metal { roughness: 20% } }
plane { at: (0, -1, 0)m }
light { at: (2, 4, 3)m, radius: 30cm, power: 90W, color: #ffb060 }
camera { from: (0, 1, 6)m, look: (0, 0, 0)m, exposure: 0 }
"""
KEEP = ("--checkpoint", "--checkpoint-every", "1spp")
running = []


def start(*arguments):
    child = subprocess.Popen([RTC, *map(str, arguments)], stderr=subprocess.PIPE, text=True)
    running.append(child)
    return child


def end(child, sign):
    """Ends a build. Gives how it ended, and what it said."""
    if sign:
        child.send_signal(sign)
    said = child.communicate()[1]
    running.remove(child)
    return child.returncode, said


def worked(child):
    """The seconds of processors that a build has taken."""
    fields = pathlib.Path(f"/proc/{child.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(*arguments, code=0):
    ended, said = end(start(*arguments), None)
    if ended != code:
        sys.exit(f"ended with {ended}, not {code}: {said}")
    return said


def samples(path):
    """The least and the most samples of a pixel that a checkpoint says it has. It must be whole: to the end of its last lines."""
    file = pathlib.Path(path).read_bytes()
    at, attributes = 8, {}
    while file[at]:
        name, kind, rest = file[at : at + 512].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (length,) = struct.unpack_from("<I", file, at)
        attributes[name.decode()] = file[at + 4 : at + 4 + length]
        at += 4 + length
    _, top, _, bottom = struct.unpack("<4i", attributes["dataWindow"])
    chunks = (bottom - top) // 16 + 1
    (last,) = struct.unpack_from("<Q", file, at + 1 + 8 * (chunks - 1))
    (length,) = struct.unpack_from("<I", file, last + 4)
    if last + 8 + length != len(file):
        sys.exit(f"`{path}` is torn")
    return [int(attributes[name]) for name in ("rtc.samples.least", "rtc.samples")]


class Kept:
    """A build that keeps its samples, and how far it was when it was looked at last."""

    def __init__(self, picture, *arguments):
        self.checkpoint = pathlib.Path(f"{picture}.checkpoint")
        self.aside = pathlib.Path(f".rtc-{picture}.checkpoint.tmp")
        self.arguments = ("build", "ball.rt", *arguments, "-o", picture, *KEEP)
        self.files, self.last, self.done = f"{picture}*", [0, 0], 0

    def start(self):
        return start(*self.arguments)

    def writing(self):
        return self.aside.exists()

    def look(self):
        if self.checkpoint.exists():
            now = samples(self.checkpoint)
        else:
            now = [0, 0]
        if any(own < before for own, before in zip(now, self.last)):
            sys.exit(f"{self.checkpoint}: {self.last} samples were kept, and now there are {now}")
        self.last = now


class Film(Kept):
    """A film, whose frames are done one after the other."""

    def __init__(self, frames, *arguments):
        self.arguments = ("build", "ball.rt", "--sweep", "t = 0 to 1", "--frames", frames, *arguments, "-o", "f{}.exr", *KEEP)
        self.files, self.last, self.done = "f*.exr*", [0, 0], 0

    def writing(self):
        return any(pathlib.Path().glob(".rtc-f*.exr.checkpoint.tmp"))

    def look(self):
        done = len(list(pathlib.Path().glob("f*.exr.made")))
        # That of a frame goes once the frame is recorded: there may be one more.
        kept = pathlib.Path(f"f{done + 1}.exr.checkpoint")
        now = samples(kept) if kept.exists() else [0, 0]
        if done < self.done or done == self.done and any(own < before for own, before in zip(now, self.last)):
            sys.exit(f"frame {self.done + 1} had {self.last} samples, and now frame {done + 1} has {now}")
        self.done, self.last = done, now


def until_writing(build, child):
    """Waits for a build to write, if it can be caught at that, and a little on."""
    deadline = time.monotonic() + 4
    while not build.writing() and child.poll() is None and time.monotonic() < deadline:
        time.sleep(0.0005)
    time.sleep(random.uniform(0, 0.02))


def killed(build, times):
    """Kills a build again and again; each time it goes on. Gives how often it was killed while it wrote."""
    within = number = starts = 0
    while number < times:
        child = build.start()
        starts += 1
        if starts % 2:
            until_writing(build, child)
        else:
            time.sleep(random.uniform(0, 1.0))
        code, said = end(child, signal.SIGKILL)
        if code == 0:
            # Done before it was killed: from its beginning once more.
            remove(build.files)
            build.last, build.done = [0, 0], 0
            if starts > 4 * times:
                sys.exit(f"{build.arguments}: too soon done to be killed {times} times")
            continue
        number += 1
        if code != -signal.SIGKILL:
            sys.exit(f"{build.arguments}: ended with {code} after {number} kills: {said}")
        within += build.writing()
        build.look()
    return within


def same(path, other):
    if pathlib.Path(path).read_bytes() != pathlib.Path(other).read_bytes():
        sys.exit(f"`{path}` was killed and went on, and is another than `{other}`")


def remove(*patterns):
    for pattern in patterns:
        for path in pathlib.Path().glob(pattern):
            path.unlink()


def nothing_left(*names):
    left = sorted(name for name in os.listdir(".") if name not in names)
    if left:
        sys.exit(f"something is left behind: {left}")


def pictures_of_samples(times):
    flags = ("--size", "320x240")
    build = Kept("ball.exr", *flags, "--samples", 100_000)
    within = killed(build, times)
    most = build.last[1] + 1
    run("build", "ball.rt", *flags, "--samples", most, "-o", "ball.exr", "--resume", "--quiet")
    run("build", "ball.rt", *flags, "--samples", most, "-o", "one.exr", "--quiet")
    same("ball.exr", "one.exr")
    remove("*.exr*")
    print(f"  a picture: {times} kills, {within} of them while it wrote, {most} samples")
    return within


def pictures_of_noise(times):
    """Of many rungs, in which some pixels get more samples than others."""
    flags = ("--size", "160x120", "--noise", "0.2%", "--min-samples", "16")
    build = Kept("calm.exr", *flags)
    within = killed(build, times)
    # No further than that, for as long as it would take: what was kept goes on to the same.
    most = build.last[1] + 1
    said = run("build", "ball.rt", *flags, "--samples", most, "-o", "calm.exr", "--resume", "-j", 1)
    run("build", "ball.rt", *flags, "--samples", most, "-o", "one.exr", "--quiet")
    same("calm.exr", "one.exr")
    remove("*.exr*")
    print(f"  a noise target: {times} kills, {within} of them while it wrote,{said.split(',')[1].split(' in ')[0]}")
    return within


def shares(times):
    flags = ("--size", "240x180", "--samples", 12_000, "--shard", "2/12")
    build = Kept("part.exr", *flags)
    within = killed(build, times)
    least, most = build.last
    run(*build.arguments, "--quiet")
    run("build", "ball.rt", *flags, "-o", "one.exr", "--quiet")
    same("part.exr", "one.exr")
    remove("*.exr*")
    print(f"  a share: {times} kills, {within} of them while it wrote, at {least} to {most} samples then")
    return within


def films(times):
    flags = ("--size", "240x180", "--samples", 150)
    build = Film(12, *flags)
    within = killed(build, times)
    run(*build.arguments, "--quiet")
    nothing_left("ball.rt", *(f"f{frame}.exr{more}" for frame in range(1, 13) for more in ("", ".made")))
    run("build", "ball.rt", "--sweep", "t = 0 to 1", "--frames", 12, *flags, "-o", "one{}.exr", "--quiet")
    for frame in range(1, 13):
        same(f"f{frame}.exr", f"one{frame}.exr")
    remove("*.exr*")
    print(f"  a film: {times} kills, {within} of them while it wrote, {build.done} of 12 frames done then")
    return within


def asked_to_end(times):
    """Asked to end, it keeps what it has, also while it is writing; told by SIGUSR1 it goes on."""
    for number in range(times):
        name = ("SIGTERM", "SIGINT")[number % 2]
        build = Kept("ball.exr", "--size", "320x240", "--samples", 1_000_000)
        child = build.start()
        # Past the first look at what is there, when there is something to lose.
        while not build.checkpoint.exists() and child.poll() is None:
            time.sleep(0.001)
        build.look()
        until_writing(build, child)
        code, said = end(child, getattr(signal, name))
        if code != 130 or "interrupted" not in said:
            sys.exit(f"by {name} it ended with {code}: {said}")
        build.look()
        nothing_left("ball.rt", "ball.exr.checkpoint")
        remove("*.checkpoint")
    for name in ("SIGTERM", "SIGINT"):
        child = start("build", "ball.rt", "--size", "320x240", "--samples", 1_000_000, "-o", "ball.exr", "--checkpoint=own")
        # What it will write is there once it heeds signals.
        while not os.path.exists(".rtc-ball.exr.tmp") and child.poll() is None:
            time.sleep(0.01)
        time.sleep(1)
        if os.path.exists("own"):
            sys.exit("there is a checkpoint before it is time")
        child.send_signal(signal.SIGUSR1)
        deadline = time.monotonic() + 20
        while not os.path.exists("own"):
            if time.monotonic() > deadline or child.poll() is not None:
                sys.exit("SIGUSR1 wrote no checkpoint")
            time.sleep(0.01)
        before, written = samples("own"), os.stat("own").st_mtime_ns
        # Enough to have traced more, however busy the machine is.
        enough = worked(child) + 1.5
        while worked(child) < enough and child.poll() is None:
            time.sleep(0.01)
        code, said = end(child, getattr(signal, name))
        fewer = any(own < earlier for own, earlier in zip(samples("own"), before))
        if code != 130 or fewer or os.stat("own").st_mtime_ns == written:
            sys.exit(f"{name} wrote no checkpoint, or ended with {code}: {said}")
        os.remove("own")
    print(f"  asked to end {times} times while it wrote")


def full_disk(times):
    """On a full disk what was kept stays, it is said, and a picture that finds no room is an error."""
    disk = pathlib.Path("disk")
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=32m", "tmpfs", disk], check=True)
    try:
        os.chdir(disk)
        pathlib.Path("ball.rt").write_text(SCENE)
        flags = ("--size", "320x240", "-o", "ball.exr", "--quiet")
        build = Kept("ball.exr", "--size", "320x240", "--samples", 100_000)
        run("build", "ball.rt", "--samples", 8, *flags, "--checkpoint")
        build.look()
        kept = build.checkpoint.read_bytes()
        # Room for no other checkpoint and no picture, for a part of one, and for most of it; and then killed at it.
        for number in range(times):
            room = os.statvfs(".")
            left = (0, 200_000, len(kept) // 2, len(kept) - 4096)[number % 4]
            pathlib.Path("filler").write_bytes(bytes(room.f_bavail * room.f_frsize - left))
            if number < 4:
                # The picture is smaller than its exact sums, and goes on without them.
                said = run("build", "ball.rt", "--samples", 16, *flags, *KEEP, code=2 if left < 300_000 else 0)
                if "no space left" not in said or "the samples are not kept" not in said:
                    sys.exit(f"the full disk was not told of: {said}")
            else:
                killed(build, 2)
            if build.checkpoint.read_bytes() != kept:
                sys.exit("a full disk spoilt the checkpoint")
            remove("filler", ".*.tmp")
        run("build", "ball.rt", "--samples", 16, *flags, "--checkpoint")
        os.rename("ball.exr", "kept.exr")
        remove("*.checkpoint")
        run("build", "ball.rt", "--samples", 16, *flags)
        same("kept.exr", "ball.exr")
        print(f"  a full disk: {times} times")
    finally:
        os.chdir("..")
        subprocess.run(["umount", disk], check=False)
        disk.rmdir()


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
signal.signal(signal.SIGTERM, lambda *_: sys.exit("asked to end"))
pathlib.Path("ball.rt").write_text(SCENE)
try:
    asked_to_end(12)
    full_disk(8)
    if 0 in (pictures_of_samples(92), pictures_of_noise(40), shares(30), films(30)):
        sys.exit("one was never killed while it wrote")
    nothing_left("ball.rt")
finally:
    for child in running:
        child.kill()
        child.wait()
