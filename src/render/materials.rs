//! Materials in the form that lanes gather.

use super::bsdf::{Bsdfs, Coats, Kind, SMOOTH_ALPHA};
use super::lanes::{Float, Lanes, MOST, Mask, Table, Word};
use super::shape::FACE_BITS;
use super::surfaces::Surfaces;
use super::vector::{V, single};
use crate::color::Rgb;
use crate::scene::{Material, Paint, PrimitiveId, Scene};

/// Of a kind: the colour is by place.
const PAINTED: u32 = 1 << 8;

/// The materials of a scene.
pub struct Materials {
    /// Colour, or of an emitter radiance in multiples of the unit; and GGX α.
    colors: Table,
    /// Bits of the kind, with [`PAINTED`] of what has a texture; and of the coat.
    natures: Table,
    /// Each slot's row of these tables; without any, where surfaces are few, each slot has a row of its own.
    rows: Vec<u32>,
    /// The coats of plastics.
    pub coats: Coats,
}

impl Materials {
    /// Those of a scene, radiance in multiples of a unit.
    pub fn new(scene: &Scene, surfaces: &Surfaces, unit: f64) -> Materials {
        let mut coats = Coats::default();
        let (mut colors, mut natures) = (Vec::new(), Vec::new());
        for material in &scene.materials {
            let (kind, color, alpha, coat) = plain(material, &mut coats, unit);
            let [r, g, b] = single(color.min(Rgb::splat(f64::from(super::light::BRIGHTEST))));
            colors.push([r, g, b, alpha]);
            let painted = if material.texture().is_some() { PAINTED } else { 0 };
            natures.push([f32::from_bits(kind as u32 | painted), f32::from_bits(coat), 0.0, 0.0]);
        }
        let mut rows = vec![0; scene.primitives.len()];
        for (id, primitive) in (0..).map(PrimitiveId).zip(scene.primitives.iter()) {
            rows[surfaces.slot(id) as usize] = primitive.material.0;
        }
        if rows.len() <= MOST {
            let by_slot = |table: Vec<[f32; 4]>| rows.iter().map(|row| table[*row as usize]).collect();
            (colors, natures) = (by_slot(colors), by_slot(natures));
            rows = Vec::new();
        }
        Materials { colors: Table::new(colors), natures: Table::new(natures), rows, coats }
    }

    /// Those of places, in the lanes of a mask, and which of them have a texture; elsewhere nothing that matters. Of
    /// what has a texture the colour is what the texture multiplies.
    #[inline(always)]
    pub fn at<L: Lanes>(&self, l: L, places: L::U, mask: L::M) -> (Bsdfs<L>, L::M) {
        let mut rows = mask.pick_word(places >> FACE_BITS, l.u(0));
        if !self.rows.is_empty() {
            let mut at = [0; MOST];
            rows.store(&mut at);
            for row in &mut at[..L::N] {
                *row = self.rows[*row as usize];
            }
            rows = l.load_words(&at);
        }
        let [r, g, b, alpha] = l.look_up(&self.colors, rows);
        let [nature, coat, ..] = l.look_up(&self.natures, rows);
        let (nature, coat) = (nature.bits(), coat.bits());
        let painted = mask & !(nature & l.u(PAINTED)).is(l.u(0));
        let kind = nature & l.u(PAINTED - 1);
        (Bsdfs { kind, color: V::new(r, g, b), alpha, eta: l.f(1.0), coat }, painted)
    }
}

fn plain(material: &Material, coats: &mut Coats, unit: f64) -> (Kind, Rgb, f32, u32) {
    let polished = |alpha: f64, smooth: Kind, rough: Kind| {
        if (alpha as f32) < SMOOTH_ALPHA { smooth } else { rough }
    };
    let base = |paint: Paint| match paint {
        Paint::Plain(color) => color,
        Paint::Texture(_) => Rgb::ONE,
    };
    match *material {
        Material::Diffuse { color } => (Kind::Diffuse, base(color), 1.0, 0),
        Material::Mirror { color } => (Kind::Mirror, base(color), 0.0, 0),
        Material::Dielectric { alpha, .. } => {
            (polished(alpha, Kind::PolishedDielectric, Kind::Dielectric), Rgb::ONE, alpha as f32, 0)
        }
        Material::Metal { color, alpha } => {
            (polished(alpha, Kind::PolishedMetal, Kind::Metal), base(color), alpha as f32, 0)
        }
        Material::Plastic { color, ior, alpha } => {
            (Kind::Plastic, base(color), alpha as f32, coats.index(ior as f32, alpha as f32))
        }
        Material::Emitter { radiance, .. } => (Kind::Emitter, radiance / unit, 1.0, 0),
    }
}
