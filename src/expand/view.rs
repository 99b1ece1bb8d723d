//! The camera and how the picture is traced.

use super::numbers::{number, preimage, triple};
use crate::math::{DVec3, atan2, tan};
use crate::scene::{Camera, Develop, Projection, Target, Trace};

/// The camera that takes the picture.
pub(super) fn camera(camera: &Camera, develop: &Develop) -> String {
    let half_width = camera.half_extent.x;
    let extent = match camera.projection {
        Projection::Perspective => {
            let fov = preimage(half_width, 2.0 * atan2(half_width, 1.0), |fov| tan(0.5 * fov));
            format!("fov: {}rad", number(fov))
        }
        Projection::Orthographic => format!("width: {}m", number(2.0 * half_width)),
    };
    let look = along(camera.position, camera.forward);
    let (from, look, up) = (triple(camera.position), triple(look), triple(camera.up));
    let exposure = develop.exposure.map_or("auto".to_string(), number);
    let mut fields = format!("from: {from}m, look: {look}m, up: {up}, {extent}, exposure: {exposure}");
    if camera.lens_radius != 0.0 || camera.focus != 1.0 {
        let (aperture, focus) = (number(2.0 * camera.lens_radius), number(camera.focus));
        fields += &format!(", lens {{ aperture: {aperture}m, focus: {focus}m }}");
    }
    format!("camera {{ {fields} }}")
}

/// A point whose difference to another, in rounded numbers, is a power of two times a direction: as near as there is one
/// from about the distance of the origin on.
pub(super) fn along(from: DVec3, direction: DVec3) -> DVec3 {
    let mut scale = 1.0;
    while scale < from.length() && scale < 1e300 {
        scale *= 2.0;
    }
    let reached = (0..NEAR).find_map(|_| {
        let step = scale * direction;
        scale *= 2.0;
        let part = |i: usize| preimage(step[i], from[i] + step[i], |x| x - from[i]);
        let look = DVec3::new(part(0), part(1), part(2));
        (look - from == step).then_some(look)
    });
    reached.unwrap_or_else(|| far_along(from, direction))
}

/// How many distances are tried for a point to look at, each twice the one before.
const NEAR: u32 = 12;

/// The same, so far away that the place of the other is lost in rounding.
fn far_along(from: DVec3, direction: DVec3) -> DVec3 {
    // So far that the least part of the direction still outweighs the whole of `from`.
    let parts = direction.abs().to_array().into_iter().filter(|part| *part > 0.0);
    let least = parts.fold(1.0, f64::min);
    let mut scale = 1.0;
    // 2⁶⁰ is far beyond the 53 bits of a number.
    let wanted = from.abs().max_element() * (1u64 << 60) as f64;
    while scale * least < wanted && scale < 1e300 {
        scale *= 2.0;
    }
    let far = scale * direction;
    let along = |i: usize| if direction[i] == 0.0 { from[i] } else { far[i] };
    DVec3::new(along(0), along(1), along(2))
}

/// How it is traced.
pub(super) fn render(trace: &Trace, develop: &Develop) -> String {
    let [width, height] = trace.size;
    let target = match trace.target {
        Target::Samples(samples) => format!("samples: {samples}"),
        Target::Noise(noise) => format!("noise: {}", number(noise)),
    };
    let Trace { bounces, indirect, seed, .. } = trace;
    let (filter, tonemap) = (trace.filter.word(), develop.tonemap.word());
    let fields = [
        format!("size: ({width}, {height})"),
        target,
        format!("bounces: {bounces}"),
        format!("indirect: {indirect}"),
        format!("seed: {seed}"),
        format!("filter: {filter}"),
        format!("tonemap: {tonemap}"),
        format!("background: {}", trace.background.word()),
    ];
    format!("render {{ {} }}", fields.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_point_keeps_a_direction_though_it_is_far_from_the_camera() {
        let from = DVec3::new(0.1, -1e6, 3.0);
        for direction in [DVec3::new(0.6, -0.8, 0.0), DVec3::new(1e-30, 0.9, 0.43588989435406744), DVec3::X] {
            let difference = far_along(from, direction) - from;
            let scale = difference.y / direction.y;
            let scale = if scale.is_finite() { scale } else { difference.x };
            assert_eq!(difference / scale, direction);
        }
    }

    #[test]
    fn what_is_looked_at_is_near_where_it_can_be() {
        let from = DVec3::new(0.0, 1.0, 4.0);
        let direction = (DVec3::new(0.0, 0.5, 0.0) - from).normalize();
        let look = along(from, direction);
        assert!(look.length() < 1e4, "{look}");
        let difference = look - from;
        let scale = difference.z / direction.z;
        assert_eq!(difference / scale, direction);
    }
}
