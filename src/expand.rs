//! The scene as a flat text in the language, which compiles to the same scene, bit for bit.
//!
//! Loops, parts, prototypes, groups, imports and names are gone; what is left are the surfaces and lights in their
//! order, one statement each, and the one camera that takes the picture. Numbers are written with the fewest digits
//! that read back as the same number. What lowering computes from other numbers is written such that it computes
//! the same again:
//!
//! - Quadrics have unit axes and the whole of their map in `place: matrix(…)`.
//! - A direction of length 1 is kept by lowering. So that the camera's survives the difference of two points, it
//!   looks at the nearest point along it that no rounding tells from the direction.
//! - The spaces of textures lie in `grain: matrix(…)`.
//! - Where lowering divides or takes a tangent, the number is searched that leads to the one wanted. There is one,
//!   since the scene came from a text.

mod lights;
mod numbers;
mod view;

use crate::color::Rgb;
use crate::files::{Contents, FilePath};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::shape::{Form, Quadric};
use crate::scene::{ImageId, Light, Material, Paint, Primitive, Scene, Shape, Texture, TextureId};
use crate::span::SourceId;
use crate::syntax;
use numbers::{at, matrix, number, preimage, quoted, rgb, triple};

/// Writes a scene as a text that lies in a place below the root folder. `contents` says where the scene's pictures and
/// meshes were read; the text names them by paths from its place.
///
/// # Errors
///
/// What has no file: a picture or mesh that was not read from any.
pub fn expand(scene: &Scene, contents: &Contents, place: &FilePath) -> Result<String, &'static str> {
    let mut flat = Flat { scene, contents, place, names: vec![], text: String::new() };
    for (index, texture) in scene.textures.iter().enumerate() {
        let texture = flat.texture(texture)?;
        flat.put(format!("let texture{index} = {texture}"));
    }
    flat.name_materials();
    let (surfaces, lights) = flat.before_sky();
    for primitive in &scene.primitives[..surfaces] {
        flat.surface(primitive)?;
    }
    for light in &scene.lights[..lights] {
        flat.put(lights::lamp(&flat, light)?);
    }
    for primitive in &scene.primitives[surfaces..] {
        flat.surface(primitive)?;
    }
    for light in &scene.lights[lights..] {
        flat.put(lights::lamp(&flat, light)?);
    }
    flat.put(view::camera(&scene.camera, &scene.develop));
    flat.put(view::render(&scene.trace, &scene.develop));
    Ok(laid_out(&flat.text))
}

/// So much is laid out at once, in bytes: the text may be far larger than what its tree would leave room for.
const CHUNK: usize = 1 << 20;

/// The text as `rtc fmt` lays it out.
fn laid_out(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + text.len() / 4);
    let mut rest = text;
    while !rest.is_empty() {
        let least = rest.floor_char_boundary(CHUNK);
        let end = rest[least..].find('\n').map_or(rest.len(), |line_end| least + line_end + 1);
        out.push_str(&syntax::format(SourceId(0), &rest[..end]).0);
        rest = &rest[end..];
    }
    out
}

/// A text on its way.
struct Flat<'s> {
    scene: &'s Scene,
    contents: &'s Contents,
    place: &'s FilePath,
    /// Of the materials that were declared.
    names: Vec<Option<String>>,
    text: String,
}

impl Flat<'_> {
    /// Adds a line.
    fn put(&mut self, line: String) {
        self.text.push_str(&line);
        self.text.push('\n');
    }

    /// Declares the materials that several surfaces share; the others are written where they are used.
    fn name_materials(&mut self) {
        let mut uses = vec![0u32; self.scene.materials.len()];
        self.scene.primitives.iter().for_each(|primitive| uses[primitive.material.0 as usize] += 1);
        for (index, (uses, material)) in uses.into_iter().zip(&self.scene.materials).enumerate() {
            let name = (uses > 1).then(|| format!("surface{index}"));
            if let Some(name) = &name {
                self.put(format!("material {name} = {}", made(material)));
            }
            self.names.push(name);
        }
    }

    fn texture(&self, texture: &Texture) -> Result<String, &'static str> {
        Ok(match *texture {
            Texture::Checker { a, b, size } => {
                format!("checker({}, {}, {}m)", paint(a), paint(b), number(size))
            }
            Texture::Stripes { a, b, width, along } => {
                format!("stripes({}, {}, {}m, {})", paint(a), paint(b), number(width), triple(along))
            }
            Texture::Noise { a, b, size, octaves, seed } => {
                format!("noise({}, {}, {}m, {octaves}, {seed})", paint(a), paint(b), number(size))
            }
            Texture::Image { image, size } => format!("image({}, {}m)", self.image(image)?, number(size.x)),
        })
    }

    /// How many surfaces and lights come first. Pictures are numbered in the order in which they are first asked for,
    /// so the sky comes before the first surface that shows a later picture than its own.
    fn before_sky(&self) -> (usize, usize) {
        let picture = |light: &Light| match light {
            Light::Sky { panorama, .. } => panorama.map(|panorama| panorama.image),
            Light::Point { .. } | Light::Spot { .. } | Light::Sun { .. } => None,
        };
        let all = self.scene.primitives.len();
        let found = self.scene.lights.iter().enumerate().find_map(|(i, light)| Some((i, picture(light)?)));
        let Some((sky, picture)) = found else { return (all, 0) };
        let later = |primitive: &Primitive| {
            let texture = self.scene.material(primitive).texture();
            texture.is_some_and(|texture| self.shows_later(texture, picture))
        };
        self.scene.primitives.iter().position(later).map_or((all, 0), |surfaces| (surfaces, sky + 1))
    }

    /// Whether a texture shows a picture that comes after another.
    fn shows_later(&self, texture: TextureId, than: ImageId) -> bool {
        let part = |paint: Paint| matches!(paint, Paint::Texture(id) if self.shows_later(id, than));
        match self.scene.textures[texture.0 as usize] {
            Texture::Checker { a, b, .. } | Texture::Stripes { a, b, .. } | Texture::Noise { a, b, .. } => {
                part(a) || part(b)
            }
            Texture::Image { image, .. } => image > than,
        }
    }

    /// The path of a picture.
    fn image(&self, id: ImageId) -> Result<String, &'static str> {
        self.file(self.scene.images[id.0 as usize].hash()).ok_or("it has a picture that is in no file")
    }

    fn file(&self, hash: blake3::Hash) -> Option<String> {
        Some(quoted(&self.contents.path(hash)?.written_in(self.place)))
    }

    fn surface(&mut self, primitive: &Primitive) -> Result<(), &'static str> {
        let material = match &self.names[primitive.material.0 as usize] {
            Some(name) => name.clone(),
            None => made(self.scene.material(primitive)),
        };
        let grain = primitive.frame.map(|frame| {
            let map = self.scene.frames[frame.0 as usize].world_from_object;
            format!(", grain: {}", matrix(map.matrix3, map.translation))
        });
        let shape = self.shape(&primitive.shape)?;
        self.put(format!("{shape}, material: {material}{} }}", grain.unwrap_or_default()));
        Ok(())
    }

    /// A shape up to its own last field.
    fn shape(&self, shape: &Shape) -> Result<String, &'static str> {
        Ok(match shape {
            Shape::Sphere { center, radius } => {
                format!("sphere {{ {}radius: {}m", at(*center), number(*radius))
            }
            Shape::Plane { point, normal } => format!("plane {{ {}normal: {}", at(*point), triple(*normal)),
            Shape::Quadric(quadric) => self::quadric(quadric),
            Shape::Mesh(instance) => {
                let file = self.file(instance.mesh.hash()).ok_or("it has a mesh that is in no file")?;
                let DAffine3 { matrix3, translation } = instance.placed.world_from_object;
                let (place, smooth) = (matrix(matrix3, translation), instance.smooth);
                format!("mesh {{ file: {file}, smooth: {smooth}, place: {place}")
            }
            Shape::Disk(placed) => {
                // Lowering turns the axes of a disk such that its normal is y.
                let DAffine3 { matrix3: m, translation } = placed.world_from_object;
                let place = matrix(DMat3::from_cols(m.z_axis, m.y_axis, -m.x_axis), translation);
                format!("disk {{ radius: 1m, place: {place}")
            }
            Shape::Box(placed) => {
                let place = matrix(placed.world_from_object.matrix3, placed.world_from_object.translation);
                format!("box {{ size: (2, 2, 2)m, place: {place}")
            }
        })
    }
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

fn quadric(quadric: &Quadric) -> String {
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
    format!("{kind}, place: {}", matrix(matrix3, translation))
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
