//! Triangle meshes.

use super::*;
use crate::asset::Mesh;
use crate::scene::shape::Instance;
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
