//! What a picture shows besides its light, as channels beside it: depth, normals, colours, noise, and which things.
//!
//! All but noise and samples are of what camera rays meet first: see [`Firsts`].

mod cryptomatte;
mod names;

use crate::math::DVec3;
use crate::output::{Channels, Plane};
use crate::render::Film;
use crate::render::first::{FirstHits, Firsts};
use crate::why::Provenance;
use names::Names;
use rayon::prelude::*;

/// Something that a picture shows besides its light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Aov {
    /// Distance along the camera's axis in metres; infinite where nothing is met.
    Depth,
    /// The normal to shade with, on the side of the camera, in the world; 0 where nothing is met.
    Normal,
    /// The colour of materials; black of what glows and where nothing is met.
    Albedo,
    /// How many samples a pixel has.
    Samples,
    /// Standard error of the pixel's luminance in W/(m²·sr); infinite of one sample.
    Error,
    /// Which things, as Cryptomatte.
    Object,
    /// Which materials, as Cryptomatte.
    Material,
}

impl Aov {
    /// All of them with their names.
    pub const ALL: [(Aov, &'static str); 7] = [
        (Aov::Depth, "depth"),
        (Aov::Normal, "normal"),
        (Aov::Albedo, "albedo"),
        (Aov::Samples, "samples"),
        (Aov::Error, "error"),
        (Aov::Object, "object"),
        (Aov::Material, "material"),
    ];

    /// The one of a name.
    pub fn from_name(name: &str) -> Option<Aov> {
        Aov::ALL.iter().find(|(_, known)| *known == name).map(|(aov, _)| *aov)
    }

    /// Whether it is of what camera rays meet first.
    pub fn is_of_first_hits(self) -> bool {
        !matches!(self, Aov::Samples | Aov::Error)
    }
}

/// The hash of the names that some of them show; none where they show none. The samples of a picture do not depend on names,
/// so its identity has none of them.
pub fn names(wanted: &[Aov], from: Provenance) -> Option<blake3::Hash> {
    let named = wanted.iter().any(|aov| matches!(aov, Aov::Object | Aov::Material));
    named.then(|| Names::new(from).digest())
}

/// The channels of some of them, in the window of a film. First hits are wanted for those that are of them, and of the same
/// window.
pub fn channels(wanted: &[Aov], film: &Film, first: Option<&FirstHits>, from: Provenance) -> Channels {
    let mut channels = Channels::default();
    let window = film.window();
    let places: Vec<[u32; 2]> = (0..window.height)
        .flat_map(|y| (0..window.width).map(move |x| [window.x + x, window.y + y]))
        .collect();
    let names = Names::new(from);
    for aov in wanted {
        let of_film = |value: &(dyn Fn(u32, u32) -> f64 + Sync)| -> Vec<f32> {
            places.par_iter().map(|[x, y]| value(*x, *y) as f32).collect()
        };
        let of_first = |value: &(dyn Fn(&Firsts) -> f64 + Sync)| {
            of_film(&|x, y| first.map_or(0.0, |first| value(first.pixel(x, y))))
        };
        let mut add = |name: &str, values: Vec<f32>| {
            channels.planes.push(Plane { name: name.into(), values });
        };
        match aov {
            Aov::Depth => add("depth.Z", of_first(&|firsts| firsts.depth().unwrap_or(f64::INFINITY))),
            Aov::Normal => {
                for (axis, name) in ["normal.X", "normal.Y", "normal.Z"].into_iter().enumerate() {
                    add(name, of_first(&|firsts| firsts.normal().unwrap_or(DVec3::ZERO)[axis]));
                }
            }
            Aov::Albedo => {
                for (channel, name) in ["albedo.R", "albedo.G", "albedo.B"].into_iter().enumerate() {
                    add(name, of_first(&|firsts| firsts.albedo()[channel]));
                }
            }
            Aov::Samples => add("samples.X", of_film(&|x, y| f64::from(film.samples(x, y)))),
            Aov::Error => add("error.X", of_film(&|x, y| film.error(x, y))),
            Aov::Object | Aov::Material => {
                let Some(first) = first else { continue };
                let pixels: Vec<&Firsts> = places.iter().map(|[x, y]| first.pixel(*x, *y)).collect();
                let (layer, names) = match aov {
                    Aov::Object => ("CryptoObject", names.of_objects(&pixels)),
                    _ => ("CryptoMaterial", names.of_materials(&pixels)),
                };
                cryptomatte::add(&mut channels, layer, &pixels, &names);
            }
        }
    }
    channels
}
