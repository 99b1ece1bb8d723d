//! Lights that are no surface.

use super::Flat;
use super::numbers::{at, matrix, number, preimage, rgb, triple};
use super::view::along;
use crate::color::Rgb;
use crate::math::{DMat3, DVec3, PI, atan2, cos, sin};
use crate::scene::{Light, Panorama};

/// The statement of a light.
pub(super) fn lamp(flat: &Flat, light: &Light) -> Result<String, &'static str> {
    Ok(match light {
        Light::Point { position, intensity } => {
            // Intensity is power over 4π.
            let power = intensity.to_array().map(|i| preimage(i, 4.0 * PI * i, |power| power / (4.0 * PI)));
            let (at, color) = (at(*position), rgb(Rgb::from_array(power)));
            format!("light {{ {at}power: 1W, color: {color} }}")
        }
        Light::Spot { position, direction, intensity, inner, outer } => {
            // As lowering counts the solid angle of the cone.
            let height = |angle: f64| {
                let sine = sin(0.5 * angle);
                2.0 * sine * sine
            };
            let angle = PI * (height(*inner) + height(*outer));
            let power = intensity.to_array().map(|i| preimage(i, i * angle, |power| power / angle));
            let soft = preimage(*inner, 1.0 - inner / outer, |soft| (1.0 - soft) * outer);
            let aim = triple(along(*position, *direction));
            let (at, color, cone) = (at(*position), rgb(Rgb::from_array(power)), number(2.0 * outer));
            let soft = number(soft.clamp(0.0, 1.0));
            format!("light {{ {at}power: 1W, color: {color}, aim: {aim}m, cone: {cone}rad, soft: {soft} }}")
        }
        Light::Sun { direction, irradiance, radius } => {
            let (from, color, angle) = (triple(*direction), rgb(*irradiance), number(2.0 * radius));
            format!("sun {{ from: {from}, irradiance: 1W/m2, angle: {angle}rad, color: {color} }}")
        }
        Light::Sky { radiance, panorama: None } => format!("sky {{ color: {} }}", rgb(*radiance)),
        Light::Sky { radiance, panorama: Some(panorama) } => sky(flat, *radiance, panorama)?,
    })
}

/// A picture of the sky, as a turn where there is one that gives the same bits, else in a group.
fn sky(flat: &Flat, radiance: Rgb, panorama: &Panorama) -> Result<String, &'static str> {
    let world_from_image = panorama.image_from_world.transpose();
    // It has no colour besides its picture, so all channels are the same.
    let fields = format!("image: {}, radiance: {}W/m2", flat.image(panorama.image)?, number(radiance.x));
    if world_from_image == DMat3::IDENTITY {
        return Ok(format!("sky {{ {fields} }}"));
    }
    let [sine, cosine] = [world_from_image.z_axis.x, world_from_image.x_axis.x];
    let about_y = DMat3::from_cols(DVec3::new(cosine, 0.0, -sine), DVec3::Y, DVec3::new(sine, 0.0, cosine));
    let turn =
        preimage(sine, atan2(sine, cosine), |turn| if cos(turn) == cosine { sin(turn) } else { f64::NAN });
    if world_from_image == about_y && [sin(turn), cos(turn)] == [sine, cosine] {
        return Ok(format!("sky {{ {fields}, turn: {}rad }}", number(turn)));
    }
    let place = matrix(world_from_image, DVec3::ZERO);
    Ok(format!("group {{ place: {place}, sky {{ {fields} }} }}"))
}
