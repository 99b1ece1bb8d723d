//! Mathematics with the same bits on every processor.
//!
//! `+ − × ÷ √` are exact by IEEE 754 and come from the language. Everything transcendental comes from the
//! `libm` crate, which is portable Rust without processor-specific paths; clippy bans the platform's own.

pub use glam::{DAffine3, DMat3, DVec2, DVec3};
pub use std::f64::consts::PI;

/// Sine of an angle in radians.
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine of an angle in radians.
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Tangent of an angle in radians.
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Angle in [−π/2, π/2] whose sine is `x`.
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Angle in [0, π] whose cosine is `x`.
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Angle of the point (x, y) from the x axis, in (−π, π].
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power `x`.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// e to the power `x`, less one, exact near zero.
pub fn exp_m1(x: f64) -> f64 {
    libm::expm1(x)
}

/// 2 to the power `x`.
pub fn exp2(x: f64) -> f64 {
    libm::exp2(x)
}

/// Natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// `x` to the power `y`.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Two unit vectors that make a right-handed frame (x, y, `z`) with the unit vector `z`, after Duff et al.,
/// "Building an orthonormal basis, revisited", JCGT 2017.
pub fn basis(z: DVec3) -> (DVec3, DVec3) {
    let sign = if z.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    (DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), DVec3::new(b, sign + z.y * z.y * a, -z.y))
}
