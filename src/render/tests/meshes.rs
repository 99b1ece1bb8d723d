//! Triangle meshes.

use super::*;
use crate::asset::Mesh;
use crate::scene::shape::Instance;
use adapter::{Accel, Ray, intersect};
use std::sync::Arc;

/// A ball of triangles: an octahedron, each face of which is divided so often.
pub(super) fn ball(levels: u32) -> Arc<Mesh> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut triangles = Vec::new();
    for signs in 0..8u32 {
        let sign = |bit: u32| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let [a, b, c] = [0u32, 1, 2].map(|i| sign(i) * axes[i as usize]);
        triangles.push(if sign(0) * sign(1) * sign(2) > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..levels {
        let divide = |[a, b, c]: [DVec3; 3]| {
            let [d, e, f] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        triangles = triangles.into_iter().flat_map(divide).collect();
    }
    let mut text = String::new();
    for p in triangles.iter().flatten() {
        text += &format!("v {:?} {:?} {:?}\n", p.x, p.y, p.z);
    }
    for i in 0..triangles.len() {
        text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    Arc::new(Mesh::decode(text.as_bytes()).expect("it is sound"))
}

pub(super) fn mesh(mesh: &Arc<Mesh>, matrix: DMat3, at: DVec3, smooth: bool) -> Shape {
    Shape::Mesh(Box::new(Instance::new(mesh.clone(), *placed(matrix, at), smooth)))
}

fn skewed() -> DMat3 {
    DMat3::from_cols(v(0.8, 0.5, 0.1), v(-0.4, 0.9, 0.2), v(0.1, -0.3, -1.2))
}

#[test]
fn the_tree_of_a_mesh_finds_what_its_triangles_give() {
    let ball = ball(4);
    assert!(ball.is_closed() && ball.len() == 2048);
    let shape = mesh(&ball, skewed(), v(0.3, -0.2, 0.1), true);
    let Shape::Mesh(instance) = &shape else { unreachable!("it is one") };
    let accel = Accel::of(&scene(DVec3::ZERO, DVec3::Z).with(shape.clone(), white()));
    let mut random = Random(2);
    let mut met = 0;
    for _ in 0..4000 {
        let mut ray = Ray { origin: random.point(2.0), direction: random.direction(), start: None }.rounded();
        assert_eq!(accel.contains(PrimitiveId(0), ray.origin), shape.contains(ray.origin));
        // Through, from triangle to triangle.
        loop {
            let listed = (0..ball.len() as u32).filter_map(|i| crossed(instance.corners(i), &ray));
            let listed = listed.min_by(f64::total_cmp);
            let Some(hit) = accel.closest(&ray) else {
                assert_eq!(listed, None);
                break;
            };
            assert!(listed.is_some_and(|t| (t - hit.t).abs() < 1e-6), "{listed:?} {hit:?}");
            let point = accel.point(&ray, &hit);
            assert!(point.p.distance(ray.origin + hit.t * ray.direction) < 1e-6);
            let inside = shape.contains(ray.origin + 0.5 * hit.t * ray.direction);
            assert_eq!(point.n.dot(ray.direction) > 0.0, inside, "normals point out");
            ray = Ray { origin: point.p, start: Some(hit.place), ..ray };
            met += 1;
        }
    }
    assert!(met > 200, "{met}");
}

/// Where a ray goes through a triangle, if it does so ahead of what its start may be rounded by.
fn crossed([a, b, c]: [DVec3; 3], ray: &Ray) -> Option<f64> {
    let turn = |p: DVec3, q: DVec3| ray.direction.dot((p - ray.origin).cross(q - ray.origin));
    let sides = [turn(a, b), turn(b, c), turn(c, a)];
    let n = (b - a).cross(c - a);
    let t = n.dot(a - ray.origin) / n.dot(ray.direction);
    let through = sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0);
    (through && t > 1e-6).then_some(t)
}

#[test]
fn no_ray_passes_between_triangles() {
    // Aimed at corners and edges from the middle, where sloppy tests see gaps.
    let ball = ball(2);
    let shape = mesh(&ball, DMat3::IDENTITY, DVec3::ZERO, false);
    let mut random = Random(6);
    for triangle in 0..ball.len() as u32 {
        let [a, b, _] = ball.corners(triangle);
        for share in [0.0, 0.5, random.next(), random.next()] {
            for origin in [DVec3::ZERO, random.point(0.3)] {
                let direction = (a + share * (b - a) - origin).normalize();
                assert!(intersect(&shape, &Ray { origin, direction, start: None }, None).is_some());
            }
        }
    }
}

#[test]
fn a_smooth_mesh_is_lit_like_the_ball_it_stands_for() {
    let seen = |shape: Shape, material: Material| {
        let mut scene = scene(v(0.0, 0.0, 4.0), DVec3::ZERO)
            .with(shape, material)
            .with_light(Light::Point { position: v(3.0, 3.0, 4.0), intensity: Rgb::splat(20.0) })
            .bounces(1);
        scene.camera.half_extent = DVec2::splat(0.15);
        measure(&Tracer::new(&scene), 20_000).0
    };
    let ball = ball(4);
    for material in [white(), Material::Metal { color: Paint::Plain(Rgb::ONE), alpha: 0.3 }] {
        let round = seen(sphere(DVec3::ZERO, 1.0), material);
        let smooth = seen(mesh(&ball, DMat3::IDENTITY, DVec3::ZERO, true), material);
        assert!((smooth / round - 1.0).abs() < 0.01, "{smooth} {round}");
    }
}

#[test]
fn smooth_meshes_gain_no_light_and_lose_little() {
    for (material, least) in
        [(white(), 0.97), (glass(1.5), 0.97), (Material::Mirror { color: Paint::Plain(Rgb::ONE) }, 0.97)]
    {
        let shape = mesh(&ball(2), skewed(), DVec3::ZERO, true);
        let mut scene = scene(v(3.0, 2.5, 4.0), DVec3::ZERO).with(shape, material).with_sky(1.0).bounces(200);
        scene.camera.half_extent = DVec2::splat(0.2);
        let (mean, error) = measure(&Tracer::new(&scene), 20_000);
        assert!(mean < 1.0 + 5.0 * error + 1e-9 && mean > least, "{material:?}: {mean} ± {error}");
    }
}
