//! What brighter lamps do to a picture, before it is traced again.

use super::*;
use crate::render::Control;
use crate::render::light::Source;

/// A floor under two lamps, one reddish and at the left, the other bluish and at the right.
fn two_lamps() -> Scene {
    let mut scene = scene(v(0.0, 2.0, 6.0), v(0.0, 0.0, 0.0)).with(floor(), white());
    scene.trace.size = [24, 16];
    scene.camera.half_extent = DVec2::new(0.6, 0.4);
    for (x, color) in [(-2.0, Rgb::new(20.0, 4.0, 1.0)), (2.0, Rgb::new(1.0, 4.0, 20.0))] {
        scene.lights.push(Light::Point { position: v(x, 1.0, 0.0), intensity: color });
    }
    scene
}

#[test]
fn what_grows_alike_grows_by_that() {
    let scene = two_lamps();
    let shares = Tracer::new(&scene).shares(&Control::new()).unwrap().unwrap();
    assert_eq!(shares.sources(), [Source::Light(0), Source::Light(1)]);
    for (x, y) in [(0, 0), (23, 15), (12, 8), (3, 14)] {
        for channel in shares.factor(x, y, &[Rgb::splat(3.0); 2]) {
            // Where no light of a colour comes, it stays as it is.
            assert!((channel - 3.0).abs() < 1e-5 || channel == 1.0, "{channel} at {x}, {y}");
        }
    }
}

#[test]
fn a_picture_mixed_anew_is_close_to_a_traced_one() {
    let before = two_lamps();
    let mut after = before.clone();
    let Light::Point { intensity, .. } = &mut after.lights[0] else { unreachable!() };
    *intensity *= 4.0;
    let shares = Tracer::new(&before).shares(&Control::new()).unwrap().unwrap();
    let traced = |scene: &Scene| {
        let mut film = Film::new(Window::whole(scene.trace.size), crate::math::exp2(28.0));
        Tracer::new(scene).add_samples(&mut film, 0..256, &Control::new()).unwrap();
        film
    };
    let (old, new) = (traced(&before), traced(&after));
    let (mut mixed, mut wanted) = (Rgb::ZERO, Rgb::ZERO);
    for (x, y) in (0..16).flat_map(|y| (0..24).map(move |x| (x, y))) {
        let factor = shares.factor(x, y, &[Rgb::splat(4.0), Rgb::ONE]).map(f64::from);
        mixed += old.mean(x, y) * Rgb::from_array(factor);
        wanted += new.mean(x, y);
    }
    let error = ((mixed - wanted) / wanted).abs().max_element();
    assert!(error < 0.05, "{mixed} for {wanted}");
}
