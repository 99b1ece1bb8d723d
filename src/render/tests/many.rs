//! Scenes of many surfaces.

use super::adapter::{Accel, Ray};
use super::*;

#[test]
fn any_number_of_surfaces_may_be_in_one_place() {
    let mut scene = scene(DVec3::ZERO, DVec3::Z);
    // They cannot be parted by place; those of growing size have their middle in common at least.
    for i in 0..20_000 {
        let size = if i < 10_000 { 1.0 } else { 1.0 - 1e-6 * f64::from(i) };
        scene = scene.with(sphere(v(0.0, 0.0, 5.0), size), glass(1.5));
    }
    let accel = Accel::of(&scene);
    let ray = Ray { origin: v(0.0, 0.1, 0.0), direction: DVec3::Z, start: None };
    let hit = accel.closest(&ray).expect("they are right ahead");
    assert_eq!(hit.place.primitive, PrimitiveId(0));
    assert!(accel.occluded(&ray, 5.0) && !accel.occluded(&ray, 4.0));
}

#[test]
fn rays_meet_as_much_in_any_number_of_lanes() {
    let mut random = Random(5);
    let mut scene = scene(DVec3::ZERO, DVec3::Z);
    scene.camera.half_extent = DVec2::ONE;
    for i in 0..600 {
        let (at, size) = (random.point(10.0), random.within(0.05, 0.8));
        let shape = if i % 5 == 0 {
            Shape::Box(placed(DMat3::from_diagonal(DVec3::splat(size)), at))
        } else {
            sphere(at, size)
        };
        scene = scene.with(shape, glass(1.5));
    }
    let counts = |level| {
        let tracer = Tracer::new(&scene).on(level);
        let strays = tracer.strays(20_000, 5);
        assert!(tracer.hierarchy().is_some_and(|bytes| bytes < 100 * 600));
        [None, Some(f32::INFINITY), Some(3.0)].map(|within| tracer.cast(&strays, within))
    };
    let [met, hidden, near] = counts(Level::One);
    assert!(met == hidden && 0 < near && near < met, "{met} {hidden} {near}");
    for level in Level::ALL.into_iter().filter(|level| level.is_there()) {
        assert_eq!(counts(level), [met, hidden, near], "{level:?}");
    }
}
