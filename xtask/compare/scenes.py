"""The scenes that are compared, and with whom."""

import os

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))


class Scene:
    """A scene, and how it is rendered.

    `reference` is the samples of the picture that errors are told against; 0 where no peer's errors are told. `box`
    gives it that filter: others share samples between pixels by wider ones, and errors would not say the same.
    """

    def __init__(self, name, path, samples, size=None, sets=(), peers=(), reference=0, export=(), box=False):
        self.name, self.path, self.samples, self.size = name, path, samples, size
        self.sets, self.peers, self.reference = list(sets), list(peers), reference
        self.export, self.box = list(export), box


def example(name):
    return os.path.join(ROOT, "examples", name)


def own(name):
    return os.path.join(HERE, name)


LLVM, SCALAR, POVRAY = "llvm_ad_rgb", "scalar_rgb", "povray"
ROOM = os.path.join(ROOT, "tests/references/room.rt")
NEAR = ["--approximate"]

SCENES = [
    Scene("room", ROOM, 64, size="640x480", peers=[LLVM], reference=1024),
    Scene(
        "balls-1000",
        own("balls.rt"),
        16,
        sets=["count=1000"],
        peers=[POVRAY, LLVM],
        reference=256,
        export=NEAR,
    ),
    # Mitsuba's own spheres, one by one: with LLVM a hundred thousand take a minute and 4 GB, and a million more memory
    # than there is.
    *(
        Scene(
            f"balls-{count}",
            own("balls.rt"),
            16,
            sets=[f"count={count}"],
            peers=[POVRAY, SCALAR],
            export=NEAR,
        )
        for count in (100_000, 1_000_000)
    ),
    Scene(
        "hyperboloids",
        own("hyperboloids.rt"),
        16,
        peers=[POVRAY, LLVM],
        reference=256,
        export=[*NEAR, "--tessellate", "64"],
    ),
    Scene(
        "sphereflake",
        example("sphereflake.rt"),
        16,
        size="640x480",
        peers=[LLVM],
        reference=256,
        export=NEAR,
        box=True,
    ),
    Scene(
        "one-weekend",
        example("one-weekend.rt"),
        10,
        size="400x225",
        peers=[LLVM],
        reference=512,
        export=NEAR,
        box=True,
    ),
    Scene("lights", own("lights.rt"), 16, size="320x240", peers=[LLVM], reference=512, export=NEAR),
]
