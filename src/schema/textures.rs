//! What the functions that make textures take, in order; each may also be named.

use super::{ANY, Field, Int, Length, POSITIVE, Paint, Preset, Text, Typed, Vector, within};
use Preset::{Required, Value};

const fn paint(name: &'static str, doc: &'static str) -> Field {
    Field { name, ty: Paint::TYPE, default: Required, range: ANY, doc }
}

const fn length(name: &'static str, default: Preset, doc: &'static str) -> Field {
    Field { name, ty: Length::TYPE, default, range: POSITIVE, doc }
}

/// Of `checker`.
pub const CHECKER: &[Field] = &[
    paint("a", "Of the cube from the origin towards +x, +y and +z."),
    paint("b", "Of its neighbours."),
    length("size", Required, "Edge of a cube."),
];

/// Of `stripes`.
pub const STRIPES: &[Field] = &[
    paint("a", "Of the stripe from the origin in the direction of `along`."),
    paint("b", "Of its neighbours."),
    length("width", Required, "Of one stripe."),
    Field {
        name: "along",
        ty: Vector::TYPE,
        default: Value("(1, 0, 0)"),
        range: ANY,
        doc: "The direction in which stripes follow each other. Need not be of length 1.",
    },
];

/// Of `noise`.
pub const NOISE: &[Field] = &[
    paint("a", "Where the noise is low."),
    paint("b", "Where it is high."),
    length("size", Required, "Of the largest clouds."),
    Field {
        name: "octaves",
        ty: Int::TYPE,
        default: Value("4"),
        range: within(1.0, 16.0),
        doc: "How many sizes of clouds are added, each half the last in size and in strength.",
    },
    Field {
        name: "seed",
        ty: Int::TYPE,
        default: Value("0"),
        range: within(0.0, 9_007_199_254_740_991.0),
        doc: "Chooses the clouds.",
    },
];

/// Of `image`.
pub const IMAGE: &[Field] = &[
    Field {
        name: "file",
        ty: Text::TYPE,
        default: Required,
        range: ANY,
        doc: "A PNG, JPEG, WebP, HDR or EXR; its path from the folder of this file.",
    },
    length("size", Value("1m"), "Width of one copy where it lies flat; the height follows."),
];
