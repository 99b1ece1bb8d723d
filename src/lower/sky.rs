//! The sky: one colour, or a picture of all directions.

use super::{Lowering, errors};
use crate::diagnostic::Diagnostic;
use crate::eval::Thing;
use crate::math::{DMat3, DVec3, cos, sin};
use crate::scene::{Light, Panorama};
use crate::schema::sky;
use crate::span::Span;

/// By how much the groups around a sky may stretch one direction beyond another: rounding of rotations, far below
/// what a picture can show.
const STRETCH: f64 = 1e-9;

impl Lowering<'_> {
    pub(super) fn sky(&mut self, thing: &Thing) {
        let made = thing.made;
        let radiance = self.things.read(made, sky::COLOR) * self.things.read(made, sky::RADIANCE);
        let panorama = match made.given(sky::IMAGE) {
            None => None,
            Some((file, span)) => match self.panorama(thing, &file, span) {
                Ok(panorama) => Some(panorama),
                Err(diagnostic) => return self.report(self.used_at(thing, *diagnostic)),
            },
        };
        self.add_light(thing, Light::Sky { radiance, panorama });
    }

    /// The picture of a sky. It turns with the groups that it stands in.
    fn panorama(&mut self, thing: &Thing, file: &str, span: Span) -> Result<Panorama, Box<Diagnostic>> {
        let image = self.textures.image(file, span)?;
        let turn = turn_y(self.things.read(thing.made, sky::TURN));
        let turned = rotation(thing.world_from_object.matrix3 * turn);
        let world_from_image = turned.ok_or_else(|| Box::new(errors::stretched_sky(thing.made.span())))?;
        Ok(Panorama { image, image_from_world: world_from_image.transpose() })
    }
}

/// Rotation about y by the right-hand rule.
fn turn_y(angle: f64) -> DMat3 {
    let (sin, cos) = (sin(angle), cos(angle));
    DMat3::from_cols(DVec3::new(cos, 0.0, -sin), DVec3::Y, DVec3::new(sin, 0.0, cos))
}

/// A map without the factor by which it enlarges; none where it enlarges one direction more than another.
fn rotation(map: DMat3) -> Option<DMat3> {
    /// By how much the squared length of what was divided by its length may be off: such a map is left as it is, so
    /// that a scene that is written out and read again keeps its bits.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let even = (map.x_axis.length_squared() - 1.0).abs() <= ROUNDING;
    let scaled = if even { map } else { map * map.x_axis.length().recip() } + DMat3::ZERO;
    let stretch = scaled.transpose() * scaled - DMat3::IDENTITY;
    let even = stretch.to_cols_array().iter().all(|entry| entry.abs() <= STRETCH);
    even.then_some(scaled)
}
