//! Textures: Mitsuba lays them on surfaces, by two coordinates from 0 to 1. A flat face cuts a solid texture in squares
//! or stripes that it can say; pictures lie on flat faces and around spheres as ours do.

use super::{material, rgb, shape, transform};
use crate::asset::Image;
use crate::export::{Writer, cells, numbers};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::texture::upright;
use crate::scene::{ImageId, Paint, Primitive, Shape, Texture};

/// The size of a plane's stand-in, in sizes of the scene: as large as leaves 32 bits to its coordinates.
const FAR: f64 = 100.0;

/// How far below the surface a solid texture is seen, in cells.
const DEPTH: f64 = 1e-6;

/// Where the coordinates of a surface lie in the world.
pub(super) enum Lay {
    /// On a flat face: from its own square [−1, 1]² at z = 0.
    Flat(DAffine3),
    /// Around a sphere: from the unit sphere about z.
    Globe(DAffine3),
}

/// A surface with a texture.
pub(super) fn surface(writer: &mut Writer, primitive: &Primitive) {
    let origin = Some(primitive.origin);
    match &primitive.shape {
        Shape::Plane { point, normal } => {
            let how = format!("with a texture it ends after {FAR} times the size of the scene");
            if writer.nearly(origin, "has no endless plane", &how) {
                let size = FAR * crate::export::size(writer.scene);
                let (x, y) = crate::math::basis(*normal);
                let matrix3 = DMat3::from_cols(size * x, size * y, *normal);
                part(writer, primitive, Lay::Flat(DAffine3 { matrix3, translation: *point }));
            }
        }
        Shape::Box(placed) => {
            for face in faces(placed.world_from_object) {
                part(writer, primitive, Lay::Flat(face));
            }
        }
        Shape::Sphere { center, radius } => match globe(writer, primitive, *center, *radius) {
            Some(lay) => part(writer, primitive, lay),
            None => writer.refuse(origin, "has no spheres whose pictures lie aslant", None),
        },
        Shape::Quadric(_) | Shape::Disk(_) | Shape::Mesh(_) => {
            let what = "lays textures on these surfaces otherwise, and none fills space";
            writer.refuse(origin, what, Some("boxes, planes and spheres can have them"));
        }
    }
}

fn part(writer: &mut Writer, primitive: &Primitive, lay: Lay) {
    let Some(material) = material(writer, primitive, 1.0, Some(&lay)) else { return };
    let (kind, map) = match lay {
        Lay::Flat(map) => ("rectangle", map),
        Lay::Globe(map) => ("sphere", map),
    };
    shape(writer, kind, &transform(map.matrix3, map.translation), &material);
}

/// The sides of a box, z of each out of it.
fn faces(map: DAffine3) -> impl Iterator<Item = DAffine3> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let sides = [(y, z, x), (z, x, y), (x, y, z), (z, y, -x), (x, z, -y), (y, x, -z)];
    sides.into_iter().map(move |(u, v, out)| map * DAffine3::from_cols(u, v, out, out))
}

/// Where Mitsuba's coordinates go around a sphere as ours do: u from −z by way of −x, v downwards. None where a
/// texture's own space has another middle or is stretched.
fn globe(writer: &Writer, primitive: &Primitive, center: DVec3, radius: f64) -> Option<Lay> {
    let texture_from_world = writer.scene.frame(primitive);
    let world_from_texture = texture_from_world.inverse().matrix3;
    let off = (center - texture_from_world.inverse().translation).length();
    if off > 1e-9 * radius || !super::is_right_angled(world_from_texture) {
        return None;
    }
    let [x, y, z] = [world_from_texture.x_axis, world_from_texture.y_axis, world_from_texture.z_axis]
        .map(DVec3::normalize);
    let same = world_from_texture.determinant() > 0.0;
    let matrix3 = DMat3::from_cols(-z, -x, y) * radius;
    same.then_some(Lay::Globe(DAffine3 { matrix3, translation: center }))
}

/// A colour of a material, or a texture in its place. Only what is laid may have one.
pub(super) fn paint(
    writer: &mut Writer,
    primitive: &Primitive,
    name: &str,
    paint: Paint,
    lay: Option<&Lay>,
) -> Option<String> {
    let id = match paint {
        Paint::Plain(color) => return Some(rgb(name, color)),
        Paint::Texture(id) => id,
    };
    let texture = writer.scene.textures[id.0 as usize];
    match (texture, lay?) {
        (Texture::Image { image, size }, Lay::Flat(face)) => {
            let frame = writer.scene.frame(primitive);
            let normal = frame.matrix3.inverse().transpose() * face.matrix3.x_axis.cross(face.matrix3.y_axis);
            let (right, up) = upright(normal.normalize_or(DVec3::Y));
            // Its coordinate runs down.
            let right = Coordinate::new(*face, frame, right / size.x, 0.5);
            let down = Coordinate::new(*face, frame, -up / size.y, 0.5);
            Some(picture(writer, name, image, 0, [right, down]))
        }
        (Texture::Image { image, .. }, Lay::Globe(_)) => {
            // Beyond its first and last row ours goes on as these, and Mitsuba's begins anew.
            let rows = f64::from(writer.scene.images[image.0 as usize].height());
            let around = Coordinate { u: 1.0, v: 0.0, start: 0.0 };
            let down = Coordinate { u: 0.0, v: rows / (rows + 2.0), start: 1.0 / (rows + 2.0) };
            Some(picture(writer, name, image, 1, [around, down]))
        }
        (Texture::Checker { a, b, .. } | Texture::Stripes { a, b, .. }, Lay::Flat(face)) => {
            let Some([u, v]) = squares(writer, primitive, &texture, *face) else {
                let what = "has no solid textures, and this face does not lie along its cubes";
                writer.refuse(Some(primitive.origin), what, None);
                return None;
            };
            let a = self::paint(writer, primitive, "color0", a, lay)?;
            let b = self::paint(writer, primitive, "color1", b, lay)?;
            Some(format!("<texture type=\"checkerboard\" name=\"{name}\">{a}{b}{}</texture>", to_uv([u, v])))
        }
        (Texture::Checker { .. } | Texture::Stripes { .. }, Lay::Globe(_)) => {
            writer.refuse(Some(primitive.origin), "has no solid textures but on flat faces", None);
            None
        }
        (Texture::Noise { .. }, _) => {
            writer.refuse(Some(primitive.origin), "has no noise", None);
            None
        }
    }
}

/// A coordinate that is even over a face: `u` and `v` times the face's own, from 0 to 1, and what it begins with.
#[derive(Clone, Copy)]
struct Coordinate {
    u: f64,
    v: f64,
    start: f64,
}

impl Coordinate {
    /// Along a direction of the space that a map leads to from the world.
    fn new(face: DAffine3, map: DAffine3, along: DVec3, start: f64) -> Coordinate {
        let map = map * face;
        let (x, y) = (map.matrix3.x_axis.dot(along), map.matrix3.y_axis.dot(along));
        Coordinate { u: 2.0 * x, v: 2.0 * y, start: map.translation.dot(along) - x - y + start }
    }

    /// The whole part of it, where that is the same on all of the face.
    fn constant(self) -> Option<f64> {
        let corners = [0.0, self.u, self.v, self.u + self.v].map(|part| (self.start + part).floor());
        corners.iter().all(|corner| *corner == corners[0]).then_some(corners[0])
    }

    fn halved(self) -> Coordinate {
        Coordinate { u: 0.5 * self.u, v: 0.5 * self.v, start: 0.5 * self.start }
    }
}

/// The two coordinates in which a face that lies between two borders of a solid texture is a board of squares. Those of
/// Mitsuba's board change colour at the halves.
fn squares(
    writer: &Writer,
    primitive: &Primitive,
    texture: &Texture,
    face: DAffine3,
) -> Option<[Coordinate; 2]> {
    let cells_from_world = cells::world_from_cells(writer, primitive, texture, DEPTH)?.inverse();
    let coordinates = DVec3::AXES.map(|axis| Coordinate::new(face, cells_from_world, axis, 0.0));
    let (across, layer) = (0..3).find_map(|axis| Some((axis, coordinates[axis].constant()?)))?;
    let mut u = coordinates[(across + 1) % 3].halved();
    u.start += 0.5 * layer.rem_euclid(2.0);
    Some([u, coordinates[(across + 2) % 3].halved()])
}

/// A picture with so many of its first and last rows again above and below.
fn picture(writer: &mut Writer, name: &str, id: ImageId, again: u32, coordinates: [Coordinate; 2]) -> String {
    let file = format!("{}-picture{}-{again}.pfm", writer.options.stem, id.0);
    if !writer.out.files.iter().any(|(known, _)| *known == file) {
        let bytes = pfm(&writer.scene.images[id.0 as usize], again);
        writer.out.files.push((file.clone(), bytes));
    }
    let raw = "<boolean name=\"raw\" value=\"true\"/>";
    let file = format!("<string name=\"filename\" value=\"{file}\"/>");
    format!("<texture type=\"bitmap\" name=\"{name}\">{file}{raw}{}</texture>", to_uv(coordinates))
}

/// Rows from the bottom, of little-endian floats.
fn pfm(image: &Image, again: u32) -> Vec<u8> {
    let (width, height) = (image.width(), image.height());
    let mut file = format!("PF\n{width} {}\n-1.0\n", height + 2 * again).into_bytes();
    for row in (0..height + 2 * again).rev() {
        let row = row.saturating_sub(again).min(height - 1);
        for column in 0..width {
            let color = image.pixel(column, row).to_array();
            color.iter().for_each(|channel| file.extend((*channel as f32).to_le_bytes()));
        }
    }
    file
}

fn to_uv(coordinates: [Coordinate; 2]) -> String {
    // Only the part of the last period matters, and leaves more of 32 bits to the rest.
    let [u, v] = coordinates.map(|c| numbers([c.u, c.v, 0.0, c.start.rem_euclid(1.0)], " "));
    format!("<transform name=\"to_uv\"><matrix value=\"{u} {v} 0 0 1 0 0 0 0 1\"/></transform>")
}
