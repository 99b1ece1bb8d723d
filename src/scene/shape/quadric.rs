//! Quadrics about an axis, cut by two planes, with or without caps.

use super::Bounds;
use crate::math::{DAffine3, DVec3, PI, cos, sin};
use serde::Serialize;

/// A quadric surface. In object space it is the points with q(p) = 0 and `low` ≤ y ≤ `high`, where q is
/// [`Form::q`], negative inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quadric {
    /// Which surface.
    pub form: Form,
    /// Object to world; invertible.
    pub world_from_object: DAffine3,
    /// The inverse.
    pub object_from_world: DAffine3,
    /// Lower end in object space's y; −∞ where it is not cut.
    pub low: f64,
    /// Upper end in object space's y; +∞ where it is not cut.
    pub high: f64,
    /// Whether finite ends are closed by flat caps, where the inside is.
    pub capped: bool,
}

/// Canonical quadrics about the y axis of object space: q(p) = x² + z² + s·y² + 2h·y + k.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Form {
    /// x² + y² + z² − 1: a ball that a stretching map has made an ellipsoid.
    Ellipsoid,
    /// x² + z² − y² − 1: a hyperboloid of one sheet.
    OneSheet,
    /// x² + z² − y² + 1: a hyperboloid of two sheets, tips at y = ±1.
    TwoSheet,
    /// x² + z² − y: a paraboloid with its vertex at the origin, open upwards.
    Paraboloid,
    /// x² + z² − y²: a double cone with its apex at the origin; one that is cut there is a single one.
    Cone,
    /// x² + z² − 1: a cylinder.
    Cylinder,
}

impl Form {
    /// The name of its kind in the language.
    pub fn kind(self) -> &'static str {
        match self {
            Form::Ellipsoid => "sphere",
            Form::OneSheet | Form::TwoSheet => "hyperboloid",
            Form::Paraboloid => "paraboloid",
            Form::Cone => "cone",
            Form::Cylinder => "cylinder",
        }
    }

    /// The factor s of y² in q.
    pub fn y_sign(self) -> f64 {
        match self {
            Form::Ellipsoid => 1.0,
            Form::OneSheet | Form::TwoSheet | Form::Cone => -1.0,
            Form::Paraboloid | Form::Cylinder => 0.0,
        }
    }

    /// Half the factor of y in q: h.
    pub fn y_slope(self) -> f64 {
        if self == Form::Paraboloid { -0.5 } else { 0.0 }
    }

    /// The constant k in q.
    pub fn constant(self) -> f64 {
        match self {
            Form::Ellipsoid | Form::OneSheet | Form::Cylinder => -1.0,
            Form::TwoSheet => 1.0,
            Form::Paraboloid | Form::Cone => 0.0,
        }
    }

    /// The quadratic function that is 0 on the surface and negative inside.
    pub fn q(self, p: DVec3) -> f64 {
        p.x * p.x + p.z * p.z + (self.y_sign() * p.y + 2.0 * self.y_slope()) * p.y + self.constant()
    }

    /// Half the gradient of q: along the normal, outwards.
    pub fn half_gradient(self, p: DVec3) -> DVec3 {
        DVec3::new(p.x, self.y_sign() * p.y + self.y_slope(), p.z)
    }

    /// The squared radius of the circle where the surface meets the plane at this height: negative where it
    /// does not.
    pub fn radius_squared(self, y: f64) -> f64 {
        -self.constant() - (self.y_sign() * y + 2.0 * self.y_slope()) * y
    }
}

impl Quadric {
    /// Whether it bounds a solid: every finite end has its cap.
    pub fn is_closed(&self) -> bool {
        let uncut = self.low == f64::NEG_INFINITY && self.high == f64::INFINITY;
        self.form == Form::Ellipsoid || self.capped || uncut
    }

    /// The stretches of object space's y that the surface covers: two for the sheets of a two-sheet
    /// hyperboloid, else one. A stretch may be empty, and may be endless.
    pub fn stretches(&self) -> [[f64; 2]; 2] {
        const NOTHING: [f64; 2] = [0.0, 0.0];
        match self.form {
            Form::Ellipsoid => [[self.low.max(-1.0), self.high.min(1.0)], NOTHING],
            Form::OneSheet | Form::Cone | Form::Cylinder => [[self.low, self.high], NOTHING],
            Form::Paraboloid => [[self.low.max(0.0), self.high], NOTHING],
            Form::TwoSheet => [[self.low, self.high.min(-1.0)], [self.low.max(1.0), self.high]],
        }
        .map(|[low, high]| if low < high { [low, high] } else { NOTHING })
    }

    /// The point of the side at a height and an angle about the y axis, in object space.
    pub fn side_point(&self, y: f64, angle: f64) -> DVec3 {
        let r = self.form.radius_squared(y).max(0.0).sqrt();
        DVec3::new(r * cos(angle), y, r * sin(angle))
    }

    /// World area of the side for each unit of object y and radian at a point of object space. In object
    /// space it is half the length of the gradient, for each of the forms; a map M carries an area element
    /// n dA to det(M) M⁻ᵀ n dA.
    pub fn side_density(&self, p: DVec3) -> f64 {
        let m = self.world_from_object.matrix3;
        let inverse_transpose = self.object_from_world.matrix3.transpose();
        m.determinant().abs() * (inverse_transpose * self.form.half_gradient(p)).length()
    }

    /// World area of both caps together, or 0 without caps.
    pub fn cap_areas(&self) -> [f64; 2] {
        let m = self.world_from_object.matrix3;
        let unit = m.x_axis.cross(m.z_axis).length();
        [self.low, self.high].map(|y| {
            let radius_squared = self.form.radius_squared(y);
            if self.capped && y.is_finite() && radius_squared > 0.0 {
                PI * radius_squared * unit
            } else {
                0.0
            }
        })
    }

    /// World area of the side between two heights of object space, by the trapezoid rule in the angle (which
    /// converges exponentially for a periodic integrand) and Gauss's rule in panels of y.
    pub fn side_area(&self, low: f64, high: f64) -> f64 {
        if high - low == f64::INFINITY {
            return f64::INFINITY;
        }
        const PANELS: usize = 64;
        const ANGLES: usize = 128;
        /// Nodes and weights of Gauss–Legendre with three points on [−1, 1].
        const GAUSS: [(f64, f64); 3] =
            [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
        let half = 0.5 * (high - low) / PANELS as f64;
        let mut sum = 0.0;
        for panel in 0..PANELS {
            let middle = low + (2.0 * panel as f64 + 1.0) * half;
            for (node, weight) in GAUSS {
                for step in 0..ANGLES {
                    let angle = 2.0 * PI * step as f64 / ANGLES as f64;
                    sum += weight * self.side_density(self.side_point(middle + node * half, angle));
                }
            }
        }
        sum * half * 2.0 * PI / ANGLES as f64
    }

    pub(super) fn area(&self) -> f64 {
        let side: f64 = self.stretches().iter().map(|[low, high]| self.side_area(*low, *high)).sum();
        side + self.cap_areas().iter().sum::<f64>()
    }

    /// Whether it has an end in every direction.
    pub(super) fn is_bounded(&self) -> bool {
        self.stretches().iter().flatten().all(|y| y.is_finite())
    }

    /// The tight box: on each world axis the greatest value of a linear function on the surface.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        if !self.is_bounded() {
            return None;
        }
        let along = |direction| self.extent(direction);
        let max = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
        let min = -DVec3::new(along(DVec3::NEG_X), along(DVec3::NEG_Y), along(DVec3::NEG_Z));
        let origin = self.world_from_object.translation;
        Some(Bounds { min: origin + min, max: origin + max })
    }

    /// How far a bounded one reaches along a direction of the world from where its map takes the origin.
    pub(super) fn extent(&self, direction: DVec3) -> f64 {
        let g = self.world_from_object.matrix3.transpose() * direction;
        self.stretches()
            .iter()
            .filter(|[low, high]| low < high)
            .map(|[low, high]| self.support(g, *low, *high))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The greatest g·p over the side between two heights, in object space. About the axis the best point
    /// leans along g, so it is the greatest g.y·y + |g.xz|·r(y): at an end, or where its slope vanishes.
    fn support(&self, g: DVec3, low: f64, high: f64) -> f64 {
        let radial = (g.x * g.x + g.z * g.z).sqrt();
        let value = |y: f64| g.y * y + radial * self.form.radius_squared(y).max(0.0).sqrt();
        let stationary = match self.form {
            Form::Ellipsoid => g.y / (g.y * g.y + radial * radial).sqrt(),
            // r is concave on each sheet: the best point lies where the sheet faces g, if it does.
            Form::TwoSheet => -g.y / (g.y * g.y - radial * radial).sqrt(),
            // Where 2r·g.y = −|g.xz|.
            Form::Paraboloid => 0.25 * (radial / g.y) * (radial / g.y),
            // r is convex or straight: the best point is at an end.
            Form::OneSheet | Form::Cone | Form::Cylinder => f64::NAN,
        };
        let inside = low < stationary && stationary < high;
        let best = value(low).max(value(high));
        if inside { best.max(value(stationary)) } else { best }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DMat3;

    fn quadric(form: Form, low: f64, high: f64, map: DAffine3) -> Quadric {
        Quadric { form, world_from_object: map, object_from_world: map.inverse(), low, high, capped: true }
    }

    #[test]
    fn areas_match_closed_forms() {
        let stretch = DAffine3::from_scale(DVec3::new(2.0, 3.0, 2.0));
        // A prolate spheroid with semi-axes a = 2, c = 3: 2πa²(1 + c/(ae)·asin e), e² = 1 − a²/c².
        let e = (1.0f64 - 4.0 / 9.0).sqrt();
        let spheroid = 2.0 * PI * 4.0 * (1.0 + 3.0 / (2.0 * e) * crate::math::asin(e));
        let area = quadric(Form::Ellipsoid, f64::NEG_INFINITY, f64::INFINITY, stretch).area();
        assert!((area / spheroid - 1.0).abs() < 1e-6, "{area} {spheroid}");
        // The side of x² + z² − y² = 1 between ±h: 2π ∫ √(1 + 2y²) dy.
        let h = 1.5f64;
        let s = 2.0f64.sqrt();
        let asinh = crate::math::ln(s * h + (1.0 + 2.0 * h * h).sqrt());
        let side = 2.0 * PI * (h * (1.0 + 2.0 * h * h).sqrt() + asinh / s);
        let caps = 2.0 * PI * (1.0 + h * h);
        let area = quadric(Form::OneSheet, -h, h, DAffine3::IDENTITY).area();
        assert!((area / (side + caps) - 1.0).abs() < 1e-9, "{area}");
        let map = DAffine3::from_scale(DVec3::new(2.0, 3.0, 2.0));
        // A cone of radius 2 and height 3: π r √(r² + h²), and its base.
        let cone = PI * 2.0 * 13.0f64.sqrt() + PI * 4.0;
        let area = quadric(Form::Cone, -1.0, 0.0, map).area();
        assert!((area / cone - 1.0).abs() < 1e-9, "{area}");
        let area = quadric(Form::Cylinder, 0.0, 1.0, map).area();
        assert!((area / (2.0 * PI * 2.0 * (3.0 + 2.0)) - 1.0).abs() < 1e-9, "{area}");
        // A paraboloid: π r / (6 h²) · ((r² + 4h²)^(3/2) − r³), and its cap.
        let power = |x: f64| x * x.sqrt();
        let bowl = PI * 2.0 / (6.0 * 9.0) * (power(4.0 + 36.0) - 8.0) + PI * 4.0;
        let area = quadric(Form::Paraboloid, f64::NEG_INFINITY, 1.0, map).area();
        assert!((area / bowl - 1.0).abs() < 1e-7, "{area}");
    }

    #[test]
    fn bounds_are_tight() {
        let turn = DMat3::from_cols(
            DVec3::new(0.6, 0.8, 0.0),
            DVec3::new(-0.8, 0.6, 0.0),
            DVec3::new(0.0, 0.3, 1.0),
        );
        let map = DAffine3::from_mat3_translation(turn, DVec3::new(5.0, -2.0, 1.0));
        for form in
            [Form::Ellipsoid, Form::OneSheet, Form::TwoSheet, Form::Paraboloid, Form::Cone, Form::Cylinder]
        {
            let quadric = quadric(form, -1.4, 2.0, map);
            let bounds = quadric.bounds().unwrap();
            let mut found = Bounds::EMPTY;
            for [low, high] in quadric.stretches() {
                for i in 0..=2000 {
                    for j in 0..500 {
                        let y = low + (high - low) * f64::from(i) / 2000.0;
                        let p = quadric.side_point(y, f64::from(j) * 2.0 * PI / 500.0);
                        if low < high {
                            let p = map.transform_point3(p);
                            found = found.union(Bounds { min: p, max: p });
                        }
                    }
                }
            }
            assert!(found.min.cmpge(bounds.min - 1e-9).all() && found.max.cmple(bounds.max + 1e-9).all());
            assert!((found.min - bounds.min).abs().max_element() < 1e-3, "{form:?} {found:?} {bounds:?}");
            assert!((found.max - bounds.max).abs().max_element() < 1e-3, "{form:?} {found:?} {bounds:?}");
        }
    }
}
