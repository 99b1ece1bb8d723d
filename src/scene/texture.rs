//! Colour that varies over a surface.

use crate::asset::Image;
use crate::color::Rgb;
use crate::math::{DVec2, DVec3};
use serde::Serialize;

/// Index into [`super::Scene::textures`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct TextureId(pub u32);

/// Index into [`super::Scene::images`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct ImageId(pub u32);

/// Index into [`super::Scene::frames`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct FrameId(pub u32);

/// One colour, or a texture's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Paint {
    /// The same everywhere.
    Plain(Rgb),
    /// By place.
    Texture(TextureId),
}

/// A colour for each point of a surface. Lengths are in metres of the thing's own space, before it is placed: a
/// texture moves, turns and grows with its thing.
///
/// All but images fill that space, and a surface shows what it cuts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Texture {
    /// Cubes of edge `size` that alternate, with corners at whole multiples of it: `a` where the three
    /// coordinates, divided by `size` and rounded down, have an even sum.
    Checker {
        /// Of the cube from the origin towards +x, +y and +z.
        a: Paint,
        /// Of its neighbours.
        b: Paint,
        /// Edge length, above 0.
        size: f64,
    },
    /// Layers that alternate, with borders at whole multiples of `width`.
    Stripes {
        /// Of the layer from the origin in the direction of `along`.
        a: Paint,
        /// Of its neighbours.
        b: Paint,
        /// Of one layer, above 0.
        width: f64,
        /// Unit vector across the layers.
        along: DVec3,
    },
    /// Clouds: a mixture of two colours by fractal gradient noise.
    Noise {
        /// Where the noise is low.
        a: Paint,
        /// Where it is high.
        b: Paint,
        /// Of the largest clouds, above 0.
        size: f64,
        /// How many times finer clouds, each half the size of the last, are added; at least 1.
        octaves: u32,
        /// Chooses the clouds.
        seed: u64,
    },
    /// A picture that lies on the surface.
    Image {
        /// Which.
        image: ImageId,
        /// Width and height of one copy where it lies flat.
        size: DVec2,
    },
}

/// How a picture lies on a flat face with this unit normal, in the space of the texture: to its right, and up. It is
/// upright seen from outside; up in it is +y, or where the face looks up or down −z and +z, as on a map.
pub fn upright(n: DVec3) -> (DVec3, DVec3) {
    let level = n.x.abs().max(n.z.abs()) < 1e-9;
    let up = if level { DVec3::new(0.0, 0.0, -n.y.signum()) } else { (DVec3::Y - n.y * n).normalize() };
    (up.cross(n), up)
}

impl super::Scene {
    /// What a paint is on the mean: of a picture that of its pixels, of two colours halfway.
    pub fn mean(&self, paint: Paint) -> Rgb {
        self.fold(paint, Image::mean, |a, b| 0.5 * (a + b))
    }

    /// No point of a paint has a channel above this colour's.
    pub fn peak(&self, paint: Paint) -> Rgb {
        self.fold(paint, |image| Rgb::splat(image.peak()), Rgb::max)
    }

    fn fold(&self, paint: Paint, of: fn(&Image) -> Rgb, join: fn(Rgb, Rgb) -> Rgb) -> Rgb {
        let id = match paint {
            Paint::Plain(color) => return color,
            Paint::Texture(id) => id,
        };
        match self.textures[id.0 as usize] {
            Texture::Checker { a, b, .. } | Texture::Stripes { a, b, .. } | Texture::Noise { a, b, .. } => {
                join(self.fold(a, of, join), self.fold(b, of, join))
            }
            Texture::Image { image, .. } => of(&self.images[image.0 as usize]),
        }
    }
}

impl From<Rgb> for Paint {
    fn from(color: Rgb) -> Paint {
        Paint::Plain(color)
    }
}
