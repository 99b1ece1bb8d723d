//! Materials: colours as reflectance, tint as absorption, roughness as α, power as radiance.

use super::errors;
use super::texture::Textures;
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::eval::{Fields, Given, Made, Paint as Written, Things, Value};
use crate::math::{DVec3, PI, ln};
use crate::scene::{Material, MaterialId, Paint, Shape};
use crate::schema::{self, Key, dielectric, diffuse, emitter, metal, mirror, plastic};
use std::collections::BTreeMap;
use std::rc::Rc;

/// The materials of a scene, each once.
#[derive(Default)]
pub(super) struct Materials {
    all: Vec<Material>,
    known: Known,
    /// By the thing that several surfaces share, which lives as long as the things do; what is made of nothing
    /// stands under none.
    shared: BTreeMap<Option<*const Made>, MaterialId>,
}

impl Materials {
    pub(super) fn add(&mut self, material: Material) -> MaterialId {
        let id = self.known.get_or_add(&self.all, &material);
        if id.0 as usize == self.all.len() {
            self.all.push(material);
        }
        id
    }

    pub(super) fn get(&self, id: MaterialId) -> &Material {
        &self.all[id.0 as usize]
    }

    /// The material of surfaces that were given this, if it was remembered.
    pub(super) fn known(&self, given: Option<&Given>) -> Option<MaterialId> {
        self.shared.get(&shared(given)?).copied()
    }

    /// Remembers the material of surfaces that were given this, where others may be given the same.
    pub(super) fn remember(&mut self, given: Option<&Given>, id: MaterialId) {
        if let Some(key) = shared(given) {
            self.shared.insert(key, id);
        }
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Material> {
        self.all.iter()
    }

    pub(super) fn finish(self) -> Vec<Material> {
        self.all
    }
}

/// Where materials are, by what their canonical bytes are hashed to: every surface may have one of its own, of which an
/// ordered map takes several times the time and memory.
#[derive(Default)]
struct Known {
    /// Each material's index is at the place that its hash says, or where that is taken at the next that is free. More than
    /// half are free; of a power of two, if there are any.
    places: Vec<u32>,
}

/// No material.
const FREE: u32 = u32::MAX;

impl Known {
    /// The id of a material among all there are; if it is not among them, that of the next to be added.
    fn get_or_add(&mut self, all: &[Material], material: &Material) -> MaterialId {
        if 2 * all.len() >= self.places.len() {
            self.grow(all);
        }
        let place = self.place(all, material);
        if self.places[place] == FREE {
            self.places[place] = all.len() as u32;
        }
        MaterialId(self.places[place])
    }

    /// The place of a material, or the free one where it belongs.
    fn place(&self, all: &[Material], material: &Material) -> usize {
        let last = self.places.len() - 1;
        let mut place = hash(material) as usize & last;
        while self.places[place] != FREE && all[self.places[place] as usize] != *material {
            place = (place + 1) & last;
        }
        place
    }

    fn grow(&mut self, all: &[Material]) {
        /// Room for the materials of most scenes.
        const LEAST: usize = 64;
        self.places = vec![FREE; (2 * self.places.len()).max(LEAST)];
        for (index, material) in (0..).zip(all) {
            let place = self.place(all, material);
            self.places[place] = index;
        }
    }
}

fn hash(material: &Material) -> u64 {
    /// More than any material takes: five numbers and what they are.
    const ROOM: usize = 128;
    let mut room = [0; ROOM];
    let bytes = postcard::to_slice(material, &mut room).expect("a material is a few plain numbers");
    let hash = blake3::hash(bytes);
    hash.as_bytes().iter().take(8).fold(0, |sum, byte| sum << 8 | u64::from(*byte))
}

/// What surfaces share that have the same material. What glows may depend on the surface.
fn shared(given: Option<&Given>) -> Option<Option<*const Made>> {
    /// The thing that is being lowered has it twice: as its field, and as what is asked for.
    const OWN: usize = 2;
    match given.map(|given| &given.value) {
        None => Some(None),
        Some(Value::Made(made)) if made.kind() != emitter::KIND && Rc::strong_count(made) > OWN => {
            Some(Some(Rc::as_ptr(made)))
        }
        Some(_) => None,
    }
}

/// What a surface is made of that names no material.
pub(super) fn bare(things: &Things) -> Material {
    let color = match things.read(super::plain(diffuse::KIND).fields(), diffuse::COLOR) {
        Written::Plain(color) => Paint::Plain(color),
        Written::Texture(_) => unreachable!("the default of a colour is one"),
    };
    Material::Diffuse { color }
}

/// Lowers the material of a shape. A glowing one may count its power over the surface.
pub(super) fn lower(
    textures: &mut Textures,
    things: &Things,
    given: &Given,
    shape: &Shape,
) -> Result<Material, Box<Diagnostic>> {
    let Value::Made(made) = &given.value else { return Ok(bare(things)) };
    let made = made.fields();
    let kind = made.kind();
    let mut paint = |key: Key<schema::Paint>| textures.paint(&things.read(made, key), 1.0);
    Ok(if kind == diffuse::KIND {
        Material::Diffuse { color: paint(diffuse::COLOR)? }
    } else if kind == mirror::KIND {
        Material::Mirror { color: paint(mirror::COLOR)? }
    } else if kind == dielectric::KIND {
        let tint = things.read(made, dielectric::TINT);
        let depth = things.read(made, dielectric::DEPTH);
        let absorption = |channel: f64| if channel >= 1.0 { 0.0 } else { -ln(channel) / depth };
        Material::Dielectric {
            ior: things.read(made, dielectric::IOR),
            absorption: DVec3::new(absorption(tint.x), absorption(tint.y), absorption(tint.z))
                + things.read(made, dielectric::ABSORPTION),
            alpha: alpha(things.read(made, dielectric::ROUGHNESS)),
        }
    } else if kind == metal::KIND {
        Material::Metal { color: paint(metal::COLOR)?, alpha: alpha(things.read(made, metal::ROUGHNESS)) }
    } else if kind == plastic::KIND {
        Material::Plastic {
            color: paint(plastic::COLOR)?,
            ior: things.read(made, plastic::IOR),
            alpha: alpha(things.read(made, plastic::ROUGHNESS)),
        }
    } else {
        glow(textures, things, made, given, shape)?
    })
}

fn glow(
    textures: &mut Textures,
    things: &Things,
    made: Fields,
    given: &Given,
    shape: &Shape,
) -> Result<Material, Box<Diagnostic>> {
    let (color, pattern) = match textures.paint(&things.read(made, emitter::COLOR), f64::INFINITY)? {
        Paint::Plain(color) => (color, None),
        Paint::Texture(pattern) => (Rgb::ONE, Some(pattern)),
    };
    if let (Some(_), Some((_, color)), Some((_, power))) =
        (pattern, made.given(emitter::COLOR), made.given(emitter::POWER))
    {
        return Err(Box::new(errors::textured_power(power, color)));
    }
    let radiance = match (made.given(emitter::POWER), made.given(emitter::RADIANCE)) {
        (Some((power, span)), _) => {
            let sides = if shape.is_closed() { 1.0 } else { 2.0 };
            let area = shape.area();
            if area == f64::INFINITY {
                return Err(Box::new(errors::endless_power(span)));
            }
            color * (power / (PI * area * sides))
        }
        (None, Some((radiance, _))) => color * radiance,
        (None, None) => DVec3::ZERO,
    };
    match radiance.is_finite() {
        true => Ok(Material::Emitter { radiance, pattern }),
        false => Err(Box::new(errors::glows_beyond(given.span))),
    }
}

/// Perceptual roughness to GGX α.
fn alpha(roughness: f64) -> f64 {
    roughness * roughness
}
