"""A picture of an editor in a terminal, with colours and a message about a slip.

Usage: screen.py OUT PROGRAM [ARGUMENT…], in an empty folder, by a Python with pyte. The program is given `shown.rt`
besides. OUT is a page of HTML, which a browser makes a picture of.
"""

import html
import os
import pty
import select
import signal
import struct
import sys
import termios
import time
from fcntl import ioctl

import pyte

COLUMNS, LINES = 110, 32

SCENE = """\
// A ring of marbles on a table.
/// How many there are.
param count: int = 7 in 1 to 20

material glass = dielectric { ior: 1.52 }
let marble = sphere { radius: 8mm, material: glass }

fn sway(i: int) -> angle = 6deg * sin(40deg * i)

for i in range(count) {
  let a = 360deg * i / count
  marble {
    at: (30mm * cos(a), 8mm, 30mm * sin(a))
    place: turn(z: sway(i)) |> move(0, 1mm, 0)
    material: if mod(i, 2) == 0 then glass else diffuse { color: orange }
  }
}

@allow(W0602, "not in view yet")
sphere ball { at: (0, 30, 0)mm, radius: 8deg, material: metal { color: #c9a227 } }
light { at: (-20, 40, 25)cm, power: 15W, color: blackbody(3200K) }
camera { from: (0, 9, 26)cm, look: ball }
"""

# What the message says. The editor is to show it within so many seconds, and then to be still for some.
MESSAGE = "wants a"
PATIENCE, STILL = 60, 1.5

# What a terminal without a theme shows.
NAMED = {
    "black": "#000000", "red": "#cd3131", "green": "#0dbc79", "brown": "#e5e510", "blue": "#2472c8",
    "magenta": "#bc3fbc", "cyan": "#11a8cd", "white": "#e5e5e5",
}


def colour(name, otherwise):
    if name == "default":
        return otherwise
    return NAMED.get(name, f"#{name}")


def page(screen):
    rows = []
    for row in range(LINES):
        cells = []
        for column in range(COLUMNS):
            cell = screen.buffer[row][column]
            front, back = colour(cell.fg, "#e0e2ea"), colour(cell.bg, "#14161b")
            if cell.reverse:
                front, back = back, front
            style = f"color:{front};background:{back}"
            style += ";font-weight:bold" if cell.bold else ""
            style += ";font-style:italic" if cell.italics else ""
            style += ";text-decoration:underline" if cell.underscore else ""
            cells.append(f'<span style="{style}">{html.escape(cell.data)}</span>')
        rows.append("".join(cells))
    body = "\n".join(rows)
    return f'<!doctype html><meta charset="utf-8"><style>body{{margin:0;background:#14161b}}pre{{font:14px/1.3 "DejaVu Sans Mono",monospace;margin:8px}}</style><pre>{body}</pre>\n'


class Screen(pyte.Screen):
    """Of what an editor asks a terminal for (CSI ? 4 m, CSI ? 996 n), pyte makes something else, and stumbles."""

    def select_graphic_rendition(self, *attributes, private=False):
        if not private:
            super().select_graphic_rendition(*attributes)

    def report_device_status(self, mode, private=False):
        if not private:
            super().report_device_status(mode)


def shows(screen):
    return any(MESSAGE in line for line in screen.display)


def main():
    out, *command = sys.argv[1:]
    with open("shown.rt", "w", encoding="utf-8") as file:
        file.write(SCENE)
    child, terminal = pty.fork()
    if child == 0:
        os.execvpe(command[0], [*command, "shown.rt"], dict(os.environ, TERM="xterm-256color", COLORTERM="truecolor"))
    ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", LINES, COLUMNS, 0, 0))
    screen = Screen(COLUMNS, LINES)
    stream = pyte.ByteStream(screen)
    end = time.time() + PATIENCE
    while time.time() < end:
        ready, _, _ = select.select([terminal], [], [], STILL)
        if not ready and shows(screen):
            break
        try:
            stream.feed(os.read(terminal, 1 << 16) if ready else b"")
        except OSError:
            break
    os.kill(child, signal.SIGHUP)
    os.close(terminal)
    os.waitpid(child, 0)
    with open(out, "w", encoding="utf-8") as file:
        file.write(page(screen))
    if not shows(screen):
        sys.exit("the screen shows no message:\n" + "\n".join(screen.display))
    colours = {screen.buffer[row][column].fg for row in range(LINES) for column in range(COLUMNS)}
    if len(colours) < 5:
        sys.exit(f"the screen has the colours {colours} alone")


main()
