//! Transcendental functions in lanes, as polynomials of exact operations.

use super::lanes::{Float, Lanes, Mask, Word};

/// Sine and cosine of an angle in [−π/4, π/4], by their Taylor series: within 2e-7 of the truth.
#[inline(always)]
pub fn sin_cos_eighth<L: Lanes>(l: L, x: L::F) -> (L::F, L::F) {
    let s = x * x;
    let sin = x * (((s * (1.0 / 362_880.0) - 1.0 / 5040.0) * s + 1.0 / 120.0) * s - 1.0 / 6.0) * s + x;
    let cos = (((s * (1.0 / 40_320.0) - 1.0 / 720.0) * s + 1.0 / 24.0) * s - 0.5) * s + l.f(1.0);
    (sin, cos)
}

/// e to the power of a number that is at most 0, within 3e-7 of the truth; 0 below −87.
#[inline(always)]
pub fn exp_negative<L: Lanes>(l: L, x: L::F) -> L::F {
    // e^x = 2^(−n) e^r, with n whole and |r| at most ln 2 / 2. ln 2 is split so that n times its head is exact.
    let small = x.lt(l.f(-87.0));
    let y = -small.pick(l.f(-87.0), x);
    let n = (y * std::f32::consts::LOG2_E + 0.5).whole();
    let count = n.count();
    let r = count * 0.693_359_4 - y - count * 2.121_944_4e-4;
    let series =
        ((((r * (1.0 / 720.0) + 1.0 / 120.0) * r + 1.0 / 24.0) * r + 1.0 / 6.0) * r + 0.5) * r * r + r + 1.0;
    // 2^−n by its exponent.
    let power = ((l.u(127) - n) << 23).float();
    small.pick(l.f(0.0), series * power)
}
