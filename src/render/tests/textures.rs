//! Colour by place, and glowing patterns.

use super::*;
use crate::asset::Image;
use crate::math::{DAffine3, cos, sin};
use crate::render::exact::SurfacePoint;
use crate::render::path::Sharing;
use crate::render::shape::Face;
use crate::render::texture::{Spot, clouds, paint};
use crate::scene::shape::Placed;
use crate::scene::{FrameId, ImageId, Paint, Texture, TextureId};
use std::sync::Arc;

const BLACK: Paint = Paint::Plain(Rgb::ZERO);
const WHITE: Paint = Paint::Plain(Rgb::ONE);

/// A scene of one painted primitive in a frame.
fn painted(shape: Shape, texture: Texture, world_from_object: DAffine3) -> Scene {
    let material = Material::Diffuse { color: Paint::Texture(TextureId(0)) };
    let mut scene = scene(v(0.0, 0.0, 9.0), DVec3::ZERO).with(shape, material);
    scene.textures.push(texture);
    let object_from_world = world_from_object.inverse();
    scene.frames.push(Placed { world_from_object, object_from_world });
    Arc::make_mut(&mut scene.primitives)[0].frame = Some(FrameId(0));
    scene
}

fn shown(scene: &Scene, face: Face, p: DVec3, n: DVec3) -> Rgb {
    let point = SurfacePoint::new(p, n);
    let spot = Spot::new(scene, &scene.primitives[0], face, &point);
    paint(scene, Paint::Texture(TextureId(scene.textures.len() as u32 - 1)), &spot)
}

/// Four pixels: red and green above, blue and white below.
fn four() -> Arc<Image> {
    let pixels = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    Arc::new(Image::new(2, 2, pixels).unwrap())
}

fn pictured(shape: Shape) -> Scene {
    let texture = Texture::Image { image: ImageId(0), size: DVec2::ONE };
    let mut scene = painted(shape, texture, DAffine3::IDENTITY);
    scene.images.push(four());
    scene
}

#[test]
fn a_checker_on_the_border_of_its_cells_does_not_flicker() {
    let checker = Texture::Checker { a: WHITE, b: BLACK, size: 0.5 };
    let scene = painted(floor(), checker, DAffine3::IDENTITY);
    let mut random = Random(3);
    for _ in 0..10_000 {
        let (x, z) = (random.within(-50.0, 50.0), random.within(-50.0, 50.0));
        let p = v(x, random.within(-1e-13, 1e-13), z);
        let cells = (x / 0.5).floor() + (z / 0.5).floor();
        // The layer below the plane is the odd one.
        let expected = if cells.rem_euclid(2.0) == 1.0 { Rgb::ONE } else { Rgb::ZERO };
        assert_eq!(shown(&scene, Face::Side, p, DVec3::Y), expected, "{p}");
    }
}

#[test]
fn a_texture_moves_turns_and_grows_with_its_thing() {
    let stripes = Texture::Stripes { a: WHITE, b: BLACK, width: 1.0, along: DVec3::X };
    let turn = DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z);
    let placed = DAffine3::from_mat3_translation(3.0 * turn, v(10.0, 20.0, 30.0));
    let scene = painted(sphere(v(10.0, 20.0, 30.0), 6.0), stripes, placed);
    for (along, expected) in [(-5.0, 1.0), (-2.0, 0.0), (2.0, 1.0), (5.0, 0.0)] {
        let p = v(10.0, 20.0 + along, 30.0);
        assert_eq!(shown(&scene, Face::Side, p, DVec3::Z), Rgb::splat(expected), "{along}");
    }
}

#[test]
fn clouds_fill_the_range_evenly_and_are_the_same_bits_everywhere() {
    let mut random = Random(5);
    for octaves in [1, 4, 16] {
        let (mut sum, mut squares, mut cut) = (0.0, 0.0, 0.0);
        const COUNT: f64 = 40_000.0;
        for _ in 0..COUNT as usize {
            let t = clouds(random.point(100.0), octaves, 7);
            assert!((0.0..=1.0).contains(&t));
            sum += t / COUNT;
            squares += (t - 0.5) * (t - 0.5) / COUNT;
            cut += if t == 0.0 || t == 1.0 { 1.0 / COUNT } else { 0.0 };
        }
        assert!((sum - 0.5).abs() < 0.01 && (0.15..0.3).contains(&squares.sqrt()), "{sum} {squares}");
        assert!(cut < 0.03, "{cut}");
    }
    let near = |p: DVec3| clouds(p, 4, 7);
    assert!((near(v(0.3, 0.4, 0.5)) - near(v(0.3 + 1e-9, 0.4, 0.5))).abs() < 1e-7);
    assert_ne!(clouds(v(0.3, 0.4, 0.5), 4, 7), clouds(v(0.3, 0.4, 0.5), 4, 8));
    assert_eq!(clouds(v(0.3, -4.2, 1e3), 4, 7).to_bits(), 4_606_043_098_157_386_303);
    for far in [1e18, 1e300, f64::INFINITY, f64::NAN] {
        assert!((0.0..=1.0).contains(&clouds(DVec3::splat(far), 16, 0)));
    }
}

#[test]
fn a_picture_is_upright_on_flat_faces_seen_from_outside() {
    let up_down = [(DVec3::Y, DVec3::X, DVec3::NEG_Z), (DVec3::NEG_Y, DVec3::X, DVec3::Z)];
    let walls = [DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::NEG_X].map(|n| (n, DVec3::Y.cross(n), DVec3::Y));
    for (n, right, up) in up_down.into_iter().chain(walls) {
        let scene = pictured(Shape::Plane { point: DVec3::ZERO, normal: n });
        let at = |x: f64, y: f64| shown(&scene, Face::Side, x * right + y * up, n);
        // Middles of pixels, and the next copies.
        assert!((at(-0.25, 0.25) - Rgb::X).length() < 1e-12, "{n}");
        assert!((at(0.25, 0.25) - Rgb::Y).length() < 1e-12, "{n}");
        assert!((at(-0.25, -0.25) - Rgb::Z).length() < 1e-12, "{n}");
        assert!((at(1.75, -2.25) - Rgb::Z).length() < 1e-12, "{n}");
        assert!((at(0.0, 0.25) - Rgb::new(0.5, 0.5, 0.0)).length() < 1e-12, "{n}");
    }
}

#[test]
fn a_picture_lies_around_spheres_and_towers() {
    let ball = pictured(sphere(DVec3::ZERO, 2.0));
    let tower =
        quadric(Form::OneSheet, DMat3::from_diagonal(v(1.0, 2.0, 1.0)), DVec3::ZERO, [-1.0, 1.0], false);
    let tower = pictured(Shape::Quadric(tower));
    // From its vertex, which no cut makes, to its rim.
    let bowl = quadric(
        Form::Paraboloid,
        DMat3::from_diagonal(v(1.0, 2.0, 1.0)),
        -DVec3::Y,
        [-f64::INFINITY, 1.0],
        true,
    );
    let bowl = pictured(Shape::Quadric(bowl));
    for (scene, height) in [(ball, 1.0), (tower, 1.0), (bowl, 0.9)] {
        let at = |longitude: f64, y: f64| {
            let p = v(sin(longitude), y * height, cos(longitude));
            shown(&scene, Face::Side, p, p.normalize())
        };
        // Left of +z, as one looks at it, lies −x.
        assert!((at(-0.5 * PI, 1.0) - Rgb::X).length() < 0.6 && at(-0.5 * PI, 1.0).y < 1e-12);
        assert!(at(0.5 * PI, 1.0).x < 1e-12 && at(0.5 * PI, 1.0).y > 0.4);
        assert!(at(-0.5 * PI, -1.0).z > 0.4);
        // No seam where the edges meet: both sides show the same.
        assert!((at(PI - 1e-9, 0.3) - at(1e-9 - PI, 0.3)).length() < 1e-6);
    }
}

/// A floor under a lamp that glows in stripes.
fn patterned(shape: Shape) -> Scene {
    let mut scene = scene(v(0.0, 0.3, 0.0), DVec3::ZERO).with(floor(), white()).bounces(1);
    scene = scene.with(shape, Material::Emitter { radiance: Rgb::splat(3.0), pattern: Some(TextureId(0)) });
    scene.textures.push(Texture::Stripes { a: WHITE, b: BLACK, width: 0.3, along: DVec3::X });
    let [world_from_object, object_from_world] = [DAffine3::IDENTITY; 2];
    scene.frames.push(Placed { world_from_object, object_from_world });
    Arc::make_mut(&mut scene.primitives)[1].frame = Some(FrameId(0));
    scene
}

#[test]
fn a_glowing_pattern_is_gathered_as_it_is_found() {
    let lying = quadric(Form::OneSheet, 0.5 * DMat3::IDENTITY, v(0.4, 1.5, 0.2), [-1.0, 1.0], true);
    for shape in [sphere(v(0.3, 1.2, 0.1), 0.5), Shape::Quadric(lying)] {
        let scene = patterned(shape);
        let results = [Sharing::Both, Sharing::OnlyGathered, Sharing::OnlyFound].map(|sharing| {
            let mut tracer = Tracer::new(&scene);
            tracer.sharing = sharing;
            measure(&tracer, 60_000)
        });
        let (shared, error) = results[0];
        assert!(shared > 0.0);
        for (mean, other) in &results[1..] {
            assert!((shared - mean).abs() < 5.0 * (error + other), "{results:?}");
        }
    }
}

#[test]
fn means_and_peaks_of_textures_are_theirs() {
    let mut scene = pictured(floor());
    scene.textures.push(Texture::Checker { a: Paint::Texture(TextureId(0)), b: WHITE, size: 1.0 });
    assert!((scene.mean(Paint::Texture(TextureId(0))) - Rgb::splat(0.5)).length() < 1e-12);
    assert!((scene.mean(Paint::Texture(TextureId(1))) - Rgb::splat(0.75)).length() < 1e-12);
    assert_eq!(scene.peak(Paint::Texture(TextureId(1))), Rgb::ONE);
    assert_eq!(scene.peak(Paint::Plain(Rgb::X)), Rgb::X);
}

#[test]
fn the_hash_of_a_scene_sees_what_it_is_painted_with() {
    let scene = pictured(floor());
    let mut changed = scene.clone();
    changed.images[0] = Arc::new(Image::new(1, 1, vec![[0.5; 3]]).unwrap());
    assert_ne!(scene.hash(), changed.hash());
    let mut moved = scene.clone();
    moved.frames[0].object_from_world.translation.x = 1.0;
    assert_ne!(scene.hash(), moved.hash());
    let mut again = scene.clone();
    again.images[0] = four();
    assert_eq!(scene.hash(), again.hash());
}

#[test]
fn what_is_painted_far_out_or_tiny_stays_a_colour() {
    for texture in [
        Texture::Checker { a: WHITE, b: BLACK, size: 1e-300 },
        Texture::Stripes { a: WHITE, b: BLACK, width: 1e-300, along: DVec3::X },
        Texture::Noise { a: WHITE, b: BLACK, size: 1e-300, octaves: 3, seed: 0 },
        Texture::Image { image: ImageId(0), size: DVec2::splat(1e-300) },
    ] {
        for scale in [1e-150, 1.0, 1e150] {
            let mut scene = painted(floor(), texture, DAffine3::from_scale(DVec3::splat(scale)));
            scene.images.push(four());
            let color = shown(&scene, Face::Side, v(1e200, 0.0, -3.0), DVec3::Y);
            assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0, "{texture:?}: {color}");
        }
    }
}
