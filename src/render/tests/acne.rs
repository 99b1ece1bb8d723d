//! Rooms of giant spheres: no acne, no leaks.

use super::*;
use adapter::{Accel, Ray};

#[test]
fn nothing_leaves_a_room_of_giant_spheres() {
    let centers =
        [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].map(|axis| 1000.0 * axis);
    let room = centers
        .iter()
        .fold(scene(DVec3::ZERO, DVec3::Z), |scene, center| scene.with(sphere(*center, 940.0), white()));
    let accel = Accel::of(&room);
    let mut random = Random(3);
    let mut ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z, start: None };
    for i in 0..1_000_000 {
        let hit = accel.closest(&ray).expect("the room is closed");
        let last = ray.start.map(|start| start.primitive);
        assert_ne!(
            Some(hit.place.primitive),
            last,
            "bounce {i}: a convex wall is met again after {} m",
            hit.t
        );
        let point = accel.point(&ray, &hit);
        assert!(point.n.dot(ray.direction) < 0.0, "bounce {i}: a wall is met from behind");
        for center in centers {
            assert!(point.p.distance(center) > 940.0 - 1e-4, "bounce {i} is behind a wall: {}", point.p);
        }
        let (x, y) = crate::math::basis(point.n);
        let local = adapter::cosine(random.pair());
        let direction = (local.x * x + local.y * y + local.z * point.n).normalize();
        ray = Ray { origin: point.p, direction, start: Some(hit.place) };
    }
}

#[test]
fn no_light_leaks_into_a_room_of_giant_spheres_in_any_number_of_lanes() {
    let centers = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| 1000.0 * axis);
    let mut room = scene(DVec3::ZERO, v(0.3, 0.2, 1.0)).with_sky(1.0);
    for center in centers.iter().flat_map(|center| [*center, -*center]) {
        room = room.with(sphere(center, 940.0), white());
    }
    room.camera.half_extent = DVec2::splat(1.5);
    room.trace.size = [64, 64];
    let window = Window::whole(room.trace.size);
    for level in Level::ALL.into_iter().filter(|level| level.is_there()) {
        let tracer = Tracer::new(&room).on(level);
        let mut film = Film::new(window, 1.0);
        tracer.add_samples(&mut film, 0..16, &Control::new()).expect("nobody cancels");
        let lit =
            (0..64).flat_map(|y| (0..64).map(move |x| (x, y))).find(|&(x, y)| film.mean(x, y) != Rgb::ZERO);
        assert_eq!(lit, None, "{level:?}");
    }
}

#[test]
fn a_giant_glass_sphere_is_met_once_from_each_side() {
    let ball = scene(DVec3::ZERO, DVec3::Z).with(sphere(v(0.0, -940.0, 0.0), 940.0), glass(1.5));
    let accel = Accel::of(&ball);
    let mut random = Random(8);
    for _ in 0..100_000 {
        let top = v(random.within(-20.0, 20.0), 30.0, random.within(-20.0, 20.0));
        let down = v(random.within(-0.5, 0.5), -1.0, random.within(-0.5, 0.5)).normalize();
        let ray = Ray { origin: top, direction: down, start: None };
        let hit = accel.closest(&ray).expect("it is below");
        let point = accel.point(&ray, &hit);
        let inside = accel.closest(&Ray { origin: point.p, direction: down, start: Some(hit.place) });
        assert!(inside.is_some_and(|hit| hit.t > 100.0), "{inside:?}");
        let mirrored = down - 2.0 * down.dot(point.n) * point.n;
        assert!(
            accel.closest(&Ray { origin: point.p, direction: mirrored, start: Some(hit.place) }).is_none()
        );
    }
}
