//! Shapes in world space.

use super::errors;
use crate::diagnostic::Diagnostic;
use crate::eval::{Thing, Things};
use crate::math::{DAffine3, DMat3, DVec3, basis};
use crate::scene::Shape;
use crate::scene::shape::{Form, Placed, Quadric};
use crate::schema::{cone, cuboid, cylinder, disk, hyperboloid, paraboloid, plane, sphere};
use crate::span::Span;

/// A map stretches by no more than this beyond another direction and still counts as a similarity: rounding of
/// rotations, far below what a picture can show.
const SIMILAR: f64 = 1e-12;

/// Lowers a shape.
pub(super) fn lower(things: &Things, thing: &Thing) -> Result<Shape, Box<Diagnostic>> {
    let made = thing.made;
    let placement = thing.world_from_object;
    if !placement.is_finite() {
        return Err(Box::new(errors::not_finite_place(made.span())));
    }
    if made.kind() == sphere::KIND {
        ball(placement, things.read(made, sphere::RADIUS), made.span())
    } else if made.kind() == hyperboloid::KIND {
        hyperboloid(things, thing)
    } else if made.kind() == paraboloid::KIND {
        let [radius, height] = [paraboloid::RADIUS, paraboloid::HEIGHT].map(|key| things.read(made, key));
        let axes = DVec3::new(radius, height, radius);
        let capped = !things.read(made, paraboloid::OPEN);
        quadric(Form::Paraboloid, placement, axes, [f64::NEG_INFINITY, 1.0], capped, made.span())
    } else if made.kind() == cone::KIND {
        cone(things, thing)
    } else if made.kind() == cylinder::KIND {
        let [radius, height] = [cylinder::RADIUS, cylinder::HEIGHT].map(|key| things.read(made, key));
        let axes = DVec3::new(radius, height, radius);
        let capped = !things.read(made, cylinder::OPEN);
        quadric(Form::Cylinder, placement, axes, [0.0, 1.0], capped, made.span())
    } else if made.kind() == disk::KIND {
        let normal = things.read(made, disk::NORMAL);
        let span = made.given(disk::NORMAL).map_or(made.span(), |(_, span)| span);
        let Some(normal) = unit(normal) else { return Err(Box::new(errors::no_direction("normal", span))) };
        let (z, x) = basis(normal);
        let turned = DMat3::from_cols(x, normal, z) * things.read(made, disk::RADIUS);
        let placed = placed(placement * DAffine3::from_mat3(turned), made.span())?;
        Ok(Shape::Disk(Box::new(placed)))
    } else if made.kind() == cuboid::KIND {
        let half = 0.5 * things.read(made, cuboid::SIZE);
        let placed = placed(placement * DAffine3::from_scale(half), made.span())?;
        Ok(Shape::Box(Box::new(placed)))
    } else {
        let normal = things.read(made, plane::NORMAL);
        let span = made.given(plane::NORMAL).map_or(made.span(), |(_, span)| span);
        let Some(normal) = unit(normal) else { return Err(Box::new(errors::no_direction("normal", span))) };
        let inverse = invert(placement).ok_or_else(|| Box::new(errors::flattened(made.span())))?;
        let normal = unit(inverse.matrix3.transpose() * normal);
        let normal = normal.ok_or_else(|| Box::new(errors::flattened(made.span())))?;
        Ok(Shape::Plane { point: placement.translation, normal })
    }
}

/// A ball about the origin of a placement: a sphere, or an ellipsoid where the placement stretches.
pub(super) fn ball(placement: DAffine3, radius: f64, span: Span) -> Result<Shape, Box<Diagnostic>> {
    let m = placement.matrix3;
    let squares = DVec3::new(m.x_axis.length_squared(), m.y_axis.length_squared(), m.z_axis.length_squared());
    let size = squares.max_element();
    let skew =
        m.x_axis.dot(m.y_axis).abs().max(m.y_axis.dot(m.z_axis).abs()).max(m.z_axis.dot(m.x_axis).abs());
    let similar = size - squares.min_element() <= SIMILAR * size && skew <= SIMILAR * size;
    if similar && size > 0.0 && size.is_finite() {
        let radius = radius * size.sqrt();
        let sound = (radius * radius).is_normal();
        if radius * radius == f64::INFINITY {
            return Err(Box::new(errors::too_large(span)));
        }
        let shape = Shape::Sphere { center: placement.translation, radius };
        return if sound { Ok(shape) } else { Err(Box::new(errors::flattened(span))) };
    }
    let stretch = DVec3::splat(radius);
    quadric(Form::Ellipsoid, placement, stretch, [f64::NEG_INFINITY, f64::INFINITY], false, span)
}

fn hyperboloid(things: &Things, thing: &Thing) -> Result<Shape, Box<Diagnostic>> {
    let made = thing.made;
    let axes = things.read(made, hyperboloid::AXES);
    let form = if things.read(made, hyperboloid::SHEETS) == 1.0 { Form::OneSheet } else { Form::TwoSheet };
    let height = made.given(hyperboloid::HEIGHT);
    let (end, capped) = match height {
        Some((height, _)) => (0.5 * height / axes.y, !things.read(made, hyperboloid::OPEN)),
        None => (f64::INFINITY, false),
    };
    if let (Form::TwoSheet, Some((_, span))) = (form, height)
        && end <= 1.0
    {
        return Err(Box::new(errors::height_between_sheets(2.0 * axes.y, span)));
    }
    quadric(form, thing.world_from_object, axes, [-end, end], capped, made.span())
}

/// A cone, cut off or not. The apex is at the origin of object space, where the radius is 1 at y = −1.
fn cone(things: &Things, thing: &Thing) -> Result<Shape, Box<Diagnostic>> {
    /// Radii that differ by no more than this share of them make a cylinder: a billionth is not to be seen, and the
    /// apex would be so far off that places near the cone had few digits left.
    const ALIKE: f64 = 1e-9;
    let made = thing.made;
    let [radius, height, top] = [cone::RADIUS, cone::HEIGHT, cone::TOP].map(|key| things.read(made, key));
    let capped = !things.read(made, cone::OPEN);
    let placement = thing.world_from_object;
    if (radius - top).abs() <= ALIKE * radius {
        let axes = DVec3::new(radius, height, radius);
        return quadric(Form::Cylinder, placement, axes, [0.0, 1.0], capped, made.span());
    }
    let apex = height / (1.0 - top / radius);
    let raised = placement * DAffine3::from_translation(apex * DVec3::Y);
    let axes = DVec3::new(radius, apex.abs(), radius);
    // A cone that widens upwards has its apex below.
    let ends = if top < radius { [-1.0, -top / radius] } else { [1.0, top / radius] };
    quadric(Form::Cone, raised, axes, ends, capped, made.span())
}

fn quadric(
    form: Form,
    placement: DAffine3,
    axes: DVec3,
    [low, high]: [f64; 2],
    capped: bool,
    span: Span,
) -> Result<Shape, Box<Diagnostic>> {
    let Placed { world_from_object, object_from_world } =
        placed(placement * DAffine3::from_scale(axes), span)?;
    let quadric = Quadric { form, world_from_object, object_from_world, low, high, capped };
    Ok(Shape::Quadric(Box::new(quadric)))
}

pub(super) fn placed(map: DAffine3, span: Span) -> Result<Placed, Box<Diagnostic>> {
    // Zeros lose their sign, which would change the scene's hash and nothing else.
    let translation = map.translation + DVec3::ZERO;
    let world_from_object = DAffine3 { matrix3: map.matrix3 + DMat3::ZERO, translation };
    let object_from_world = invert(world_from_object).ok_or_else(|| Box::new(errors::flattened(span)))?;
    Ok(Placed { world_from_object, object_from_world })
}

/// The inverse of a map that keeps three dimensions.
fn invert(map: DAffine3) -> Option<DAffine3> {
    let inverse = map.inverse();
    let sound = map.is_finite() && map.matrix3.determinant().is_normal() && inverse.is_finite();
    sound.then_some(inverse)
}

/// The vector of length 1 in the same direction, if there is one. One that has length 1 but for rounding, or a power
/// of two times that, is left as it is: a scene that is written out and read again keeps its bits. Zeros come out
/// without a sign, for the same reason.
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    /// By how much the squared length of what this function gives may be off.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let scaled = scale_exactly(v)?;
    for unit in [scaled, 0.5 * scaled] {
        if (unit.length_squared() - 1.0).abs() <= ROUNDING {
            return Some(unit + DVec3::ZERO);
        }
    }
    Some(scaled / scaled.length() + DVec3::ZERO)
}

/// The vector times the power of two that brings its greatest component to [1, 2), if it has one.
fn scale_exactly(v: DVec3) -> Option<DVec3> {
    const EXPONENT: u64 = 0x7ff << 52;
    /// 2¹⁰⁰⁰.
    const HUGE: f64 = f64::from_bits((1023 + 1000) << 52);
    let greatest = v.abs().max_element();
    // The least numbers have no power of two of their own, until they are enlarged.
    let step = if greatest < 1.0 { HUGE } else { 1.0 };
    let power = f64::from_bits((greatest * step).to_bits() & EXPONENT);
    let scaled = v * step / power;
    (greatest > 0.0 && scaled.is_finite()).then_some(scaled)
}
