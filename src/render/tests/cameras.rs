//! The camera: filters, lens, geometry.

use super::*;
use crate::render::shape::Ray;

fn rays(scene: &Scene, count: u32) -> Vec<(Ray, f64)> {
    let eye = Eye::new(scene);
    (0..count).map(|i| eye.ray(4, 2, scene.trace.size, &Sampler::new(1, 4, 2, i))).collect()
}

/// Where a ray crosses the plane at a distance along the view, relative to the camera, rightwards and upwards.
fn crossing(scene: &Scene, ray: &Ray, distance: f64) -> DVec2 {
    let camera = &scene.camera;
    let o = ray.origin - camera.position;
    let t = (distance - o.dot(camera.forward)) / ray.direction.dot(camera.forward);
    let p = o + t * ray.direction;
    DVec2::new(p.dot(camera.right), p.dot(camera.up))
}

fn wide() -> Scene {
    let mut scene = scene(v(1.0, 2.0, 3.0), v(0.0, 0.0, -1.0));
    scene.trace.size = [8, 4];
    scene.camera.half_extent = DVec2::new(0.8, 0.4);
    scene
}

#[test]
fn pixels_lie_from_the_top_left() {
    let scene = wide();
    let mean = rays(&scene, 4096).iter().map(|(ray, _)| crossing(&scene, ray, 1.0)).sum::<DVec2>() / 4096.0;
    // The middle of pixel (4, 2) of 8 × 4 lies half a pixel right of and below the middle.
    assert!(mean.distance(DVec2::new(0.1, -0.1)) < 1e-3, "{mean}");
}

#[test]
fn an_orthographic_camera_sees_along_parallel_rays() {
    let mut scene = wide();
    scene.camera.projection = Projection::Orthographic;
    let rays = rays(&scene, 4096);
    assert!(rays.iter().all(|(ray, _)| ray.direction == scene.camera.forward));
    for distance in [0.0, 7.0] {
        let mean = rays.iter().map(|(ray, _)| crossing(&scene, ray, distance)).sum::<DVec2>() / 4096.0;
        assert!(mean.distance(DVec2::new(0.1, -0.1)) < 1e-3, "{mean}");
    }
    // A ball is as large from afar: π/4 of a window that it touches.
    for z in [-2.0, -200.0] {
        let mut scene = super::scene(DVec3::ZERO, DVec3::NEG_Z).with(sphere(v(0.0, 0.0, z), 1.0), glow(1.0));
        scene.camera.projection = Projection::Orthographic;
        scene.camera.half_extent = DVec2::ONE;
        assert_shows(&scene, 20_000, 0.25 * PI, 1e-3);
    }
}

#[test]
fn an_orthographic_camera_may_start_in_glass() {
    // Only a part of its window is in the ball.
    let ball = sphere(v(0.4, 0.0, 0.0), 0.5);
    let mut scene = super::scene(DVec3::ZERO, DVec3::NEG_Z).with(ball, glass(1.0)).with_sky(1.0);
    scene.camera.projection = Projection::Orthographic;
    scene.camera.half_extent = DVec2::ONE;
    assert_shows(&scene, 2000, 1.0, 1e-9);
    scene.materials[0] = Material::Dielectric { ior: 1.0, absorption: Rgb::splat(1e9), alpha: 0.0 };
    assert_shows(&scene, 40_000, 1.0 - 0.25 * PI * 0.25, 2e-2);
}

#[test]
fn a_transparent_background_is_open_where_nothing_is_met() {
    for filter in [Filter::Box, Filter::Gaussian, Filter::Mitchell] {
        let mut scene = super::scene(DVec3::ZERO, DVec3::NEG_Z)
            .with(sphere(v(0.0, 0.0, -3.0), 1.0), white())
            .with(sphere(v(1.5, 0.0, -3.0), 0.4), glass(1.5))
            .with_sky(1.0);
        scene.trace.background = Background::Transparent;
        scene.trace.filter = filter;
        scene.trace.size = [24, 24];
        scene.camera.projection = Projection::Orthographic;
        scene.camera.half_extent = DVec2::splat(2.0);
        let tracer = Tracer::new(&scene);
        let shown = Shown { stops: 0.0, tonemap: Tonemap::None };
        let whole = Window::whole(scene.trace.size);
        let target = Target::Samples(64);
        let film = tracer.render(whole, target, &tracer.prepass(), shown, &Control::new()).unwrap().film;
        // Exactly, whatever the weights of the filter add up to.
        assert_eq!((film.alpha(0, 0), film.mean(0, 0)), (0.0, Rgb::ZERO));
        assert_eq!(film.alpha(12, 12), 1.0);
        assert_eq!(film.alpha(21, 12), 1.0, "glass covers, though the sky is seen through it");
        let pixels = (0..24).flat_map(|y| (0..24).map(move |x| (x, y)));
        let (mut covered, mut edges) = (0.0, 0);
        for (x, y) in pixels {
            let (alpha, mean) = (film.alpha(x, y), film.mean(x, y));
            covered += alpha * 16.0 / 576.0;
            edges += u32::from(alpha > 0.0 && alpha < 1.0);
            // All that covers is as bright as the sky, so the radiance is the share.
            if filter != Filter::Mitchell {
                assert!((mean.y - alpha).abs() < 0.05, "{filter:?} {mean} {alpha}");
            }
        }
        assert!((covered - 1.16 * PI).abs() < 0.05 && edges > 20, "{filter:?}: {covered} {edges}");
    }
}

#[test]
fn filters_are_drawn_from_as_they_are_defined() {
    const N: u32 = 1 << 16;
    for filter in [Filter::Box, Filter::Tent, Filter::Gaussian, Filter::Mitchell] {
        let mut scene = wide();
        scene.trace.filter = filter;
        // The kernel once more, from its definition.
        let value = |x: f64| match filter {
            Filter::Box => f64::from(x.abs() < 0.5),
            Filter::Tent => (1.0 - x.abs()).max(0.0),
            Filter::Gaussian if x.abs() > 1.5 => 0.0,
            Filter::Gaussian => crate::math::exp(-x * x / (2.0 * 0.25)),
            Filter::Mitchell => mitchell(x.abs()),
        };
        const CELLS: usize = 64;
        let cell = |x: f64| ((x + 2.0) / 4.0 * CELLS as f64) as usize;
        let mut masses = vec![0.0; CELLS];
        for i in 0..64 * CELLS {
            let x = 4.0 * (i as f64 + 0.5) / (64 * CELLS) as f64 - 2.0;
            masses[cell(x)] += value(x) * 4.0 / (64 * CELLS) as f64;
        }
        let total: f64 = masses.iter().sum();
        let mut seen = vec![0.0; CELLS];
        let mut weights = 0.0;
        for (ray, weight) in rays(&scene, N) {
            let x = crossing(&scene, &ray, 1.0).x / 0.2 - 0.5;
            seen[cell(x)] += weight / f64::from(N);
            weights += weight / f64::from(N);
        }
        assert!((weights - 1.0).abs() < 1e-3, "{filter:?}: weights add up to {weights}");
        for (i, (seen, mass)) in seen.iter().zip(&masses).enumerate() {
            // A Sobol pair's one-dimensional error is far below the sampling error of independent numbers.
            assert!((seen - mass / total).abs() < 2e-3, "{filter:?} cell {i}: {seen} {}", mass / total);
        }
    }
}

/// Mitchell and Netravali 1988, equation 8, in its general form.
fn mitchell(x: f64) -> f64 {
    let (b, c) = (1.0 / 3.0, 1.0 / 3.0);
    let (squared, cubed) = (x * x, x * x * x);
    if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * cubed + (-18.0 + 12.0 * b + 6.0 * c) * squared + 6.0 - 2.0 * b) / 6.0
    } else if x < 2.0 {
        ((-b - 6.0 * c) * cubed
            + (6.0 * b + 30.0 * c) * squared
            + (-12.0 * b - 48.0 * c) * x
            + 8.0 * b
            + 24.0 * c)
            / 6.0
    } else {
        0.0
    }
}

#[test]
fn the_circle_of_confusion_is_that_of_a_thin_lens() {
    let mut scene = wide();
    scene.camera.half_extent = DVec2::splat(1e-9);
    scene.camera.lens_radius = 0.05;
    scene.camera.focus = 4.0;
    let rays = rays(&scene, 4096);
    for distance in [1.0, 3.0, 4.0, 8.0] {
        let radius = 0.05 * f64::abs(distance - 4.0) / 4.0;
        let points: Vec<DVec2> = rays.iter().map(|(ray, _)| crossing(&scene, ray, distance)).collect();
        let most = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let mean = points.iter().map(|p| p.length_squared()).sum::<f64>() / points.len() as f64;
        assert!(most <= radius + 1e-6 && most >= 0.98 * radius, "at {distance}: {most}, not {radius}");
        assert!(
            (mean - 0.5 * radius * radius).abs() < 1e-3 * radius * radius + 1e-9,
            "at {distance}: {mean}"
        );
    }
}

#[test]
fn what_is_out_of_focus_is_dimmed_by_its_circle() {
    // A small lamp twice as far as the focus fills (s/c)² of its circle of confusion c = R, at its distance.
    let mut scene = scene(DVec3::ZERO, DVec3::NEG_Z).with(sphere(v(0.0, 0.0, -8.0), 0.01), glow(1.0));
    scene.camera.lens_radius = 0.05;
    scene.camera.focus = 4.0;
    assert_shows(&scene, 200_000, 0.04, 1e-3);
}
