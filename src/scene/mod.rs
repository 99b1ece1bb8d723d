//! The scene: the picture with everything resolved, in its simplest form.
//!
//! What that means, and what a reader of it may rely on:
//!
//! - No names, units, prototypes, groups or defaults are left: every number is finite, in metres, radians and
//!   watts, in world space; colours are linear RGB with sRGB's primaries; every reflectance is in [0, 1].
//! - Things lie in flat vectors and refer to each other by typed ids that are in range.
//! - A closed solid is oriented: its normals point out. Power has become radiance.
//! - There is exactly one camera, and it looks somewhere. There may be no light at all.
//! - [`Scene::hash`] is canonical: equal scenes have equal hashes, and anything that may change a bit of the
//!   picture's radiance changes it. What only develops the film is in [`Develop`], outside the hash.

pub mod boxes;
pub mod identity;
pub mod nesting;
pub mod shape;
pub mod texture;

pub use crate::asset::Image;
use crate::color::Rgb;
use crate::math::{DAffine3, DMat3, DVec2, DVec3};
pub use crate::schema::{Background, Filter, Tonemap};
use serde::Serialize;
use shape::Placed;
pub use shape::Shape;
use std::sync::Arc;
pub use texture::{FrameId, ImageId, Paint, Texture, TextureId};

/// A whole picture, ready to be traced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Every surface, glowing spheres of lights among them. Shared with what rays are tested against.
    pub primitives: Arc<Vec<Primitive>>,
    /// Materials, each used by at least one primitive.
    pub materials: Vec<Material>,
    /// What materials are painted with. An entry refers only to earlier ones.
    pub textures: Vec<Texture>,
    /// Pictures that textures and the sky show, each once.
    pub images: Vec<Arc<Image>>,
    /// The spaces in which the textures of things lie.
    pub frames: Vec<Placed>,
    /// Lights that are no surface.
    pub lights: Vec<Light>,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// How the picture is traced.
    pub trace: Trace,
    /// How the film becomes a picture.
    #[serde(skip)]
    pub develop: Develop,
}

/// Names a chain of uses in the table of origins that stands beside the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct OriginId(pub u32);

/// Index into [`Scene::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct MaterialId(pub u32);

/// Index into [`Scene::primitives`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct PrimitiveId(pub u32);

/// A surface with its material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Primitive {
    /// The surface.
    pub shape: Shape,
    /// What it is made of.
    pub material: MaterialId,
    /// From the world to the space of its texture; there is one where the material has a texture.
    pub frame: Option<FrameId>,
    /// Which place in the source put it here. Not part of the hash: moving text does not change the picture.
    #[serde(skip)]
    pub origin: OriginId,
}

/// What a surface does with light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Material {
    /// Lambertian.
    Diffuse {
        /// Reflectance (albedo).
        color: Paint,
    },
    /// Perfect specular reflection, the same at every angle.
    Mirror {
        /// Reflectance.
        color: Paint,
    },
    /// Clear or frosted glass, water: refraction by Snell, reflection by Fresnel.
    Dielectric {
        /// Refractive index of the inside relative to the outside's vacuum, above 0.
        ior: f64,
        /// Absorption inside, per metre and channel (Beer–Lambert), 0 to infinity.
        absorption: Rgb,
        /// GGX α = perceptual roughness², in [0, 1]; 0 is smooth.
        alpha: f64,
    },
    /// A conductor: GGX with Schlick's Fresnel.
    Metal {
        /// Reflectance at normal incidence.
        color: Paint,
        /// GGX α in [0, 1]; 0 is a perfect mirror.
        alpha: f64,
    },
    /// A dielectric coat over a Lambertian base, with internal reflection counted.
    Plastic {
        /// Reflectance (albedo) of the base.
        color: Paint,
        /// Refractive index of the coat, at least 1.
        ior: f64,
        /// GGX α of the coat in [0, 1]; 0 is smooth.
        alpha: f64,
    },
    /// Glows, and reflects nothing. A closed shape glows outwards, an open one on both sides.
    Emitter {
        /// Radiance in W/(m²·sr) a channel.
        radiance: Rgb,
        /// What the radiance is multiplied with, place by place.
        pattern: Option<TextureId>,
    },
}

/// A light that is no surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Light {
    /// Radiates evenly from a point.
    Point {
        /// Where.
        position: DVec3,
        /// Radiant intensity in W/sr a channel.
        intensity: Rgb,
    },
    /// Radiates from a point into a cone. With c the cosine of the angle to the axis, the intensity is whole where c
    /// is at least cos `inner`, 0 where it is below cos `outer`, and between the two it follows the smooth step
    /// x²(3 − 2x) of x = (c − cos `outer`) / (cos `inner` − cos `outer`).
    Spot {
        /// Where.
        position: DVec3,
        /// Unit vector along the axis.
        direction: DVec3,
        /// Radiant intensity on the axis, in W/sr a channel.
        intensity: Rgb,
        /// Angle to the axis in radians up to which it is whole, in [0, `outer`].
        inner: f64,
        /// Angle to the axis in radians beyond which there is none, in (0, π].
        outer: f64,
    },
    /// A distant disc.
    Sun {
        /// Unit vector towards the centre of the disc.
        direction: DVec3,
        /// On a surface that faces it, in W/m² a channel.
        irradiance: Rgb,
        /// The disc's angular radius in radians, [0, π/2]; 0 is a point, and then not seen.
        radius: f64,
    },
    /// Radiance from everywhere beyond the scene. There is at most one.
    Sky {
        /// In W/(m²·sr) a channel.
        radiance: Rgb,
        /// What the radiance is multiplied with, direction by direction.
        panorama: Option<Panorama>,
    },
}

/// A picture of all directions: longitude across, latitude down (equirectangular). Seen from inside in its own
/// space, its centre is −z, its top +y, and +x lies to the right of the centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Panorama {
    /// The picture.
    pub image: ImageId,
    /// Turns, and maybe mirrors, directions of the world into the picture's space.
    pub image_from_world: DMat3,
}

/// A camera. `right`, `up` and `forward` are unit vectors at right angles, with
/// right × up = −forward.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Camera {
    /// Whether rays meet in the lens or are parallel.
    pub projection: Projection,
    /// Centre of the lens; of an orthographic camera, of the window that rays start in.
    pub position: DVec3,
    /// To the right in the picture.
    pub right: DVec3,
    /// Upwards in the picture.
    pub up: DVec3,
    /// Into the picture.
    pub forward: DVec3,
    /// Half the width and half the height of the picture. In perspective at distance 1: tangents of the half angles
    /// of view. Of an orthographic camera in metres.
    pub half_extent: DVec2,
    /// Radius of the lens in metres; 0 is a pinhole, and what an orthographic camera has.
    pub lens_radius: f64,
    /// Distance along `forward` of the plane that is sharp.
    pub focus: f64,
}

/// How a camera sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Projection {
    /// Through a thin lens: what is far is small.
    Perspective,
    /// Along parallel rays that start in the plane through the camera's position.
    Orthographic,
}

/// How the picture is traced.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trace {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// When a pixel has enough samples.
    pub target: Target,
    /// Scattering events of a path: 0 shows what glows, 1 adds direct light.
    pub bounces: u32,
    /// Whether light may come by a diffuse or rough surface before it is scattered to the camera.
    pub indirect: bool,
    /// Chooses the random numbers.
    pub seed: u64,
    /// Reconstruction filter of a pixel.
    pub filter: Filter,
    /// What a camera ray sees that meets nothing. Light from beyond the scene lights it all the same.
    pub background: Background,
}

/// When a pixel has enough samples. Not part of the hash: more of them refine the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Target {
    /// So many samples a pixel, at least one.
    Samples(u32),
    /// Samples are doubled until the standard error of the displayed pixels is below this, as a ratio of white.
    Noise(f64),
}

/// How radiance becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Develop {
    /// In stops, 0 maps radiance 1 to white; none is chosen from the scene.
    pub exposure: Option<f64>,
    /// The curve from scene to display.
    pub tonemap: Tonemap,
}

impl Scene {
    /// The canonical hash of everything that radiance depends on, but for the number of samples.
    pub fn hash(&self) -> blake3::Hash {
        let any = Trace { target: Target::Samples(0), ..self.trace };
        let painted = (&self.textures, &self.images, &self.frames);
        let parts = (&self.primitives, &self.materials, painted, &self.lights, &self.camera, any);
        digest(&parts)
    }

    /// The map from the world to the space of a primitive's texture.
    pub fn frame(&self, primitive: &Primitive) -> DAffine3 {
        primitive.frame.map_or(DAffine3::IDENTITY, |id| self.frames[id.0 as usize].object_from_world)
    }

    /// The material of a primitive.
    #[inline]
    pub fn material(&self, primitive: &Primitive) -> &Material {
        &self.materials[primitive.material.0 as usize]
    }
}

/// The canonical hash of a part of a scene.
fn digest(part: &impl Serialize) -> blake3::Hash {
    struct Sink(blake3::Hasher);
    impl postcard::ser_flavors::Flavor for Sink {
        type Output = blake3::Hash;
        fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
            self.try_extend(&[byte])
        }
        fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
            self.0.update(bytes);
            Ok(())
        }
        fn finalize(self) -> postcard::Result<blake3::Hash> {
            Ok(self.0.finalize())
        }
    }
    postcard::serialize_with_flavor(part, Sink(blake3::Hasher::new()))
        .expect("the sink takes everything, and the scene has only sized parts")
}

impl Material {
    /// The name of its kind in the language.
    pub fn kind(&self) -> &'static str {
        match self {
            Material::Diffuse { .. } => "diffuse",
            Material::Mirror { .. } => "mirror",
            Material::Dielectric { .. } => "dielectric",
            Material::Metal { .. } => "metal",
            Material::Plastic { .. } => "plastic",
            Material::Emitter { .. } => "emitter",
        }
    }

    /// The texture it is painted with.
    pub fn texture(&self) -> Option<TextureId> {
        match *self {
            Material::Diffuse { color }
            | Material::Mirror { color }
            | Material::Metal { color, .. }
            | Material::Plastic { color, .. } => match color {
                Paint::Plain(_) => None,
                Paint::Texture(id) => Some(id),
            },
            Material::Emitter { pattern, .. } => pattern,
            Material::Dielectric { .. } => None,
        }
    }
}
