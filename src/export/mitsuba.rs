//! Mitsuba 3, as its documentation of version 3 has it (<https://mitsuba.readthedocs.io>).
//!
//! A path of `bounces` scatterings has `bounces` + 1 segments: `max_depth`. A camera looks along +z with +x to the
//! left. Opaque materials are black from behind unless they are `twosided`.

mod paint;

use super::triangles::Triangles;
use super::{TESSELLATE, Writer, media, number, numbers, panorama, triangles};
use crate::color::Rgb;
use crate::math::{DAffine3, DMat3, DVec3, PI, atan2};
use crate::scene::shape::{Form, Placed, Quadric};
use crate::scene::{Filter, Light, Material, OriginId, Panorama, Primitive, Projection, Shape};
use paint::{Lay, paint};

/// The size of a plane's stand-in, in sizes of the scene.
const FAR: f64 = 1e4;

pub(super) fn write(writer: &mut Writer) {
    let scene = writer.scene;
    let absorbs = |material: &Material| matches!(material, Material::Dielectric { absorption, .. } if *absorption != Rgb::ZERO);
    let integrator = if scene.materials.iter().any(absorbs) { "volpath" } else { "path" };
    writer.put("<scene version=\"3.0.0\">");
    writer.put(format!("<integrator type=\"{integrator}\">"));
    writer.put(format!("<integer name=\"max_depth\" value=\"{}\"/>", scene.trace.bounces + 1));
    writer.put("<integer name=\"rr_depth\" value=\"64\"/>\n</integrator>");
    sensor(writer);
    scene.lights.iter().for_each(|light| lamp(writer, light));
    let around = media::surroundings(writer);
    for (primitive, around) in scene.primitives.iter().zip(around) {
        surface(writer, primitive, around);
    }
    writer.put("</scene>");
}

fn sensor(writer: &mut Writer) {
    let camera = &writer.scene.camera;
    let mut matrix = DMat3::from_cols(-camera.right, camera.up, camera.forward);
    let kind = match camera.projection {
        Projection::Orthographic => {
            // What is shown reaches from −1 to 1 across.
            matrix.x_axis *= camera.half_extent.x;
            matrix.y_axis *= camera.half_extent.x;
            "orthographic"
        }
        Projection::Perspective if camera.lens_radius > 0.0 => "thinlens",
        Projection::Perspective => "perspective",
    };
    let to_world = transform(matrix, camera.position);
    let degrees = 2.0 * atan2(camera.half_extent.x, 1.0) * 180.0 / PI;
    let lens = [("aperture_radius", camera.lens_radius), ("focus_distance", camera.focus)];
    let projection = camera.projection;
    writer.put(format!("<sensor type=\"{kind}\">\n{to_world}"));
    if projection == Projection::Perspective {
        writer.put("<string name=\"fov_axis\" value=\"x\"/>");
        float(writer, "fov", degrees);
    }
    float(writer, "near_clip", 1e-4);
    float(writer, "far_clip", 1e8);
    if kind == "thinlens" {
        lens.iter().for_each(|(name, value)| float(writer, name, *value));
    }
    let samples = writer.samples();
    writer.put(format!(
        "<sampler type=\"independent\"><integer name=\"sample_count\" value=\"{samples}\"/></sampler>"
    ));
    let [width, height] = writer.scene.trace.size;
    let filter = match writer.scene.trace.filter {
        Filter::Box => "box",
        Filter::Tent => "tent",
        Filter::Gaussian => "gaussian",
        Filter::Mitchell => "mitchell",
    };
    writer.put("<film type=\"hdrfilm\"><string name=\"pixel_format\" value=\"rgb\"/>");
    writer.put(format!(
        "<integer name=\"width\" value=\"{width}\"/><integer name=\"height\" value=\"{height}\"/>"
    ));
    writer.put(format!("<rfilter type=\"{filter}\"/></film>\n</sensor>"));
}

fn lamp(writer: &mut Writer, light: &Light) {
    match light {
        Light::Point { position, intensity } => {
            let (at, intensity) = (point("position", *position), rgb("intensity", *intensity));
            writer.put(format!("<emitter type=\"point\">{at}{intensity}</emitter>"));
        }
        Light::Spot { position, direction, intensity, inner, outer } => {
            let how = "its light falls off along the angle rather than smoothly";
            if *inner < *outer && !writer.nearly(None, "knows no smooth spots", how) {
                return;
            }
            let (x, y) = crate::math::basis(*direction);
            let to_world = transform(DMat3::from_cols(x, y, *direction), *position);
            let degrees = |angle: f64| number(angle * 180.0 / PI);
            // It divides by the width of the rim.
            let (beam, cutoff) = (degrees(inner.min(outer * (1.0 - 1e-6))), degrees(*outer));
            writer.put(format!("<emitter type=\"spot\">{to_world}{}", rgb("intensity", *intensity)));
            writer.put(format!("<float name=\"beam_width\" value=\"{beam}\"/>"));
            writer.put(format!("<float name=\"cutoff_angle\" value=\"{cutoff}\"/></emitter>"));
        }
        Light::Sun { direction, irradiance, radius } => {
            let how = "it casts hard shadows and is not seen";
            if *radius > 0.0 && !writer.nearly(None, "knows no suns with a disc", how) {
                return;
            }
            let [x, y, z] = (-*direction).to_array().map(number);
            let direction = format!("<vector name=\"direction\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
            let irradiance = rgb("irradiance", *irradiance);
            writer.put(format!("<emitter type=\"directional\">{direction}{irradiance}</emitter>"));
        }
        Light::Sky { radiance, panorama: None } => {
            writer.put(format!("<emitter type=\"constant\">{}</emitter>", rgb("radiance", *radiance)));
        }
        Light::Sky { radiance, panorama: Some(panorama) } => sky(writer, *radiance, panorama),
    }
}

/// Its picture has the centre at +z, ours at −z: half a turn about y. Its first and last rows lie on the poles.
fn sky(writer: &mut Writer, radiance: Rgb, panorama: &Panorama) {
    let image = &writer.scene.images[panorama.image.0 as usize];
    let name = format!("{}-sky.pfm", writer.options.stem);
    writer.out.files.push((name.clone(), panorama::with_rows_on_poles(image)));
    let half_turn = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0));
    let to_world = transform(panorama.image_from_world.transpose() * half_turn, DVec3::ZERO);
    // It has no colour besides its picture: all channels are the same.
    let scale = float_of("scale", radiance.x);
    writer.put(format!(
        "<emitter type=\"envmap\"><string name=\"filename\" value=\"{name}\"/>{scale}{to_world}</emitter>"
    ));
}

fn surface(writer: &mut Writer, primitive: &Primitive, around: f64) {
    if writer.scene.material(primitive).texture().is_some() {
        return paint::surface(writer, primitive);
    }
    let Some(material) = material(writer, primitive, around, None) else { return };
    let origin = Some(primitive.origin);
    match &primitive.shape {
        Shape::Sphere { center, radius } => {
            let radius = number(*radius);
            let inner = format!("{}<float name=\"radius\" value=\"{radius}\"/>", point("center", *center));
            shape(writer, "sphere", &inner, &material);
        }
        Shape::Plane { point, normal } => {
            let how = format!("it ends after {FAR} times the size of the scene");
            if writer.nearly(origin, "has no endless plane", &how) {
                let size = FAR * super::size(writer.scene);
                let (x, y) = crate::math::basis(*normal);
                let matrix = DMat3::from_cols(size * x, size * y, *normal);
                shape(writer, "rectangle", &transform(matrix, *point), &material);
            }
        }
        Shape::Disk(placed) => disk(writer, origin, placed.world_from_object, &material),
        Shape::Box(placed) => {
            let Placed { world_from_object: map, .. } = **placed;
            shape(writer, "cube", &transform(map.matrix3, map.translation), &material);
        }
        Shape::Mesh(_) => mesh(writer, &triangles::of(&primitive.shape, 0).unwrap_or_default(), &material),
        Shape::Quadric(quadric) => self::quadric(writer, primitive, quadric, &material),
    }
}

/// A disc is round in its z, and ours about y; a cyclic exchange of axes keeps the hand.
fn disk(writer: &mut Writer, origin: Option<OriginId>, map: DAffine3, material: &str) {
    let m = map.matrix3;
    if !is_right_angled(m) {
        return writer.refuse(origin, "has no slanted discs", None);
    }
    let matrix = DMat3::from_cols(m.z_axis, m.x_axis, m.y_axis);
    shape(writer, "disk", &transform(matrix, map.translation), material);
}

fn quadric(writer: &mut Writer, primitive: &Primitive, quadric: &Quadric, material: &str) {
    let m = quadric.world_from_object.matrix3;
    let round = is_right_angled(m) && (m.x_axis.length() / m.z_axis.length() - 1.0).abs() < 1e-9;
    if quadric.form == Form::Cylinder && round {
        let map = quadric.world_from_object;
        let [from, to] = [quadric.low, quadric.high].map(|y| map.transform_point3(y * DVec3::Y));
        let radius = number(m.x_axis.length());
        let ends = [point("p0", from), point("p1", to)].concat();
        shape(writer, "cylinder", &format!("{ends}<float name=\"radius\" value=\"{radius}\"/>"), material);
        if quadric.capped {
            let up = m.y_axis.normalize();
            let end = |at: DVec3, up: DVec3| {
                let (x, z) = (m.x_axis, up.cross(m.x_axis));
                DAffine3 { matrix3: DMat3::from_cols(z, up, x), translation: at }
            };
            disk(writer, Some(primitive.origin), end(from, -up), material);
            disk(writer, Some(primitive.origin), end(to, up), material);
        }
        return;
    }
    let what = "knows no quadrics but spheres and round cylinders";
    let Some(steps) = writer.options.tessellate else {
        return writer.refuse(Some(primitive.origin), what, Some(TESSELLATE));
    };
    match triangles::of(&primitive.shape, steps) {
        Some(triangles) => {
            writer.note(format!("Mitsuba {what}: they are triangles, {steps} around"));
            mesh(writer, &triangles, material);
        }
        None => writer.refuse(Some(primitive.origin), "has no endless surfaces", None),
    }
}

/// Triangles lie in a file of their own.
fn mesh(writer: &mut Writer, triangles: &Triangles, material: &str) {
    let name = format!("{}-{}.ply", writer.options.stem, writer.out.files.len());
    writer.out.files.push((name.clone(), triangles.ply().into_bytes()));
    let flat = triangles.normals.is_empty();
    let flat = format!("<boolean name=\"face_normals\" value=\"{flat}\"/>");
    shape(writer, "ply", &format!("<string name=\"filename\" value=\"{name}\"/>{flat}"), material);
}

fn shape(writer: &mut Writer, kind: &str, inner: &str, material: &str) {
    writer.put(format!("<shape type=\"{kind}\">{inner}\n{material}</shape>"));
}

/// The material of a shape and, where it glows, its emitter.
fn material(writer: &mut Writer, primitive: &Primitive, around: f64, lay: Option<&Lay>) -> Option<String> {
    let origin = Some(primitive.origin);
    let two_sided = |inner: String| format!("<bsdf type=\"twosided\">{inner}</bsdf>");
    Some(match writer.scene.material(primitive) {
        Material::Diffuse { color } => {
            let color = paint(writer, primitive, "reflectance", *color, lay)?;
            two_sided(format!("<bsdf type=\"diffuse\">{color}</bsdf>"))
        }
        Material::Mirror { color } => {
            let color = paint(writer, primitive, "specular_reflectance", *color, lay)?;
            let none = "<string name=\"material\" value=\"none\"/>";
            two_sided(format!("<bsdf type=\"conductor\">{none}{color}</bsdf>"))
        }
        Material::Metal { color, alpha } => {
            let color = paint(writer, primitive, "base_color", *color, lay)?;
            let how = "facets hide and shadow each other independently, and none is quite smooth";
            writer.nearly(origin, "has other metals", how).then_some(())?;
            let fields = [("metallic", 1.0), ("roughness", alpha.sqrt()), ("specular", 0.5)];
            let fields: String = fields.map(|(name, value)| float_of(name, value)).concat();
            two_sided(format!("<bsdf type=\"principled\">{color}{fields}</bsdf>"))
        }
        Material::Plastic { color, ior, alpha } => {
            let color = paint(writer, primitive, "diffuse_reflectance", *color, lay)?;
            let kind = rough(writer, origin, "plastic", *alpha)?;
            let fields = [float_of("int_ior", *ior), float_of("ext_ior", 1.0)].concat();
            let nonlinear = "<boolean name=\"nonlinear\" value=\"true\"/>";
            two_sided(format!("<bsdf {kind}{color}{fields}{nonlinear}</bsdf>"))
        }
        Material::Dielectric { ior, absorption, alpha } => {
            if absorption.max_element() == f64::INFINITY {
                writer.refuse(origin, "has no dielectric that absorbs everything", None);
                return None;
            }
            if *absorption != Rgb::ZERO && primitive.shape.contains(writer.scene.camera.position) {
                writer.refuse(origin, "is not told of a camera inside of an absorbing solid", None);
                return None;
            }
            let kind = rough(writer, origin, "dielectric", *alpha)?;
            let fields = [float_of("int_ior", *ior), float_of("ext_ior", around)].concat();
            let medium = format!(
                "<medium name=\"interior\" type=\"homogeneous\">{}{}</medium>",
                rgb("sigma_t", *absorption),
                rgb("albedo", Rgb::ZERO)
            );
            let medium = if *absorption == Rgb::ZERO { "" } else { &medium };
            format!("<bsdf {kind}{fields}</bsdf>{medium}")
        }
        Material::Emitter { radiance, pattern: None } => {
            if !primitive.shape.is_closed() {
                writer.refuse(origin, "has no surface that glows on both sides", None);
                return None;
            }
            let black = format!("<bsdf type=\"diffuse\">{}</bsdf>", rgb("reflectance", Rgb::ZERO));
            format!("{black}<emitter type=\"area\">{}</emitter>", rgb("radiance", *radiance))
        }
        Material::Emitter { pattern: Some(_), .. } => {
            writer.refuse(origin, "is not told of glowing surfaces with textures", None);
            return None;
        }
    })
}

/// The type of a material and its roughness, up to the end of the tag that opens it.
fn rough(writer: &mut Writer, origin: Option<OriginId>, kind: &str, alpha: f64) -> Option<String> {
    if alpha == 0.0 {
        return Some(format!("type=\"{kind}\">"));
    }
    let how = "facets hide and shadow each other independently";
    writer.nearly(origin, "has other rough surfaces", how).then_some(())?;
    let ggx = "<string name=\"distribution\" value=\"ggx\"/>";
    Some(format!("type=\"rough{kind}\">{ggx}{}", float_of("alpha", alpha)))
}

fn is_right_angled(m: DMat3) -> bool {
    let cosine = |a: DVec3, b: DVec3| (a.dot(b) / (a.length() * b.length())).abs();
    cosine(m.x_axis, m.y_axis).max(cosine(m.y_axis, m.z_axis)).max(cosine(m.z_axis, m.x_axis)) < 1e-9
}

fn float(writer: &mut Writer, name: &str, value: f64) {
    let line = float_of(name, value);
    writer.put(line);
}

fn float_of(name: &str, value: f64) -> String {
    format!("<float name=\"{name}\" value=\"{}\"/>", number(value))
}

fn rgb(name: &str, color: Rgb) -> String {
    format!("<rgb name=\"{name}\" value=\"{}\"/>", numbers(color.to_array(), ", "))
}

fn point(name: &str, p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(number);
    format!("<point name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
}

/// A map to the world, row by row.
fn transform(m: DMat3, origin: DVec3) -> String {
    let rows = [0, 1, 2].map(|i| numbers([m.x_axis[i], m.y_axis[i], m.z_axis[i], origin[i]], " "));
    format!("<transform name=\"to_world\"><matrix value=\"{} 0 0 0 1\"/></transform>", rows.join(" "))
}
