//! An integrator to hold the tracer's against: one path at a time, in double precision, as readable as it gets.
//!
//! It shares with the tracer what a scene is, colours and mathematics, the handle that stops it, and the hierarchy of
//! boxes, which a test here holds to a list; nothing else: not the sampler, the film, the equations of surfaces, nor how
//! light is found. So where the two agree, neither errs alone. It was written first; where
//! the tracer learns something new, this learns it too, in its own way.
//!
//! ```text
//! Tracer::new ──▶ prepass ──▶ render: passes of samples × tiles of pixels ──▶ film
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`shape`] | where a ray meets a surface, without epsilons |
//! | `accel` | which surface it meets first |
//! | `camera`, [`sampler`], `warp` | rays of camera paths; random numbers; directions drawn from them |
//! | [`texture`] | what colour they have at a point |
//! | [`bsdf`] | how surfaces scatter light |
//! | [`light`] | where light comes from |
//! | [`media`] | which dielectric a path is inside of |
//! | `integrator` | one path: the contract of any faster one |
//! | [`observer`] | watching paths |
//! | [`film`] | exact sums |
//! | `prepass` | exposure and the film's scale |
//!
//! The same scene gives the same bits for any number of threads, and a window the same bits as that part of the
//! whole: random numbers are a function of pixel and sample, and sums are exact.

#![allow(dead_code, reason = "it is a whole renderer, of which tests use what they need")]

mod accel;
pub mod bsdf;
mod camera;
pub mod film;
mod integrator;
pub mod light;
pub mod media;
pub mod observer;
mod prepass;
pub mod sampler;
pub mod shape;
pub mod texture;

#[cfg(test)]
mod tests;
mod warp;

use accel::Accel;
use bsdf::{Bsdf, Coat};
use camera::Eye;
pub use film::{Film, Window};
use film::{MOST_SAMPLES, Pixel};
use integrator::{Arrived, Scratch, Sharing};
use light::Lights;
use media::{Boundary, Dielectrics, Inside};
pub use observer::Observer;
pub use prepass::Prepass;
use rayon::prelude::*;
use rt_lang::color::Rgb;
pub use rt_lang::render::{Cancelled, Control, Progress};
use rt_lang::scene::{Material, Paint, Scene, Target, Tonemap};
use sampler::Sampler;
use shape::{Place, Ray, SurfacePoint};

/// A scene, ready to be traced.
pub struct Tracer<'s> {
    scene: &'s Scene,
    accel: Accel<'s>,
    eye: Eye<'s>,
    lights: Lights,
    dielectrics: Dielectrics<'s>,
    /// Coats of plastics, and for each material which one it has.
    coats: Vec<Coat>,
    coat_of: Vec<usize>,
    sharing: Sharing,
}

/// A finished film.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The sums.
    pub film: Film,
    /// Samples of each pixel.
    pub samples: u32,
    /// The noise reached, as a ratio of white: see [`Film::noise`].
    pub noise: f64,
    /// Whether the target was met: false only where a noise target was not, with [`MOST_NOISE_SAMPLES`].
    pub target_met: bool,
}

/// How the film will be shown, which is what a noise target speaks of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Exposure in stops.
    pub stops: f64,
    /// The curve from scene to display.
    pub tonemap: Tonemap,
}

/// Samples a pixel at which a noise target is first judged.
pub const FIRST_NOISE_SAMPLES: u32 = 16;
/// Samples a pixel at which a noise target is given up.
pub const MOST_NOISE_SAMPLES: u32 = 1 << 16;

/// Pixels along the side of a tile.
const TILE: u32 = 16;
/// Samples of a pixel in one pass over the picture.
const PASS: u32 = 64;

impl<'s> Tracer<'s> {
    /// Builds what tracing needs: hierarchy, tables of lights and coats.
    pub fn new(scene: &'s Scene) -> Tracer<'s> {
        let mut coats: Vec<Coat> = Vec::new();
        let coat_of = scene.materials.iter().map(|material| coat_index(&mut coats, material)).collect();
        Tracer {
            scene,
            accel: Accel::new(&scene.primitives),
            eye: Eye::new(scene),
            lights: Lights::new(scene),
            dielectrics: Dielectrics::new(scene),
            coats,
            coat_of,
            sharing: Sharing::Both,
        }
    }

    /// Takes a first look, for exposure and the film's scale.
    pub fn prepass(&self) -> Prepass {
        prepass::prepass(self)
    }

    /// Traces a window of the picture on the current rayon pool.
    ///
    /// A noise target is judged on the window: samples are doubled until 99 of 100 of its pixels keep it, so a
    /// crop may stop at another number of samples than the whole.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn render(
        &self,
        window: Window,
        target: Target,
        prepass: &Prepass,
        shown: Shown,
        control: &Control,
    ) -> Result<Rendered, Cancelled> {
        let mut film = Film::new(window, prepass.scale);
        let (mut samples, most, wanted) = match target {
            Target::Samples(n) => (n.clamp(1, MOST_SAMPLES), n, 1.0),
            Target::Noise(noise) => (FIRST_NOISE_SAMPLES, MOST_NOISE_SAMPLES, noise),
        };
        let mut done = 0;
        loop {
            self.add_samples(&mut film, done..samples, control)?;
            let noise = film.noise(shown.stops, shown.tonemap);
            let target_met = matches!(target, Target::Samples(_)) || noise <= wanted;
            if target_met || samples >= most {
                return Ok(Rendered { film, samples, noise, target_met });
            }
            done = samples;
            samples *= 2;
        }
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
        let tiles: Vec<Window> = film.window().tiles(TILE).collect();
        let scale = film.scale();
        control.plan(film.window().pixels() as u64 * u64::from(samples.end - samples.start));
        for start in samples.clone().step_by(PASS as usize) {
            let pass = start..samples.end.min(start + PASS);
            let traced: Result<Vec<Vec<Pixel>>, Cancelled> = tiles
                .par_iter()
                .map(|tile| self.trace_tile(*tile, pass.clone(), scale, control, &mut ()))
                .collect();
            for (tile, pixels) in tiles.iter().zip(traced?) {
                film.merge_pixels(*tile, &pixels);
            }
        }
        Ok(())
    }

    /// The radiance that one sample adds to its pixel, watched.
    pub fn sample<O: Observer>(&self, x: u32, y: u32, sample: u32, observer: &mut O) -> Rgb {
        let (arrived, weight) = self.trace_sample(x, y, sample, &mut Scratch::default(), observer);
        weight * arrived.radiance
    }

    fn trace_tile<O: Observer>(
        &self,
        tile: Window,
        samples: std::ops::Range<u32>,
        scale: f64,
        control: &Control,
        observer: &mut O,
    ) -> Result<Vec<Pixel>, Cancelled> {
        let mut pixels = Vec::with_capacity(tile.pixels());
        let mut scratch = Scratch::default();
        for y in tile.y..tile.y + tile.height {
            for x in tile.x..tile.x + tile.width {
                let mut pixel = Pixel::default();
                for sample in samples.clone() {
                    if control.is_cancelled() {
                        return Err(Cancelled);
                    }
                    let (arrived, weight) = self.trace_sample(x, y, sample, &mut scratch, observer);
                    pixel.add(weight * arrived.radiance, scale);
                    pixel.cover(arrived.open, weight);
                }
                pixels.push(pixel);
            }
            control.finish(u64::from(tile.width) * u64::from(samples.end - samples.start));
        }
        Ok(pixels)
    }

    /// What a sample brings, and its weight in its pixel.
    fn trace_sample<O: Observer>(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        scratch: &mut Scratch,
        observer: &mut O,
    ) -> (Arrived, f64) {
        let trace = &self.scene.trace;
        let sampler = Sampler::new(trace.seed, x, y, sample);
        let (ray, weight) = self.eye.ray(x, y, trace.size, &sampler);
        (integrator::trace(self, ray, &sampler, scratch, observer), weight)
    }

    /// What a surface does at a point, or none where it does nothing.
    fn bsdf(
        &self,
        material: &Material,
        place: Place,
        point: &SurfacePoint,
        inside: &Inside,
        entering: bool,
    ) -> Option<Bsdf<'_>> {
        let paint = |paint: Paint| self.paint(paint, place, point);
        Some(match *material {
            Material::Diffuse { color } => Bsdf::Diffuse(paint(color)),
            Material::Mirror { color } => Bsdf::Mirror(paint(color)),
            Material::Dielectric { alpha, .. } => {
                match self.dielectrics.boundary(inside, place.primitive, entering) {
                    Boundary::Nothing => return None,
                    Boundary::Interface(eta) => Bsdf::Dielectric { eta, alpha },
                }
            }
            Material::Metal { color, alpha } => Bsdf::Metal { color: paint(color), alpha },
            Material::Plastic { color, .. } => {
                let id = self.scene.primitives[place.primitive.0 as usize].material;
                Bsdf::Plastic { color: paint(color), coat: &self.coats[self.coat_of[id.0 as usize]] }
            }
            Material::Emitter { .. } => return None,
        })
    }

    /// The colour of a paint at a point of a surface.
    fn paint(&self, paint: Paint, place: Place, point: &SurfacePoint) -> Rgb {
        match paint {
            Paint::Plain(color) => color,
            Paint::Texture(_) => {
                let primitive = &self.scene.primitives[place.primitive.0 as usize];
                let spot = texture::Spot::new(self.scene, primitive, place.face, point);
                texture::paint(self.scene, paint, &spot)
            }
        }
    }

    /// What a surface radiates at a point, if it glows. Whether on this side is not asked.
    fn glow(&self, place: Place, point: &SurfacePoint) -> Option<Rgb> {
        match *self.scene.material(&self.scene.primitives[place.primitive.0 as usize]) {
            Material::Emitter { radiance, pattern: None } => Some(radiance),
            Material::Emitter { radiance, pattern: Some(id) } => {
                Some(radiance * self.paint(Paint::Texture(id), place, point))
            }
            _ => None,
        }
    }

    /// Whether a ray meets the surface that it starts on again, below a distance.
    fn meets(&self, ray: &Ray, distance: f64) -> bool {
        ray.start.is_some_and(|start| {
            self.accel.intersect(start.primitive, ray, Some(start.face)).is_some_and(|(t, _)| t < distance)
        })
    }

    /// The radiance of the brightest thing there is, in its brightest channel.
    fn peak(&self) -> f64 {
        let glowing = self.scene.materials.iter().map(|material| match material {
            Material::Emitter { radiance, pattern } => {
                let share = pattern.map_or(Rgb::ONE, |id| self.scene.peak(Paint::Texture(id)));
                (*radiance * share).max_element()
            }
            _ => 0.0,
        });
        glowing.chain([self.lights.peak()]).fold(0.0, f64::max)
    }
}

/// The place of a material's coat among those that are made, made if need be; any for what is no plastic.
fn coat_index(coats: &mut Vec<Coat>, material: &Material) -> usize {
    let Material::Plastic { ior, alpha, .. } = *material else { return usize::MAX };
    coats.iter().position(|coat| coat.is(ior, alpha)).unwrap_or_else(|| {
        coats.push(Coat::new(ior, alpha));
        coats.len() - 1
    })
}
