//! The scene as a flat text in the language, which compiles to the same scene, bit for bit.
//!
//! Loops, parts, prototypes, groups, imports and names are gone; what is left are the surfaces and lights in their
//! order, one statement each, and the one camera that takes the picture. Numbers are written with the fewest digits
//! that read back as the same number. What lowering computes from other numbers is written such that it computes
//! the same again:
//!
//! - Quadrics have unit axes and the whole of their map in `place: matrix(…)`.
//! - A direction of length 1 is kept by lowering. So that the camera's survives the difference of two points, it
//!   looks at a point so far away along it that its own place is lost in rounding.
//! - Where lowering divides or takes a tangent, the number is searched that leads to the one wanted. There is one,
//!   since the scene came from a text.

use crate::color::Rgb;
use crate::math::{DAffine3, DMat3, DVec3, PI, atan2, sin, tan};
use crate::scene::shape::{Form, Quadric};
use crate::scene::{
    Camera, Develop, Light, Material, Paint, Primitive, Projection, Scene, Shape, Target, Trace,
};
use std::fmt::Write;

/// Writes a scene as a text.
///
/// # Errors
///
/// Why there is none: textures and the pictures of skies are placed by maps that only the text they came from has.
pub fn expand(scene: &Scene) -> Result<String, &'static str> {
    if !scene.textures.is_empty() || !scene.images.is_empty() {
        return Err("it has textures or pictures, whose places only the scene's own text says");
    }
    if scene.primitives.iter().any(|primitive| matches!(primitive.shape, Shape::Mesh(_))) {
        return Err("it has meshes, whose files only the scene's own text names");
    }
    let mut text = String::new();
    let names = name_materials(scene, &mut text);
    for primitive in &scene.primitives {
        surface(&mut text, scene, primitive, &names);
    }
    scene.lights.iter().for_each(|light| lamp(&mut text, light));
    camera(&mut text, &scene.camera, &scene.develop);
    render(&mut text, &scene.trace, &scene.develop);
    Ok(text)
}

/// Declares the materials that several surfaces share; the others are written where they are used.
fn name_materials(scene: &Scene, text: &mut String) -> Vec<Option<String>> {
    let mut uses = vec![0u32; scene.materials.len()];
    scene.primitives.iter().for_each(|primitive| uses[primitive.material.0 as usize] += 1);
    let shared = uses.iter().map(|uses| *uses > 1).enumerate();
    let names: Vec<Option<String>> =
        shared.map(|(index, shared)| shared.then(|| format!("surface{index}"))).collect();
    for (name, material) in names.iter().zip(&scene.materials) {
        if let Some(name) = name {
            put(text, format_args!("material {name} = {}", made(material)));
        }
    }
    names
}

fn made(material: &Material) -> String {
    match material {
        Material::Diffuse { color } => format!("diffuse {{ color: {} }}", paint(*color)),
        Material::Mirror { color } => format!("mirror {{ color: {} }}", paint(*color)),
        Material::Dielectric { ior, absorption, alpha } => {
            // What absorbs everything has no number; a tint of 0 says it.
            let tint = absorption.to_array().map(|a| if a == f64::INFINITY { 0.0 } else { 1.0 });
            let rest = absorption.to_array().map(|a| if a == f64::INFINITY { 0.0 } else { a });
            let mut fields = format!("ior: {}", number(*ior));
            if tint != [1.0; 3] {
                fields += &format!(", tint: {}", rgb(Rgb::from_array(tint)));
            }
            if rest != [0.0; 3] {
                fields += &format!(", absorption: {}", rgb(Rgb::from_array(rest)));
            }
            format!("dielectric {{ {fields}{} }}", roughness(*alpha))
        }
        Material::Metal { color, alpha } => {
            format!("metal {{ color: {}{} }}", paint(*color), roughness(*alpha))
        }
        Material::Plastic { color, ior, alpha } => {
            format!("plastic {{ color: {}, ior: {}{} }}", paint(*color), number(*ior), roughness(*alpha))
        }
        Material::Emitter { radiance, pattern: None } => {
            format!("emitter {{ color: {}, radiance: 1W/m2 }}", rgb(*radiance))
        }
        Material::Emitter { radiance, pattern: Some(pattern) } => {
            let color = paint(Paint::Texture(*pattern));
            format!("emitter {{ color: {color}, radiance: {}W/m2 }}", number(radiance.x))
        }
    }
}

fn paint(paint: Paint) -> String {
    match paint {
        Paint::Plain(color) => rgb(color),
        Paint::Texture(id) => format!("texture{}", id.0),
    }
}

/// α = roughness², and the root of a rounded square is the number itself.
fn roughness(alpha: f64) -> String {
    if alpha == 0.0 { String::new() } else { format!(", roughness: {}", number(alpha.sqrt())) }
}

fn surface(text: &mut String, scene: &Scene, primitive: &Primitive, names: &[Option<String>]) {
    let material = match &names[primitive.material.0 as usize] {
        Some(name) => name.clone(),
        None => made(scene.material(primitive)),
    };
    match &primitive.shape {
        Shape::Sphere { center, radius } => {
            let (at, radius) = (at(*center), number(*radius));
            put(text, format_args!("sphere {{ {at}radius: {radius}m, material: {material} }}"));
        }
        Shape::Plane { point, normal } => {
            let (at, normal) = (at(*point), triple(*normal));
            put(text, format_args!("plane {{ {at}normal: {normal}, material: {material} }}"));
        }
        Shape::Quadric(quadric) => self::quadric(text, quadric, &material),
        // Refused above.
        Shape::Mesh(_) => {}
        Shape::Disk(placed) => {
            // Lowering turns the axes of a disk such that its normal is y.
            let DAffine3 { matrix3: m, translation } = placed.world_from_object;
            let place = matrix(DMat3::from_cols(m.z_axis, m.y_axis, -m.x_axis), translation);
            put(text, format_args!("disk {{ radius: 1m, place: {place}, material: {material} }}"));
        }
        Shape::Box(placed) => {
            let place = matrix(placed.world_from_object.matrix3, placed.world_from_object.translation);
            put(text, format_args!("box {{ size: (2, 2, 2)m, place: {place}, material: {material} }}"));
        }
    }
}

fn quadric(text: &mut String, quadric: &Quadric, material: &str) {
    let DAffine3 { matrix3, mut translation } = quadric.world_from_object;
    let open = if quadric.capped || quadric.high == f64::INFINITY { "" } else { ", open: true" };
    let mut kind = match quadric.form {
        Form::Ellipsoid => "sphere { radius: 1m".to_string(),
        Form::OneSheet => format!("hyperboloid {{ axes: (1, 1, 1)m, sheets: 1{}", height(quadric)),
        Form::TwoSheet => format!("hyperboloid {{ axes: (1, 1, 1)m, sheets: 2{}", height(quadric)),
        Form::Paraboloid => "paraboloid { radius: 1m, height: 1m".to_string(),
        Form::Cylinder => "cylinder { radius: 1m, height: 1m".to_string(),
        Form::Cone => {
            // The apex, where object space has its origin, is at a height of 1 or −1 in the one it is written in.
            let (apex, top) = (-quadric.low, quadric.high.abs());
            translation = lowered(translation, apex * matrix3.y_axis);
            let height = (1.0 - top).abs();
            format!("cone {{ radius: 1m, height: {}m, top: {}m", number(height), number(top))
        }
    };
    // A sphere has no ends to close.
    if quadric.form != Form::Ellipsoid {
        kind += open;
    }
    put(text, format_args!("{kind}, place: {}, material: {material} }}", matrix(matrix3, translation)));
}

/// The field that ends a quadric at the same distance on both sides.
fn height(quadric: &Quadric) -> String {
    match quadric.high {
        f64::INFINITY => String::new(),
        high => format!(", height: {}m", number(2.0 * high)),
    }
}

/// The point that a step takes to another, in rounded numbers.
fn lowered(p: DVec3, step: DVec3) -> DVec3 {
    let part = |i: usize| preimage(p[i], p[i] - step[i], |x| step[i] + x);
    DVec3::new(part(0), part(1), part(2))
}

fn lamp(text: &mut String, light: &Light) {
    match light {
        Light::Point { position, intensity } => {
            // Intensity is power over 4π.
            let power = intensity.to_array().map(|i| preimage(i, 4.0 * PI * i, |power| power / (4.0 * PI)));
            let (at, color) = (at(*position), rgb(Rgb::from_array(power)));
            put(text, format_args!("light {{ {at}power: 1W, color: {color} }}"));
        }
        Light::Spot { position, direction, intensity, inner, outer } => {
            // As lowering counts the solid angle of the cone.
            let height = |angle: f64| {
                let sine = sin(0.5 * angle);
                2.0 * sine * sine
            };
            let angle = PI * (height(*inner) + height(*outer));
            let power = intensity.to_array().map(|i| preimage(i, i * angle, |power| power / angle));
            let soft = preimage(*inner, 1.0 - inner / outer, |soft| (1.0 - soft) * outer);
            let aim = triple(far_along(*position, *direction));
            let (at, color, cone) = (at(*position), rgb(Rgb::from_array(power)), number(2.0 * outer));
            let soft = number(soft.clamp(0.0, 1.0));
            let fields = format!("{at}power: 1W, color: {color}, aim: {aim}m, cone: {cone}rad, soft: {soft}");
            put(text, format_args!("light {{ {fields} }}"));
        }
        Light::Sun { direction, irradiance, radius } => {
            let (from, color, angle) = (triple(*direction), rgb(*irradiance), number(2.0 * radius));
            let fields = format!("from: {from}, irradiance: 1W/m2, angle: {angle}rad, color: {color}");
            put(text, format_args!("sun {{ {fields} }}"));
        }
        Light::Sky { radiance, .. } => put(text, format_args!("sky {{ color: {} }}", rgb(*radiance))),
    }
}

fn camera(text: &mut String, camera: &Camera, develop: &Develop) {
    let half_width = camera.half_extent.x;
    let extent = match camera.projection {
        Projection::Perspective => {
            let fov = preimage(half_width, 2.0 * atan2(half_width, 1.0), |fov| tan(0.5 * fov));
            format!("fov: {}rad", number(fov))
        }
        Projection::Orthographic => format!("width: {}m", number(2.0 * half_width)),
    };
    let look = far_along(camera.position, camera.forward);
    let (from, look, up) = (triple(camera.position), triple(look), triple(camera.up));
    let exposure = develop.exposure.map_or("auto".to_string(), number);
    let mut fields = format!("from: {from}m, look: {look}m, up: {up}, {extent}, exposure: {exposure}");
    if camera.lens_radius != 0.0 || camera.focus != 1.0 {
        let (aperture, focus) = (number(2.0 * camera.lens_radius), number(camera.focus));
        fields += &format!(", lens {{ aperture: {aperture}m, focus: {focus}m }}");
    }
    put(text, format_args!("camera {{ {fields} }}"));
}

/// A point whose difference to another, in rounded numbers, is a power of two times a direction.
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

fn render(text: &mut String, trace: &Trace, develop: &Develop) {
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
    put(text, format_args!("render {{ {} }}", fields.join(", ")));
}

/// How many numbers on each side of a guess are tried.
const TRIES: usize = 64;

/// A number that a function takes to another, near a guess; the guess itself, if none is.
fn preimage(wanted: f64, guess: f64, function: impl Fn(f64) -> f64) -> f64 {
    let up = std::iter::successors(Some(guess), |x| Some(x.next_up())).take(TRIES);
    let down = std::iter::successors(Some(guess), |x| Some(x.next_down())).take(TRIES);
    let mut near = up.zip(down).flat_map(|(above, below)| [above, below]);
    near.find(|x| function(*x) == wanted).unwrap_or(guess)
}

/// Adds a line.
fn put(text: &mut String, line: std::fmt::Arguments) {
    // A string takes whatever is written to it.
    let _ = writeln!(text, "{line}");
}

/// The field `at`, unless it is the default.
fn at(p: DVec3) -> String {
    if p == DVec3::ZERO { String::new() } else { format!("at: {}m, ", triple(p)) }
}

fn matrix(m: DMat3, origin: DVec3) -> String {
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(triple).join(", ");
    format!("matrix({axes}, {}m)", triple(origin))
}

fn rgb(color: Rgb) -> String {
    format!("rgb{}", triple(color))
}

fn triple(v: DVec3) -> String {
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

/// The fewest digits that read back as the same number.
fn number(x: f64) -> String {
    let text = format!("{x:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        for (x, text) in [(1.0, "1"), (-0.5, "-0.5"), (1e-7, "1e-7"), (0.1, "0.1"), (1e300, "1e300")] {
            assert_eq!(number(x), text);
        }
    }

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
}
