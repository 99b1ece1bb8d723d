"""Runs the command on a pseudo-terminal: it must show its progress, let no scene steer it, and end soon after a Ctrl-C.

Usage: terminal.py RTC ROOT, in an empty folder.
"""

import os
import pty
import re
import select
import signal
import sys
import time

RTC = sys.argv[1]
# Long before what it does would be done. How soon it ends on an idle machine is measured by `cargo bench --bench cancel`.
SOON = 2.0
PICTURE = b"the picture of yesterday"


def start(arguments, environment=None):
    """Starts the command with a new terminal as its standard input, output and error."""
    child, terminal = pty.fork()
    if child == 0:
        os.environ.update(environment or {})
        os.execv(RTC, [RTC, *arguments])
    return child, terminal


def read(terminal, until, seconds=60.0):
    """What the terminal shows until a pattern appears; without a pattern, until the command has ended."""
    shown = b""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if select.select([terminal], [], [], 0.05)[0]:
            try:
                part = os.read(terminal, 65536)
            except OSError:  # the other side is closed
                part = b""
            if not part:
                if until is None:
                    return shown
                sys.exit(f"it ended without showing {until}: {shown!r}")
            shown += part
        if until is not None and re.search(until, shown):
            return shown
    sys.exit(f"{until} did not show within {seconds} s: {shown!r}")


def wait(child, seconds=5.0):
    """The exit code, and how long it took."""
    begin = time.monotonic()
    while time.monotonic() - begin < seconds:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status), time.monotonic() - begin
        time.sleep(0.001)
    os.kill(child, signal.SIGKILL)
    sys.exit("it did not end")


def check(holds, message):
    if not holds:
        sys.exit(message)


def files():
    return sorted(os.listdir("."))


def finishes_with_a_report():
    child, terminal = start(["build", "ball.rt", "--size", "320x240", "--samples", "64", "-o", "done.png"])
    shown = read(terminal, None)
    code, _ = wait(child)
    check(code == 0, f"exit code {code}: {shown!r}")
    check(b"done.png: 320\xc3\x97240, 64 samples" in shown, f"no report: {shown!r}")
    os.remove("done.png")


def colours_only_where_wanted():
    for environment, coloured in [({"TERM": "xterm"}, True), ({"TERM": "xterm", "NO_COLOR": "1"}, False)]:
        child, terminal = start(["check", "bad.rt"], environment)
        shown = read(terminal, None)
        code, _ = wait(child)
        check(code == 1, f"exit code {code}: {shown!r}")
        check((b"\x1b[" in shown) == coloured, f"with {environment}: {shown!r}")


# The title of the window, the cursor's place by two ways, and the other direction of writing.
STEERING = ["\x1b]0;pwned\x07", "\x1b[9;9H", "\x9b9;9H", "\u202e"]


def nothing_steers_it():
    """What a scene, and a file's name, say in a comment, a text and a param's words reaches the terminal without control characters."""
    steering = "".join(STEERING)
    name = "steers\x1b[9;9H.rt"
    lines = [f"/// {steering}", f'param a: text = "{steering}"', f"// {steering}", "sphere {radius: 1m}", ""]
    with open(name, "w") as scene:
        scene.write("\n".join(lines))
    small = ["--size", "4x4", "--samples", "1"]
    for arguments in [
        ["check", name, "no" + name],
        ["check", "--message-format", "json", name],
        ["check", "--set", "a=1", "--message-format", "json", name],
        ["check", "--set", "a=1", "--message-format", "github", name],
        ["check", "--set", "a=1", "--message-format", "sarif", name],
        ["build", name, *small, "-o", "\x1b[9;9H.png"],
        ["build", name, *small, "--sweep", "b = 0 to 1", "--frames", "2", "-o", "\x1b[9;9H.webp"],
        ["fmt", "--diff", name],
        ["fmt", "--check", name],
        ["info", name],
        ["info", "--json", name],
        ["expand", name],
        ["why", name, "0,0", *small],
        ["why", name, "0,0", "--json", *small],
        ["export", name, "-o", "no\x1b[9;9H/a.pbrt"],
        ["develop", name, "-o", "a.png"],
        ["merge", name, "-o", "a.png"],
    ]:
        child, terminal = start(arguments)
        shown = read(terminal, None).decode()
        code, _ = wait(child)
        check(code in (0, 1, 2), f"{arguments} ended with {code}: {shown!r}")
        for word in STEERING:
            check(word not in shown, f"{arguments} let {word!r} through: {shown!r}")
    with open(name) as scene:
        check(scene.read() == "\n".join(lines), "the scene was touched")
    for left in os.listdir("."):
        if "\x1b" in left:
            os.remove(left)


def listens(child, seconds=60.0):
    """Waits until the command has taken Ctrl-C into its own hands: before that, the system ends it."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        # This script listens for Ctrl-C itself, and is what the child is at first.
        if not os.path.samefile(f"/proc/{child}/exe", RTC):
            continue
        with open(f"/proc/{child}/status") as status:
            caught = re.search(r"^SigCgt:\s*(\w+)", status.read(), re.MULTILINE)
        if caught and int(caught[1], 16) >> (signal.SIGINT - 1) & 1:
            return
        time.sleep(0.001)
    sys.exit(f"it does not listen for Ctrl-C after {seconds} s")


def interrupted(arguments, ready):
    """The time to end from a Ctrl-C typed once `ready` has come true of the terminal."""
    child, terminal = start(arguments)
    listens(child)
    ready(terminal)
    os.write(terminal, b"\x03")
    code, took = wait(child)
    os.close(terminal)
    check(code == 130, f"exit code {code} after Ctrl-C, not 130")
    check(files() == ["bad.rt", "ball.png", "ball.rt", "large.rt"], f"left behind: {files()}")
    with open("ball.png", "rb") as picture:
        check(picture.read() == PICTURE, "the earlier picture was touched")
    return took


def ends_soon(name, arguments, ready):
    times = [interrupted(arguments, ready) for _ in range(5)]
    said = ", ".join(f"{1000 * took:.0f}" for took in times)
    print(f"  Ctrl-C while {name}: {said} ms")
    check(max(times) <= SOON, f"while {name}, Ctrl-C took {said} ms")


def main():
    with open("ball.rt", "w") as scene:
        scene.write("sphere { radius: 1m }\n")
    with open("bad.rt", "w") as scene:
        scene.write("sphere { radius: 8deg }\n")
    with open("large.rt", "w") as scene:
        scene.write("sphere { at: (1, 2, 3)m, radius: 10cm }\n" * 500_000)
    finishes_with_a_report()
    colours_only_where_wanted()
    nothing_steers_it()
    with open("ball.png", "wb") as picture:
        picture.write(PICTURE)
    long = ["build", "ball.rt", "--size", "2000x2000", "--samples", "100000"]
    progress = rb"\d+ %.*samples/s.*left"
    ends_soon("tracing", long, lambda terminal: read(terminal, progress))
    ends_soon("compiling", ["build", "large.rt", "-o", "large.png"], lambda _: time.sleep(0.3))
    ends_soon("reading standard input", ["build", "-", "-o", "a.png"], lambda _: time.sleep(0.1))


main()
