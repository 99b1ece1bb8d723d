//! From scene to film; cannot fail.
//!
//! ```text
//! Tracer::new ──▶ prepass ──▶ render: passes of samples × tiles of pixels ──▶ film
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`lanes`], [`level`] | several paths at once on whatever vector instructions there are |
//! | `vector`, `functions`, `space` | vectors, polynomials, and the coordinates of the tracer |
//! | [`shape`], [`exact`] | where rays meet surfaces, without epsilons: in lanes, or one by one in double precision |
//! | `surfaces`, `accel` | which surface they meet first |
//! | `camera`, [`sampler`], `warp` | rays of camera paths; random numbers; directions drawn from them |
//! | [`bsdf`], `materials`, `texture` | how surfaces scatter light, and their colour by place |
//! | [`light`] | where light comes from |
//! | [`media`] | which dielectric a path is inside of |
//! | `caustic` | light that comes by mirrors and glass |
//! | `path`, `queue`, `jobs` | paths, step by step, and those that wait for a lane |
//! | [`observer`] | watching paths |
//! | [`apart`] | a pixel taken apart: light by light, and by kinds of paths |
//! | [`first`] | what camera rays meet first |
//! | [`feedback`] | what many paths did, all over a picture |
//! | [`film`], `sums` | exact sums |
//! | `prepass` | exposure and the film's scale |
//! | [`shares`] | how much of the light is of which lamp |
//! | [`halt`] | when there are enough samples, and where too few |
//! | [`making`] | a picture in the making, and going on with it |
//! | [`control`] | cancelling and progress |
//! | `stray` | rays without pictures, to measure |
//!
//! Set-up is done in double precision in the world; paths are traced in single precision, see [`shape`] for why that is
//! enough. `tests/oracle` holds an integrator that shares none of this, in double precision, to compare with.
//!
//! The same scene gives the same bits on every processor, for any number of lanes and threads, and a window the same bits as that part of the
//! whole: random numbers are a function of pixel and sample, and sums are exact.

mod accel;
pub mod apart;
pub mod bsdf;
mod camera;
mod caustic;
pub mod control;
pub mod exact;
pub mod feedback;
pub mod film;
pub mod first;
mod functions;
pub mod halt;
mod jobs;
pub mod lanes;
pub mod level;
pub mod light;
pub mod making;
mod materials;
pub mod media;
pub mod observer;
mod path;
mod prepass;
mod queue;
pub mod sampler;
pub mod shape;
pub mod shares;
mod space;
mod surfaces;
#[cfg(test)]
mod tests;
mod stray;
mod sums;
pub mod texture;
mod vector;
mod warp;

use crate::asset::Mesh;
use crate::color::Rgb;
use crate::math::{DVec3, exp2, ln};
use crate::scene::{Light, Material, Paint, PrimitiveId, Scene, Shape, Tonemap};
use apart::Sampled;
use bsdf::Bsdfs;
use camera::Eye;
use caustic::Caustics;
pub use control::{Cancelled, Control, Progress};
use exact::SurfacePoint;
use film::Pixel;
pub use film::{Film, Window};
use halt::Limit;
use jobs::{Glimpse, Single, Tile};
use lanes::{Lanes, Mask, One, Word};
pub use level::Level;
use light::Lights;
use materials::Materials;
use media::Dielectrics;
pub use observer::Observer;
use path::Sharing;
pub use prepass::Prepass;
use queue::{Jobs, View};
use rayon::prelude::*;
use shape::{Face, Hits, Points, decode, slot};
use space::Space;
use std::collections::BTreeMap;
pub use stray::Strays;
use sums::Sums;
use surfaces::Surfaces;

/// A scene, ready to be traced.
pub struct Tracer<'s> {
    scene: &'s Scene,
    space: Space,
    /// Radiance in a unit of the tracer's, a power of two.
    unit: f64,
    surfaces: Surfaces,
    materials: Materials,
    lights: Lights,
    dielectrics: Dielectrics<'s>,
    eye: Eye,
    /// How far away things are from the camera in metres, most typically.
    size: f64,
    caustics: Caustics,
    /// Whether caustics were looked for.
    aware: bool,
    sharing: Sharing,
    level: Level,
    keeps_structure: bool,
}

/// What rays are tested against, and what photons found, kept for another scene: see [`Tracer::at_once`].
pub struct Structure {
    surfaces: Surfaces,
    materials: Vec<Material>,
    /// With the hash of the scene that they are of.
    caustics: Option<(blake3::Hash, Caustics)>,
}

/// A finished film.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The sums.
    pub film: Film,
    /// The most samples of a pixel.
    pub samples: u32,
    /// How many pixels have on average.
    pub mean_samples: f64,
    /// The noise reached, as a ratio of white: see [`Film::noise`].
    pub noise: f64,
    /// What it stopped at.
    pub limit: Limit,
    /// Whether there is as little noise as was wanted.
    pub target_met: bool,
}

/// About how many bytes it takes to trace the whole of a scene: its surfaces, its meshes, each counted once, the
/// hierarchies over them while they are built, the film, and the picture that is made of it.
pub fn memory(scene: &Scene) -> u64 {
    let surfaces = scene.primitives.len() as u64;
    let surface =
        (size_of::<crate::scene::Primitive>() + accel::BYTES_A_SURFACE + surfaces::BYTES_A_SURFACE) as u64;
    // A pass over the picture is held beside the sums that it is added to.
    let pixel = (2 * size_of::<Pixel>() + size_of::<Rgb>()) as u64;
    let [width, height] = scene.trace.size.map(u64::from);
    let meshes: BTreeMap<[u8; 32], &Mesh> = scene
        .primitives
        .iter()
        .filter_map(|p| mesh_of(&p.shape))
        .map(|m| (*m.hash().as_bytes(), m))
        .collect();
    let mesh = |mesh: &Mesh| (mesh.bytes() + mesh.len() * exact::BYTES_A_THING) as u64;
    let meshes: u64 = meshes.into_values().map(mesh).sum();
    surfaces * surface + meshes + width * height * pixel
}

fn mesh_of(shape: &Shape) -> Option<&Mesh> {
    match shape {
        Shape::Mesh(instance) => Some(&instance.mesh),
        _ => None,
    }
}

/// How the film will be shown, which is what a noise target speaks of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Exposure in stops.
    pub stops: f64,
    /// The curve from scene to display.
    pub tonemap: Tonemap,
}

/// Pixels along the side of a tile.
const TILE: u32 = 16;
/// Samples of a pixel in one pass over the picture.
pub const PASS: u32 = 64;

impl<'s> Tracer<'s> {
    /// Builds what tracing needs: hierarchy, tables of lights and coats.
    pub fn new(scene: &'s Scene) -> Tracer<'s> {
        let mut tracer = Tracer::at_once(scene, None);
        tracer.caustics = Caustics::new(&tracer, &Control::new()).unwrap_or_default();
        tracer.aware = true;
        tracer
    }

    /// The same in less time, for a first look: caustics are left to luck until [`Tracer::find_caustics`]. Keeps of the
    /// structure of an earlier scene what fits: see [`Tracer::keeps_structure`].
    pub fn at_once(scene: &'s Scene, structure: Option<Structure>) -> Tracer<'s> {
        let size = size(scene);
        let space = Space::new(scene.camera.position, size);
        let unit = radiance_unit(peak(scene));
        let (mut kept, mut caustics) = (None, None);
        if let Some(before) = structure {
            kept = before.surfaces.kept(&before.materials, scene, &space);
            caustics = before.caustics.filter(|(hash, _)| *hash == scene.hash());
        }
        let keeps_structure = kept.is_some();
        let surfaces = kept.unwrap_or_else(|| Surfaces::new(scene, &space));
        let mut tracer = Tracer {
            scene,
            materials: Materials::new(scene, &surfaces, unit),
            lights: Lights::new(scene, &surfaces, &space, unit),
            surfaces,
            eye: Eye::new(scene, &space),
            space,
            unit,
            dielectrics: Dielectrics::new(scene),
            size,
            aware: caustics.is_some(),
            caustics: caustics.map(|(_, caustics)| caustics).unwrap_or_default(),
            sharing: Sharing::Both,
            level: Level::best(),
            keeps_structure,
        };
        tracer.aware |= !caustic::may_be(&tracer);
        tracer
    }

    /// Whether it is known where caustics come from: see [`Tracer::find_caustics`].
    pub fn knows_caustics(&self) -> bool {
        self.aware
    }

    /// Sends the photons by which caustics are looked for, unless that was done.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn find_caustics(&mut self, control: &Control) -> Result<(), Cancelled> {
        if !self.aware {
            self.caustics = Caustics::new(self, control)?;
            self.aware = true;
        }
        Ok(())
    }

    /// Whether surfaces are where they were in the scene before, so that its structure could be kept.
    pub fn keeps_structure(&self) -> bool {
        self.keeps_structure
    }

    /// What rays are tested against, for another scene that may have its surfaces in the same places.
    pub fn into_structure(self) -> Structure {
        let caustics = self.aware.then(|| (self.scene.hash(), self.caustics));
        Structure { surfaces: self.surfaces, materials: self.scene.materials.clone(), caustics }
    }

    /// Leaves caustics to luck: the same picture on average, but for light of points, which luck never finds.
    pub fn by_luck(self) -> Tracer<'s> {
        Tracer { caustics: Caustics::default(), ..self }
    }

    /// Traces on certain vector instructions, photons too, or if the processor has them not on the best it has below. The
    /// picture is the same.
    pub fn on(self, level: Level) -> Tracer<'s> {
        let mut tracer = Tracer { level, ..self };
        if !tracer.caustics.is_empty() {
            tracer.caustics = Caustics::new(&tracer, &Control::new()).unwrap_or_default();
        }
        tracer
    }

    /// Takes a first look, for exposure and the film's scale.
    pub fn prepass(&self) -> Prepass {
        prepass::prepass(self)
    }

    /// Adds a range of samples to every pixel of a film.
    ///
    /// # Errors
    ///
    /// If the control cancels; the film then holds some of them.
    pub fn add_samples(
        &self,
        film: &mut Film,
        samples: std::ops::Range<u32>,
        control: &Control,
    ) -> Result<(), Cancelled> {
        self.add_samples_in(&[film.window()], film, samples, control)
    }

    /// The same for some windows of the film, which do not overlap. Up to [`PASS`] samples come all or not at all.
    ///
    /// # Errors
    ///
    /// If the control cancels; the film then holds some of them.
    pub fn add_samples_in(
        &self,
        windows: &[Window],
        film: &mut Film,
        samples: std::ops::Range<u32>,
        control: &Control,
    ) -> Result<(), Cancelled> {
        let pixels: u64 = windows.iter().map(|window| window.pixels() as u64).sum();
        control.plan(pixels * u64::from(samples.end - samples.start));
        self.trace_step(Sums { film, early: None }, windows, samples, control)
    }

    /// The same for paths that have been planned.
    fn trace_step(
        &self,
        mut sums: Sums,
        windows: &[Window],
        samples: std::ops::Range<u32>,
        control: &Control,
    ) -> Result<(), Cancelled> {
        let tiles: Vec<Window> = windows.iter().flat_map(|window| window.tiles(TILE)).collect();
        let scale = sums.film.scale();
        let view = View::new(&self.eye, self.scene.trace.seed);
        for start in samples.clone().step_by(PASS as usize) {
            let pass = start..samples.end.min(start + PASS);
            let cuts = sums.cuts(pass.end);
            let traced: Vec<Vec<Pixel>> = tiles
                .par_iter()
                .map(|tile| {
                    // A tile asks only after its first pixel, and there may be thousands.
                    if control.is_cancelled() {
                        return Vec::new();
                    }
                    let mut jobs = Tile::new(*tile, pass.clone(), cuts, (scale, self.unit), control);
                    self.trace(&view, &mut jobs);
                    jobs.pixels
                })
                .collect();
            if control.is_cancelled() {
                return Err(Cancelled);
            }
            for (tile, pixels) in tiles.iter().zip(traced) {
                sums.add(*tile, &pixels, pass.start, cuts);
            }
        }
        Ok(())
    }

    /// The first sample of every pixel whose column and row are multiples of `step` from half a step on, row by row: a
    /// first look at a picture. Nothing where it meets nothing in front of a transparent background.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn look(&self, step: u32, control: &Control) -> Result<Vec<Option<Rgb>>, Cancelled> {
        let [_, height] = self.scene.trace.size;
        let view = View::new(&self.eye, self.scene.trace.seed);
        let rows: Vec<Vec<Option<Rgb>>> = (0..height.div_ceil(step))
            .into_par_iter()
            .map(|row| {
                let mut row = Glimpse::new(row, step, self.scene.trace.size, self.unit, control);
                self.trace(&view, &mut row);
                row.radiance
            })
            .collect();
        if control.is_cancelled() { Err(Cancelled) } else { Ok(rows.concat()) }
    }

    /// What one sample adds to its pixel, watched. Traced in one lane, to the same bits as in many.
    pub fn sample<O: Observer>(&self, x: u32, y: u32, sample: u32, observer: &mut O) -> Sampled {
        let mut single = Single::new(x, y, sample, self.unit);
        let view = View::new(&self.eye, self.scene.trace.seed);
        path::trace(One, self, &view, &mut single, observer);
        single.sampled
    }

    /// Traces paths on the tracer's level.
    fn trace(&self, view: &View, jobs: &mut dyn Jobs) {
        self.level.run(Trace { tracer: self, view, jobs });
    }

    /// The materials of what was met in the lanes of a mask, their colours by place.
    #[inline(always)]
    fn bsdfs<L: Lanes>(&self, l: L, hits: &Hits<L>, points: &Points<L>, met: L::M) -> Bsdfs<L> {
        let (mut bsdfs, painted) = self.materials.at(l, hits.place, met);
        for lane in painted.lanes() {
            let (p, n) = (self.space.world(points.p, lane), space::double(points.n, lane));
            let shown = self.painted(&hits.lane(lane), p, n);
            let base = bsdfs.color.get(lane);
            bsdfs.color.set(lane, [base[0] * shown[0], base[1] * shown[1], base[2] * shown[2]]);
        }
        bsdfs
    }

    /// The colour that the texture of what was met shows at a point of it.
    fn painted(&self, hit: &Hits<One>, p: DVec3, n: DVec3) -> [f32; 3] {
        let place = hit.place.get(0);
        let id = self.surfaces.primitive(slot(place));
        self.pattern(id, decode(place, hit.detail.get(0)), &SurfacePoint::new(p, n))
    }

    /// The colour that the texture of a primitive shows at a point of it.
    fn pattern(&self, id: PrimitiveId, face: Face, point: &SurfacePoint) -> [f32; 3] {
        let primitive = &self.scene.primitives[id.0 as usize];
        let Some(texture) = self.scene.material(primitive).texture() else { return [1.0; 3] };
        let spot = texture::Spot::new(self.scene, primitive, face, point);
        vector::single(texture::paint(self.scene, Paint::Texture(texture), &spot))
    }

    /// The point of a sphere next to one that lies on it but for rounding.
    fn sphere_point(&self, id: PrimitiveId, near: DVec3) -> SurfacePoint {
        match self.scene.primitives[id.0 as usize].shape {
            Shape::Sphere { center, radius } => {
                let n = (near - center).normalize();
                SurfacePoint::new(center + radius * n, n)
            }
            _ => SurfacePoint::new(near, DVec3::Y),
        }
    }

    /// The radiance of the brightest thing there is, in its brightest channel.
    fn peak(&self) -> f64 {
        peak(self.scene)
    }
}

/// Paths to trace in lanes.
struct Trace<'a, 's> {
    tracer: &'a Tracer<'s>,
    view: &'a View<'a>,
    jobs: &'a mut dyn Jobs,
}

impl level::Task for Trace<'_, '_> {
    type Output = ();
    fn run<L: Lanes>(self, l: L) {
        path::trace(l, self.tracer, self.view, self.jobs, &mut ());
    }
}

/// The radiance of the brightest thing there is, in its brightest channel; of a point its intensity.
fn peak(scene: &Scene) -> f64 {
    let glowing = scene.materials.iter().map(|material| match material {
        Material::Emitter { radiance, pattern } => {
            let share = pattern.map_or(Rgb::ONE, |id| scene.peak(Paint::Texture(id)));
            (*radiance * share).max_element()
        }
        _ => 0.0,
    });
    let lights = scene.lights.iter().map(|light| match *light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity.max_element(),
        Light::Sun { irradiance, radius, .. } => {
            let sine = crate::math::sin(radius);
            let disc = if sine > 0.0 { crate::math::PI * sine * sine } else { 1.0 };
            irradiance.max_element() / disc
        }
        Light::Sky { radiance, panorama } => {
            let share = panorama.map_or(1.0, |panorama| scene.images[panorama.image.0 as usize].peak());
            radiance.max_element() * share
        }
    });
    glowing.chain(lights).fold(0.0, f64::max)
}

/// The power of two next above the brightest, or 1 without light.
fn radiance_unit(peak: f64) -> f64 {
    if peak > 0.0 { exp2((ln(peak) / std::f64::consts::LN_2).ceil().clamp(-1000.0, 1000.0)) } else { 1.0 }
}

/// How far away things are from the camera, most typically.
fn size(scene: &Scene) -> f64 {
    let eye = scene.camera.position;
    let distance = |shape: &Shape| match shape {
        Shape::Sphere { center, radius } => (center.distance(eye) - radius).abs(),
        Shape::Plane { point, normal } => normal.dot(*point - eye).abs(),
        Shape::Quadric(quadric) => quadric.world_from_object.translation.distance(eye),
        shape => shape.bounds().map_or(0.0, |bounds| bounds.center().distance(eye)),
    };
    let mut sizes: Vec<f64> = scene.primitives.iter().map(|primitive| distance(&primitive.shape)).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let middle = sizes.len() / 2;
    *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
}
