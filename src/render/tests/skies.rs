//! Skies that are pictures.

use super::*;
use crate::asset::Image;
use crate::math::{cos, sin};
use crate::render::path::Sharing;
use crate::scene::{ImageId, Panorama};
use adapter::Lamps;
use std::sync::Arc;

/// A turn about an axis that is none of the coordinates'.
fn tilted() -> DMat3 {
    let z = v(0.3, 0.8, -0.4).normalize();
    let (x, y) = crate::math::basis(z);
    DMat3::from_cols(x, y, z)
}

fn with_panorama(mut scene: Scene, image: Image, image_from_world: DMat3) -> Scene {
    scene.images.push(Arc::new(image));
    let panorama = Panorama { image: ImageId(0), image_from_world };
    scene.with_light(Light::Sky { radiance: Rgb::splat(2.0), panorama: Some(panorama) })
}

/// A picture by a function of column and row.
fn picture(width: u32, height: u32, at: impl Fn(u32, u32) -> f32) -> Image {
    let pixels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| [at(x, y); 3]).collect();
    Image::new(width, height, pixels).unwrap()
}

fn uneven() -> Image {
    picture(12, 6, |x, y| 1.0 + ((x * 7 + y * 5) % 4) as f32)
}

fn lit_floor(image: Image, image_from_world: DMat3) -> Scene {
    let below = scene(v(0.0, 0.3, 0.0), DVec3::ZERO).with(floor(), white()).bounces(1);
    with_panorama(below, image, image_from_world)
}

#[test]
fn directions_have_their_density() {
    for (image, turned) in
        [(uneven(), tilted()), (uneven(), DMat3::IDENTITY), (picture(1, 1, |_, _| 1.0), tilted())]
    {
        let lamps = Lamps::of(&lit_floor(image, turned));
        let pdf = |w: DVec3| lamps.pdf(DVec3::ZERO, None, w);
        let draw = |[_, a, b]: [f64; 3]| {
            let sample = lamps.sample(DVec3::ZERO, None, 0.5, [a, b]).unwrap();
            Some(sample.wi)
        };
        assert_density(draw, pdf);
    }
}

#[test]
fn dark_parts_are_not_sampled_and_a_black_sky_is_no_light() {
    let half = picture(8, 4, |x, _| if x < 4 { 0.0 } else { 1.0 });
    let lamps = Lamps::of(&lit_floor(half, DMat3::IDENTITY));
    let mut random = Random(1);
    let mut bright = 0;
    for _ in 0..10_000 {
        let sample = lamps.sample(DVec3::ZERO, None, 0.5, random.pair()).unwrap();
        // Between the middles of dark pixels nothing is seen: their outer halves alone may be drawn.
        let column = 8.0 * (0.5 + crate::math::atan2(sample.wi.x, -sample.wi.z) / (2.0 * PI));
        assert!(!(1.0..3.0).contains(&column), "{}", sample.wi);
        bright += usize::from(sample.radiance.x > 0.0);
    }
    assert!(bright > 9_500, "{bright}");
    assert!(Lamps::of(&lit_floor(picture(3, 2, |_, _| 0.0), DMat3::IDENTITY)).is_empty());
}

#[test]
fn an_even_picture_lights_as_an_even_sky() {
    for size in [(1, 1), (2, 1), (16, 8), (3, 5)] {
        let even = picture(size.0, size.1, |_, _| 0.5);
        assert_shows(&lit_floor(even, tilted()), 20_000, 1.0, 1e-9);
        // A white ball in it cannot be seen.
        let ball = scene(v(0.0, 0.0, 3.0), DVec3::ZERO).with(sphere(DVec3::ZERO, 1.0), white()).bounces(50);
        assert_shows(&with_panorama(ball, picture(size.0, size.1, |_, _| 0.5), tilted()), 5_000, 1.0, 1e-3);
    }
}

#[test]
fn a_bright_patch_lights_as_integration_says() {
    let patch = |x: u32, y: u32| if (20..24).contains(&x) && (3..5).contains(&y) { 40.0 } else { 0.0 };
    let image = || picture(32, 16, patch);
    let scene = lit_floor(image(), DMat3::IDENTITY);
    // The bilinear surface over the sphere, by the midpoint rule on a grid much finer than its pixels.
    const FINE: u32 = 64;
    let bilinear = image();
    let mut expected = 0.0;
    for j in 0..8 * FINE {
        let theta = PI * (f64::from(j) + 0.5) / f64::from(16 * FINE);
        for i in 0..32 * FINE {
            let (u, w) = ((f64::from(i) + 0.5) / f64::from(32 * FINE), 1.0 - theta / PI);
            let seen = crate::render::texture::bilinear(&bilinear, DVec2::new(u, w), false).x;
            expected += seen * cos(theta) * sin(theta);
        }
    }
    let cell = PI / f64::from(16 * FINE) * 2.0 * PI / f64::from(32 * FINE);
    assert_shows(&scene, 100_000, 2.0 * expected * cell / PI, 1e-4);
}

#[test]
fn gathering_and_finding_a_picture_agree() {
    for material in [white(), Material::Metal { color: Rgb::ONE.into(), alpha: 0.3 }] {
        let mut scene = lit_floor(uneven(), tilted());
        scene.materials[0] = material;
        scene = scene.with(sphere(v(0.6, 0.4, 0.0), 0.3), glow(2.0));
        let results = [Sharing::Both, Sharing::OnlyGathered, Sharing::OnlyFound].map(|sharing| {
            let mut tracer = Tracer::new(&scene);
            tracer.sharing = sharing;
            measure(&tracer, 60_000)
        });
        let (shared, error) = results[0];
        for (mean, other) in &results[1..] {
            assert!((shared - mean).abs() < 5.0 * (error + other), "{results:?}");
        }
    }
}

#[test]
fn the_centre_is_at_minus_z_with_plus_x_to_its_right() {
    let left = picture(64, 32, |x, y| {
        if x < 32 {
            0.0
        } else if y < 16 {
            1.0
        } else {
            3.0
        }
    });
    for (look, expected) in [
        (v(1.0, 0.5, -1.0), 2.0),
        (v(1.0, -0.5, 1.0), 6.0),
        (v(-1.0, 0.5, -1.0), 0.0),
        (v(-1.0, -0.5, 1.0), 0.0),
    ] {
        let up = scene(DVec3::ZERO, look);
        let image =
            Image::new(64, 32, (0..64 * 32).map(|i| [left.pixel(i % 64, i / 64).x as f32; 3]).collect());
        assert_shows(&with_panorama(up, image.unwrap(), DMat3::IDENTITY), 10, expected, 1e-9);
    }
}
