//! POV-Ray 3.7, as its reference has it (<https://www.povray.org/documentation/>).
//!
//! It has no unit of light: a diffuse surface of colour c shows c · cosine · light, without 1/π and, by default,
//! without a fall-off. So lights are given divided by π; the fall-off 2 / (1 + (d/f)²) at a tiny f is 2f²/d². Its
//! quadrics are negative inside, as ours are. It traces light that comes straight from lights, and mirrors and
//! glass: `indirect: false`.

use super::triangles::Triangles;
use super::{Writer, cells, number, numbers, triangles};
use crate::color::Rgb;
use crate::math::{DAffine3, DVec3, PI};
use crate::scene::shape::{Form, Quadric};
use crate::scene::{Light, Material, Paint, Primitive, Projection, Shape, Texture};

/// The distance up to which light does not fall off, in sizes of the scene.
const NEAR: f64 = 1e-6;

/// By how much of a cell it takes a point for one further on.
const AHEAD: f64 = 1e-3;

/// How far below the surface a solid texture is seen, in cells.
const DEPTH: f64 = 1e-6;

pub(super) fn write(writer: &mut Writer) {
    let scene = writer.scene;
    let [width, height] = scene.trace.size;
    writer.put(format!("// povray +W{width} +H{height} +A0.01 +AM2 +FE +Iscene.pov"));
    writer.put("#version 3.7;");
    let depth = scene.trace.bounces.clamp(1, 256);
    writer.put(format!("global_settings {{ assumed_gamma 1 max_trace_level {depth} }}"));
    writer.put("#default { finish { ambient 0 diffuse 0 emission 0 } }");
    if scene.trace.indirect {
        writer.nearly(None, "has only estimates of indirect light", "it is left out");
    }
    camera(writer);
    scene.lights.iter().for_each(|light| lamp(writer, light));
    scene.primitives.iter().for_each(|primitive| surface(writer, primitive));
}

fn camera(writer: &mut Writer) {
    let camera = &writer.scene.camera;
    let kind = match camera.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    };
    let right = vector(2.0 * camera.half_extent.x * camera.right);
    let up = vector(2.0 * camera.half_extent.y * camera.up);
    let (at, forward) = (vector(camera.position), vector(camera.forward));
    let mut text = format!("camera {{ {kind} location {at} direction {forward} right {right} up {up}");
    if camera.lens_radius > 0.0 {
        let how = "the lens is sampled by a pattern";
        let (focus, aperture) = (camera.position + camera.focus * camera.forward, 2.0 * camera.lens_radius);
        let lens = format!(" aperture {} focal_point {}", number(aperture), vector(focus));
        if writer.nearly(None, "has another lens", how) {
            text += &format!("{lens} blur_samples 100 variance 0");
        }
    }
    writer.put(text + " }");
}

fn lamp(writer: &mut Writer, light: &Light) {
    let near = NEAR * super::size(writer.scene);
    // What 2f²/d² makes intensity/(π d²) of.
    let color = |intensity: Rgb| rgb(intensity / (2.0 * PI * near * near));
    let fading = format!("fade_distance {} fade_power 2", number(near));
    match light {
        Light::Point { position, intensity } => {
            let (at, color) = (vector(*position), color(*intensity));
            writer.put(format!("light_source {{ {at}, {color} {fading} }}"));
        }
        Light::Spot { position, direction, intensity, inner, outer } => {
            let degrees = |angle: f64| number(angle * 180.0 / PI);
            let (at, color, to) = (vector(*position), color(*intensity), vector(*position + *direction));
            let cone = format!("radius {} falloff {} tightness 0", degrees(*inner), degrees(*outer));
            writer.put(format!("light_source {{ {at}, {color} {fading} spotlight point_at {to} {cone} }}"));
        }
        Light::Sun { direction, irradiance, radius } => {
            let how = "it casts hard shadows and is not seen";
            if *radius == 0.0 || writer.nearly(None, "knows no suns with a disc", how) {
                let (from, color) = (vector(*direction), rgb(*irradiance / PI));
                writer.put(format!("light_source {{ {from}, {color} parallel point_at <0, 0, 0> }}"));
            }
        }
        Light::Sky { radiance, panorama: None } => {
            if writer.nearly(None, "has no light from the sky", "it is seen and gives no light") {
                writer.put(format!("background {{ {} }}", rgb(*radiance)));
            }
        }
        Light::Sky { panorama: Some(_), .. } => {
            writer.refuse(None, "has no light from the picture of a sky", None);
        }
    }
}

fn surface(writer: &mut Writer, primitive: &Primitive) {
    let Some(look) = material(writer, primitive) else { return };
    let text = match &primitive.shape {
        Shape::Sphere { center, radius } => format!("sphere {{ {}, {}", vector(*center), number(*radius)),
        Shape::Plane { point, normal } => {
            format!("plane {{ {}, {}", vector(*normal), number(normal.dot(*point)))
        }
        Shape::Disk(placed) => format!("disc {{ <0, 0, 0>, y, 1 {}", matrix(placed.world_from_object)),
        Shape::Box(placed) => format!("box {{ <-1, -1, -1>, <1, 1, 1> {}", matrix(placed.world_from_object)),
        Shape::Quadric(quadric) => self::quadric(quadric),
        Shape::Mesh(_) => mesh(&triangles::of(&primitive.shape, 0).unwrap_or_default()),
    };
    writer.put(format!("{text} {look} }}"));
}

fn mesh(triangles: &Triangles) -> String {
    let corner = |i: &usize| match triangles.normals.get(*i) {
        Some(normal) => format!("{}, {}", vector(triangles.corners[*i]), vector(*normal)),
        None => vector(triangles.corners[*i]),
    };
    let word = if triangles.normals.is_empty() { "triangle" } else { "smooth_triangle" };
    let triangle =
        |corners: &[usize; 3]| format!("{word} {{ {} }}", corners.each_ref().map(corner).join(", "));
    let all: Vec<String> = triangles.indices.iter().map(triangle).collect();
    format!("mesh {{ {}", all.join(" "))
}

fn quadric(quadric: &Quadric) -> String {
    let Form::Ellipsoid = quadric.form else { return cut(quadric) };
    format!("sphere {{ <0, 0, 0>, 1 {}", matrix(quadric.world_from_object))
}

/// Between its ends: with caps the solid between two planes, without the surface there.
fn cut(quadric: &Quadric) -> String {
    let [square, slope, constant] =
        [quadric.form.y_sign(), 2.0 * quadric.form.y_slope(), quadric.form.constant()].map(number);
    let surface = format!("quadric {{ <1, {square}, 1>, <0, 0, 0>, <0, {slope}, 0>, {constant}");
    let mut planes = vec![];
    if quadric.high.is_finite() {
        planes.push(format!("plane {{ y, {} }}", number(quadric.high)));
    }
    if quadric.low.is_finite() {
        planes.push(format!("plane {{ -y, {} }}", number(-quadric.low)));
    }
    let (planes, map) = (planes.join(" "), matrix(quadric.world_from_object));
    match (planes.is_empty(), quadric.capped) {
        (true, _) => format!("{surface} {map}"),
        (false, true) => format!("intersection {{ {surface} }} {planes} {map}"),
        (false, false) => format!("{surface} clipped_by {{ {planes} }} {map}"),
    }
}

fn material(writer: &mut Writer, primitive: &Primitive) -> Option<String> {
    let origin = Some(primitive.origin);
    Some(match *writer.scene.material(primitive) {
        Material::Diffuse { color } => painted(writer, primitive, color, &|color| {
            format!("pigment {{ {} }} finish {{ diffuse 1 }}", rgb(color))
        })?,
        Material::Mirror { color } => painted(writer, primitive, color, &|color| {
            format!("pigment {{ rgb 0 }} finish {{ reflection {{ {} }} }}", rgb(color))
        })?,
        Material::Metal { color, alpha } => {
            if alpha > 0.0 {
                writer.nearly(origin, "has no rough metals", "they are polished").then_some(())?;
            }
            // From the first colour, head-on, to the second by the fifth power: Schlick's.
            painted(writer, primitive, color, &|color| {
                format!("pigment {{ rgb 0 }} finish {{ reflection {{ {}, rgb 1 falloff 5 }} }}", rgb(color))
            })?
        }
        Material::Plastic { color, ior, .. } => {
            writer
                .nearly(origin, "has other plastics", "the base is not darkened by its coat")
                .then_some(())?;
            let coat = "reflection { 0, 1 fresnel on } conserve_energy";
            let base = painted(writer, primitive, color, &|color| {
                format!("pigment {{ {} }} finish {{ diffuse 1 {coat} }}", rgb(color))
            })?;
            format!("{base} interior {{ ior {} }}", number(ior))
        }
        Material::Dielectric { ior, absorption, alpha } => {
            if absorption != Rgb::ZERO {
                writer.nearly(origin, "has another absorption", "glass is clear").then_some(())?;
            }
            if alpha > 0.0 {
                writer.nearly(origin, "has no frosted glass", "it is polished").then_some(())?;
            }
            let glass =
                "pigment { rgbt <1, 1, 1, 1> } finish { reflection { 0, 1 fresnel on } conserve_energy }";
            format!("{glass} interior {{ ior {} }}", number(ior))
        }
        Material::Emitter { radiance, pattern } => {
            writer
                .nearly(origin, "has no light from glowing surfaces", "they are seen and give no light")
                .then_some(())?;
            let paint = pattern.map_or(Paint::Plain(Rgb::ONE), Paint::Texture);
            let glowing = painted(writer, primitive, paint, &|color| {
                format!("pigment {{ {} }} finish {{ emission 1 }}", rgb(radiance * color))
            })?;
            format!("{glowing} no_shadow")
        }
    })
}

/// A look that depends on a colour, or cells of such looks.
fn painted(
    writer: &mut Writer,
    primitive: &Primitive,
    paint: Paint,
    look: &dyn Fn(Rgb) -> String,
) -> Option<String> {
    match paint {
        Paint::Plain(color) => Some(look(color)),
        Paint::Texture(_) => texture(writer, primitive, paint, look, DAffine3::IDENTITY),
    }
}

/// A texture, in a space within those of the textures around it.
fn texture(
    writer: &mut Writer,
    primitive: &Primitive,
    paint: Paint,
    look: &dyn Fn(Rgb) -> String,
    world_from_around: DAffine3,
) -> Option<String> {
    let id = match paint {
        Paint::Plain(color) => return Some(format!("texture {{ {} }}", look(color))),
        Paint::Texture(id) => id,
    };
    let known = writer.scene.textures[id.0 as usize];
    let (a, b) = match known {
        Texture::Checker { a, b, .. } | Texture::Stripes { a, b, .. } => (a, b),
        Texture::Noise { .. } => {
            writer.refuse(Some(primitive.origin), "has other noise", None);
            return None;
        }
        Texture::Image { .. } => {
            writer.refuse(Some(primitive.origin), "lays pictures on surfaces otherwise", None);
            return None;
        }
    };
    if let Shape::Mesh(_) = primitive.shape {
        let how = "a flat part on a border may show the wrong one of two cells";
        writer
            .nearly(Some(primitive.origin), "sees solid textures of a mesh at its surface", how)
            .then_some(())?;
    }
    let cells = cells::world_from_cells(writer, primitive, &known, DEPTH)?;
    let world_from_here = cells * DAffine3::from_translation(DVec3::splat(AHEAD));
    let mut part = |paint| texture(writer, primitive, paint, look, world_from_here);
    let (a, b) = (part(a)?, part(b)?);
    let map = matrix(world_from_around.inverse() * world_from_here);
    Some(format!("texture {{ checker {a} {b} {map} }}"))
}

fn rgb(color: Rgb) -> String {
    format!("rgb {}", vector(color))
}

fn vector(v: DVec3) -> String {
    format!("<{}>", numbers(v.to_array(), ", "))
}

fn matrix(map: DAffine3) -> String {
    let m = map.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis, map.translation];
    format!("matrix <{}>", numbers(columns.iter().flat_map(|v| v.to_array()), ", "))
}
