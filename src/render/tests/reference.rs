//! A room of giant spheres against a converged picture from another renderer: see `tests/references/README.md`.

use super::*;

const SIZE: [u32; 2] = [320, 240];

/// The scene of the reference.
pub fn room() -> Scene {
    let wall = |r, g, b| Material::Diffuse { color: Rgb::new(r, g, b).into() };
    let mut scene = scene(v(0.0, 0.0, 55.0), v(0.0, 0.0, 54.0))
        .with(sphere(v(-1000.0, 0.0, 0.0), 940.0), wall(0.75, 0.15, 0.15))
        .with(sphere(v(1000.0, 0.0, 0.0), 940.0), wall(0.15, 0.75, 0.15))
        .with(sphere(v(0.0, 0.0, -1000.0), 940.0), wall(0.15, 0.15, 0.75))
        .with(sphere(v(0.0, 0.0, 1000.0), 940.0), wall(0.75, 0.15, 0.75))
        .with(sphere(v(0.0, -1000.0, 0.0), 940.0), wall(0.5, 0.5, 0.5))
        .with(sphere(v(0.0, 1000.0, 0.0), 940.0), wall(0.5, 0.5, 0.5))
        .with(sphere(v(-20.0, -4.0, -8.0), 10.0), wall(0.8, 0.8, 0.8))
        .with(sphere(v(0.0, 4.0, -18.0), 10.0), Material::Mirror { color: Rgb::splat(0.9).into() })
        .with(sphere(v(18.0, -6.0, 4.0), 10.0), glass(1.5))
        .with(sphere(v(-10.0, 20.0, 40.0), 5.0), glow(150.0))
        .bounces(7);
    scene.camera.right = DVec3::X;
    scene.camera.up = DVec3::Y;
    let half_width = crate::math::tan(PI / 6.0);
    scene.camera.half_extent = DVec2::new(half_width, 0.75 * half_width);
    scene.trace.size = SIZE;
    scene
}

/// The reference: rows from the bottom, little-endian `f32`.
fn reference() -> impl Fn(u32, u32) -> Rgb {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/references/room.pfm");
    let bytes = std::fs::read(path).expect("the reference lies in the repository");
    let floats: Vec<f64> = bytes[bytes.len() - 4 * 3 * 320 * 240..]
        .chunks_exact(4)
        .map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))))
        .collect();
    move |x, y| Rgb::from_slice(&floats[3 * ((SIZE[1] - 1 - y) * SIZE[0] + x) as usize..])
}

/// Ratios of the channels' means, and relative squared errors of means over 8×8 pixels, sorted.
fn compare(film: &Film) -> (Rgb, Vec<f64>) {
    let reference = reference();
    let (mut ours, mut theirs) = (Rgb::ZERO, Rgb::ZERO);
    let mut errors = Vec::new();
    for y in (0..SIZE[1]).step_by(8) {
        for x in (0..SIZE[0]).step_by(8) {
            let block = (0..64).map(|i| (x + i % 8, y + i / 8));
            let a = block.clone().map(|(x, y)| film.mean(x, y)).sum::<Rgb>() / 64.0;
            let b = block.map(|(x, y)| reference(x, y)).sum::<Rgb>() / 64.0;
            errors.push(((a - b) * (a - b) / (b * b + 0.01)).element_sum() / 3.0);
            ours += a;
            theirs += b;
        }
    }
    errors.sort_unstable_by(f64::total_cmp);
    (ours / theirs, errors)
}

fn render(samples: u32) -> (Rgb, f64, f64) {
    let scene = room();
    let tracer = Tracer::new(&scene);
    let shown = Shown { stops: 0.0, tonemap: Tonemap::Neutral };
    let target = Target::Samples(samples);
    let rendered = tracer
        .render(Window::whole(SIZE), target, &tracer.prepass(), shown, &Control::new())
        .expect("nobody cancels");
    let (ratio, errors) = compare(&rendered.film);
    (ratio, errors.iter().sum::<f64>() / errors.len() as f64, errors[errors.len() / 2])
}

// With many samples the pictures agree (`cargo xtask e2e reference`): at 1280 a pixel the channels' means differ by at
// most 0.03 %, and the blocks' relMSE is 7.7e-5. So few as here leave noise of the caustic, which the bounds allow for.

#[test]
fn the_room_agrees_with_another_renderer() {
    let (_, _, coarse) = render(4);
    let (ratio, mean, median) = render(32);
    assert!((ratio - 1.0).abs().max_element() < 8e-3, "channel means differ: {ratio}");
    // The caustic's few bright samples rule the mean; the median shows how the error falls.
    assert!(mean < 8e-3, "blocks differ by {mean}");
    assert!(median < 0.3 * coarse, "eight times the samples brought {coarse} to {median}");
}
