//! Where the cells of a solid texture lie, for renderers that have cubes of two colours themselves.
//!
//! We look a millionth of a cell below a surface, so that a flat part on the border of two cells shows the one inside.
//! Others look at the surface itself: their cells are moved out by as much. Of a solid that means they grow about its
//! middle, of a plane or disc that they move along its normal.

use super::Writer;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::{Primitive, Shape, Texture};

/// How wide a layer is in the directions along it, in metres of the world: POV-Ray sees no farther.
const WIDE: f64 = 2e7;

/// The unit cubes of a texture that alternate: those whose three coordinates, rounded down, have an even sum show the
/// first of its two colours. None of a texture that is not made of such cells.
///
/// The map leads from the space in which the cells are cubes to the world. They are moved out by `depth` cells.
pub(super) fn world_from_cells(
    writer: &Writer,
    primitive: &Primitive,
    texture: &Texture,
    depth: f64,
) -> Option<DAffine3> {
    let (size, texture_from_cells) = match *texture {
        Texture::Checker { size, .. } => (size, DAffine3::from_scale(DVec3::splat(size))),
        Texture::Stripes { width, along, .. } => {
            let (y, z) = crate::math::basis(along);
            let m = writer.scene.frame(primitive).matrix3;
            let wide = WIDE * m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
            let matrix3 = DMat3::from_cols(width * along, wide * y, wide * z);
            // The layers' other borders lie far from the origin.
            (width, DAffine3 { matrix3, translation: matrix3 * DVec3::new(0.0, -0.5, -0.5) })
        }
        Texture::Noise { .. } | Texture::Image { .. } => return None,
    };
    Some(world_from_texture(writer, primitive, depth * size) * texture_from_cells)
}

/// From the space of a texture to the world, moved out of the surface by a distance in that space.
pub(super) fn world_from_texture(writer: &Writer, primitive: &Primitive, distance: f64) -> DAffine3 {
    let texture_from_world = writer.scene.frame(primitive);
    texture_from_world.inverse() * moved_out(primitive, texture_from_world, distance)
}

/// Moves what lies in the space of a texture out of a solid by a distance there.
fn moved_out(primitive: &Primitive, texture_from_world: DAffine3, distance: f64) -> DAffine3 {
    let along = |normal: DVec3| {
        let out = (texture_from_world.matrix3 * normal).normalize_or_zero();
        DAffine3::from_translation(distance * out)
    };
    match &primitive.shape {
        Shape::Plane { normal, .. } => along(*normal),
        Shape::Disk(placed) => along(placed.normal(DVec3::Y)),
        Shape::Box(placed) => {
            let texture_from_box = texture_from_world * placed.world_from_object;
            let m = texture_from_box.matrix3;
            let half = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
            let grown = DAffine3::from_scale(1.0 + distance / half);
            texture_from_box * grown * texture_from_box.inverse()
        }
        shape => match shape.bounds() {
            None => DAffine3::IDENTITY,
            Some(bounds) => {
                let middle = texture_from_world.transform_point3(bounds.center());
                let half = 0.5 * (texture_from_world.matrix3 * bounds.size()).abs().max_element();
                let grown = DAffine3::from_scale(DVec3::splat(1.0 + distance / half));
                DAffine3::from_translation(middle) * grown * DAffine3::from_translation(-middle)
            }
        },
    }
}
