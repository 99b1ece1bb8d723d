//! pbrt-v4, as its file format page has it (<https://pbrt.org/fileformat-v4>).
//!
//! Its camera space is left-handed: +x to the right, +y up, +z into the picture. The screen window of a 90° camera is
//! in tangents, as [`crate::scene::Camera::half_extent`] is. `maxdepth` counts scatterings, as `bounces` does.

use super::triangles::Triangles;
use super::{TESSELLATE, Writer, cells, media, number, numbers, triangles};
use crate::color::Rgb;
use crate::math::{DAffine3, DMat3, DVec3, PI};
use crate::scene::shape::{Form, Quadric};
use crate::scene::{Filter, Light, Material, Paint, Primitive, Projection, Shape, Texture};

/// The size of a plane's stand-in, in sizes of the scene.
const FAR: f64 = 1e4;

/// How far below the surface a solid texture is seen, in cells: well beyond the rounding of 32 bits.
const DEPTH: f64 = 1e-3;

pub(super) fn write(writer: &mut Writer) {
    camera(writer);
    writer.put("WorldBegin");
    writer.scene.lights.iter().for_each(|light| lamp(writer, light));
    let around = media::surroundings(writer);
    for (primitive, around) in writer.scene.primitives.iter().zip(around) {
        writer.put("AttributeBegin");
        if material(writer, primitive, around).is_some() {
            shape(writer, primitive);
        }
        writer.put("AttributeEnd");
    }
}

fn camera(writer: &mut Writer) {
    let scene = writer.scene;
    let camera = &scene.camera;
    let rows = DMat3::from_cols(camera.right, camera.up, camera.forward).transpose();
    transform(writer, DAffine3 { matrix3: rows, translation: -(rows * camera.position) });
    let half = camera.half_extent;
    let window = numbers([-half.x, half.x, -half.y, half.y], " ");
    let kind = match camera.projection {
        Projection::Perspective => "\"perspective\" \"float fov\" 90",
        Projection::Orthographic => "\"orthographic\"",
    };
    let (radius, focus) = (number(camera.lens_radius), number(camera.focus));
    writer.put(format!("Camera {kind} \"float screenwindow\" [{window}]"));
    writer.put(format!("  \"float lensradius\" {radius} \"float focaldistance\" {focus}"));
    let [width, height] = scene.trace.size;
    writer.put(format!("Film \"rgb\" \"integer xresolution\" {width} \"integer yresolution\" {height}"));
    writer.put("  \"string filename\" \"picture.exr\"");
    let samples = writer.samples();
    writer.put(format!("Sampler \"independent\" \"integer pixelsamples\" {samples}"));
    let filter = match scene.trace.filter {
        Filter::Box => "\"box\" \"float xradius\" 0.5 \"float yradius\" 0.5",
        Filter::Tent => "\"triangle\" \"float xradius\" 1 \"float yradius\" 1",
        Filter::Gaussian => "\"gaussian\" \"float xradius\" 1.5 \"float yradius\" 1.5 \"float sigma\" 0.5",
        Filter::Mitchell => "\"mitchell\" \"float xradius\" 2 \"float yradius\" 2",
    };
    writer.put(format!("PixelFilter {filter}"));
    writer.put(format!("Integrator \"volpath\" \"integer maxdepth\" {}", scene.trace.bounces));
}

fn lamp(writer: &mut Writer, light: &Light) {
    match light {
        Light::Point { position, intensity } => {
            let (at, intensity) = (numbers(position.to_array(), " "), rgb("I", *intensity));
            writer.put(format!("LightSource \"point\" \"point3 from\" [{at}] {intensity}"));
        }
        Light::Spot { position, direction, intensity, inner, outer } => {
            let degrees = |angle: f64| number(angle * 180.0 / PI);
            let (from, to) = (position.to_array(), (*position + *direction).to_array());
            let (from, to) = (numbers(from, " "), numbers(to, " "));
            let (cone, delta) = (degrees(*outer), degrees(outer - inner));
            writer.put(format!("LightSource \"spot\" \"point3 from\" [{from}] \"point3 to\" [{to}]"));
            let intensity = rgb("I", *intensity);
            writer.put(format!("  {intensity} \"float coneangle\" {cone} \"float conedeltaangle\" {delta}"));
        }
        Light::Sun { direction, irradiance, radius } => {
            let how = "it casts hard shadows and is not seen";
            if *radius == 0.0 || writer.nearly(None, "knows no suns with a disc", how) {
                // From `from` to the origin; a distant light's radiance is the irradiance of what faces it.
                let from = numbers(direction.to_array(), " ");
                let light = rgb("L", *irradiance);
                writer.put(format!(
                    "LightSource \"distant\" \"point3 from\" [{from}] \"point3 to\" [0 0 0] {light}"
                ));
            }
        }
        Light::Sky { radiance, panorama: None } => {
            writer.put(format!("LightSource \"infinite\" {}", rgb("L", *radiance)));
        }
        Light::Sky { panorama: Some(_), .. } => {
            let what = "takes pictures of the sky only in another projection, an octahedron's";
            writer.refuse(None, what, Some("export for Mitsuba, which takes longitude and latitude"));
        }
    }
}

fn material(writer: &mut Writer, primitive: &Primitive, around: f64) -> Option<()> {
    let origin = Some(primitive.origin);
    let line = match writer.scene.material(primitive) {
        Material::Diffuse { color } => {
            format!("Material \"diffuse\" {}", painted(writer, primitive, "reflectance", *color)?)
        }
        Material::Mirror { color } => {
            let color = painted(writer, primitive, "reflectance", *color)?;
            writer
                .nearly(origin, "has no perfect mirror", "it reflects more at grazing angles")
                .then_some(())?;
            format!("Material \"conductor\" {color} \"float roughness\" 0")
        }
        Material::Metal { color, alpha } => {
            let color = painted(writer, primitive, "reflectance", *color)?;
            let how = "Fresnel's equations take the place of Schlick's approximation";
            writer.nearly(origin, "has other metals", how).then_some(())?;
            format!("Material \"conductor\" {color}{}", roughness(*alpha))
        }
        Material::Plastic { color, ior, alpha } => {
            let color = painted(writer, primitive, "reflectance", *color)?;
            let how = "light walks at random between coat and base";
            writer.nearly(origin, "has other plastics", how).then_some(())?;
            let eta = format!(" \"float eta\" {}", number(*ior));
            format!("Material \"coateddiffuse\" {color}{eta}{}", roughness(*alpha))
        }
        Material::Dielectric { ior, absorption, alpha } => {
            if absorption.max_element() == f64::INFINITY {
                writer.refuse(origin, "has no dielectric that absorbs everything", None);
                return None;
            }
            if *alpha > 0.0 {
                let how = "light that goes through is shadowed together, not independently";
                writer.nearly(origin, "has other rough glass", how).then_some(())?;
            }
            if *absorption != Rgb::ZERO {
                let id = primitive.material.0;
                let (absorbed, scattered) = (rgb("sigma_a", *absorption), rgb("sigma_s", Rgb::ZERO));
                writer.put(format!(
                    "MakeNamedMedium \"medium{id}\" \"string type\" \"homogeneous\" {absorbed} {scattered}"
                ));
                writer.put(format!("MediumInterface \"medium{id}\" \"\""));
            }
            format!("Material \"dielectric\" \"float eta\" {}{}", number(ior / around), roughness(*alpha))
        }
        Material::Emitter { radiance, pattern: None } => {
            let sides = !primitive.shape.is_closed();
            writer.put(format!(
                "AreaLightSource \"diffuse\" {} \"bool twosided\" {sides}",
                rgb("L", *radiance)
            ));
            format!("Material \"diffuse\" {}", rgb("reflectance", Rgb::ZERO))
        }
        Material::Emitter { pattern: Some(_), .. } => {
            writer.refuse(origin, "has no glowing surfaces with solid textures", None);
            return None;
        }
    };
    writer.put(line);
    Some(())
}

/// A colour of a material: as it is, or a texture by its name.
fn painted(writer: &mut Writer, primitive: &Primitive, name: &str, paint: Paint) -> Option<String> {
    let id = match paint {
        Paint::Plain(color) => return Some(rgb(name, color)),
        Paint::Texture(id) => id,
    };
    let origin = Some(primitive.origin);
    let (a, b, size, along) = match writer.scene.textures[id.0 as usize] {
        Texture::Checker { a, b, size } => (a, b, size, None),
        Texture::Stripes { a, b, width, along } => (a, b, width, Some(along)),
        Texture::Noise { .. } => {
            writer.refuse(origin, "has other noise", None);
            return None;
        }
        Texture::Image { .. } => {
            writer.refuse(origin, "lays pictures on surfaces otherwise", None);
            return None;
        }
    };
    writer.nearly(origin, "filters textures", "borders of cells are as wide as a pixel").then_some(())?;
    let (a, b) = (painted(writer, primitive, "tex1", a)?, painted(writer, primitive, "tex2", b)?);
    writer.textures += 1;
    let own = format!("texture{}", writer.textures);
    let world_from_texture = cells::world_from_texture(writer, primitive, DEPTH * size);
    writer.put("AttributeBegin");
    transform(writer, world_from_texture * DAffine3::from_scale(DVec3::splat(size)));
    let mapping = match along {
        None => "\"integer dimension\" 3".to_string(),
        // The one coordinate counts layers, and the other is the same everywhere.
        Some(along) => {
            let along = numbers(along.to_array(), " ");
            let planar = "\"string mapping\" \"planar\" \"float vdelta\" 0.5";
            format!("{planar} \"vector3 v1\" [{along}] \"vector3 v2\" [0 0 0]")
        }
    };
    writer.put(format!("Texture \"{own}\" \"spectrum\" \"checkerboard\" {mapping}\n  {a} {b}"));
    writer.put("AttributeEnd");
    Some(format!("\"texture {name}\" \"{own}\""))
}

fn shape(writer: &mut Writer, primitive: &Primitive) {
    let origin = Some(primitive.origin);
    match &primitive.shape {
        Shape::Sphere { center, radius } => {
            writer.put(format!("Translate {}", numbers(center.to_array(), " ")));
            writer.put(format!("Shape \"sphere\" \"float radius\" {}", number(*radius)));
        }
        Shape::Plane { point, normal } => {
            let how = format!("it ends after {FAR} times the size of the scene");
            if writer.nearly(origin, "has no endless plane", &how) {
                let (x, y) = crate::math::basis(*normal);
                transform(writer, DAffine3::from_cols(x, y, *normal, *point));
                let size = number(FAR * super::size(writer.scene));
                writer.put(format!("Shape \"disk\" \"float radius\" {size}"));
            }
        }
        Shape::Disk(placed) => {
            transform(writer, about_z(placed.world_from_object));
            writer.put("Shape \"disk\"");
        }
        Shape::Box(placed) => {
            transform(writer, placed.world_from_object);
            // The corner whose bits are those of its number.
            let corner = |i: i32| [0, 1, 2].map(|axis| (2 * (i >> axis & 1) - 1).to_string()).join(" ");
            let corners: Vec<String> = (0..8).map(corner).collect();
            const SIDES: &str = "0 2 3 0 3 1 4 5 7 4 7 6 0 1 5 0 5 4 2 6 7 2 7 3 0 4 6 0 6 2 1 3 7 1 7 5";
            let corners = corners.join(" ");
            writer.put(format!(
                "Shape \"trianglemesh\" \"point3 P\" [{corners}] \"integer indices\" [{SIDES}]"
            ));
        }
        Shape::Mesh(_) => mesh(writer, &triangles::of(&primitive.shape, 0).unwrap_or_default()),
        Shape::Quadric(quadric) => self::quadric(writer, primitive, quadric),
    }
}

fn quadric(writer: &mut Writer, primitive: &Primitive, quadric: &Quadric) {
    let origin = Some(primitive.origin);
    let map = about_z(quadric.world_from_object);
    match quadric.form {
        Form::Ellipsoid => {
            transform(writer, map);
            writer.put("Shape \"sphere\"");
        }
        Form::Cylinder => {
            transform(writer, map);
            let [low, high] = [quadric.low, quadric.high].map(number);
            writer.put(format!("Shape \"cylinder\" \"float zmin\" {low} \"float zmax\" {high}"));
            if quadric.capped {
                writer.put(format!("Shape \"disk\" \"float height\" {high}"));
                writer.put(format!("ReverseOrientation\nShape \"disk\" \"float height\" {low}"));
            }
        }
        Form::OneSheet | Form::TwoSheet | Form::Paraboloid | Form::Cone => {
            let what = "knows no quadrics but ellipsoids and cylinders";
            let Some(steps) = writer.options.tessellate else {
                return writer.refuse(origin, what, Some(TESSELLATE));
            };
            let Some(triangles) = triangles::of(&primitive.shape, steps) else {
                return writer.refuse(origin, "has no endless surfaces", None);
            };
            writer.note(format!("pbrt {what}: they are triangles, {steps} around"));
            mesh(writer, &triangles);
        }
    }
}

fn mesh(writer: &mut Writer, triangles: &Triangles) {
    let corners = numbers(triangles.corners.iter().flat_map(|p| p.to_array()), " ");
    let indices: Vec<String> = triangles.indices.iter().flatten().map(usize::to_string).collect();
    let indices = indices.join(" ");
    let normals = numbers(triangles.normals.iter().flat_map(|n| n.to_array()), " ");
    let normals = if normals.is_empty() { normals } else { format!(" \"normal N\" [{normals}]") };
    writer.put(format!(
        "Shape \"trianglemesh\" \"point3 P\" [{corners}]{normals} \"integer indices\" [{indices}]"
    ));
}

/// Shapes of revolution stand about z there, about y here; a cyclic exchange of axes keeps the hand.
fn about_z(map: DAffine3) -> DAffine3 {
    let m = map.matrix3;
    DAffine3 { matrix3: DMat3::from_cols(m.z_axis, m.x_axis, m.y_axis), ..map }
}

fn roughness(alpha: f64) -> String {
    format!(" \"float roughness\" {} \"bool remaproughness\" false", number(alpha))
}

fn rgb(name: &str, color: Rgb) -> String {
    format!("\"rgb {name}\" [{}]", numbers(color.to_array(), " "))
}

fn transform(writer: &mut Writer, map: DAffine3) {
    let m = map.matrix3;
    let column = |v: DVec3, w: &str| format!("{} {w}", numbers(v.to_array(), " "));
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(|axis| column(axis, "0")).join(" ");
    writer.put(format!("ConcatTransform [{axes} {}]", column(map.translation, "1")));
}
