//! A single lane.

use super::{Float, Lanes, Mask, Table, Word};
use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Shl, Shr, Sub};

/// A single lane without vector instructions.
#[derive(Clone, Copy)]
pub struct One;

impl Lanes for One {
    const N: usize = 1;
    type F = f32;
    type U = Scalar;
    type M = bool;
    type Group = One;

    #[inline(always)]
    fn group(self) -> One {
        self
    }
    #[inline(always)]
    fn look_up(self, table: &Table, Scalar(row): Scalar) -> [f32; 4] {
        table.rows[row as usize]
    }
    #[inline(always)]
    fn f(self, value: f32) -> f32 {
        value
    }
    #[inline(always)]
    fn u(self, value: u32) -> Scalar {
        Scalar(value)
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> bool {
        bits & 1 == 1
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> f32 {
        from[0]
    }
    #[inline(always)]
    fn load_words(self, from: &[u32]) -> Scalar {
        Scalar(from[0])
    }
    #[inline(always)]
    fn run<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
}

impl Float<One> for f32 {
    #[inline(always)]
    fn root(self) -> f32 {
        self.sqrt()
    }
    #[inline(always)]
    fn magnitude(self) -> f32 {
        self.abs()
    }
    #[inline(always)]
    fn signed_as(self, sign: f32) -> f32 {
        self.copysign(sign)
    }
    #[inline(always)]
    fn lt(self, other: f32) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: f32) -> bool {
        self <= other
    }
    #[inline(always)]
    fn bits(self) -> Scalar {
        Scalar(self.to_bits())
    }
    #[inline(always)]
    fn whole(self) -> Scalar {
        Scalar(self as u32)
    }
    #[inline(always)]
    fn get(self, _: usize) -> f32 {
        self
    }
    #[inline(always)]
    fn set(&mut self, _: usize, value: f32) {
        *self = value;
    }
    #[inline(always)]
    fn spread(self, mask: bool, other: f32) -> f32 {
        if mask { self } else { other }
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }
}

/// A word whose arithmetic wraps.
#[derive(Clone, Copy)]
pub struct Scalar(u32);

macro_rules! scalar {
    ($($operator:ident $method:ident $function:ident,)*) => {$(
        impl $operator for Scalar {
            type Output = Scalar;
            #[inline(always)]
            fn $method(self, other: Scalar) -> Scalar {
                Scalar(u32::$function(self.0, other.0))
            }
        }
    )*};
}
scalar! {
    Add add wrapping_add, Sub sub wrapping_sub, Mul mul wrapping_mul,
    BitAnd bitand bitand, BitOr bitor bitor, BitXor bitxor bitxor,
}

impl Shl<u32> for Scalar {
    type Output = Scalar;
    #[inline(always)]
    fn shl(self, by: u32) -> Scalar {
        Scalar(self.0 << by)
    }
}

impl Shr<u32> for Scalar {
    type Output = Scalar;
    #[inline(always)]
    fn shr(self, by: u32) -> Scalar {
        Scalar(self.0 >> by)
    }
}

impl Word<One> for Scalar {
    #[inline(always)]
    fn is(self, other: Scalar) -> bool {
        self.0 == other.0
    }
    #[inline(always)]
    fn below(self, other: Scalar) -> bool {
        self.0 < other.0
    }
    #[inline(always)]
    fn float(self) -> f32 {
        f32::from_bits(self.0)
    }
    #[inline(always)]
    fn count(self) -> f32 {
        self.0 as f32
    }
    #[inline(always)]
    fn reversed(self) -> Scalar {
        Scalar(self.0.reverse_bits())
    }
    #[inline(always)]
    fn get(self, _: usize) -> u32 {
        self.0
    }
    #[inline(always)]
    fn set(&mut self, _: usize, value: u32) {
        self.0 = value;
    }
    #[inline(always)]
    fn spread(self, mask: bool, other: Scalar) -> Scalar {
        if mask { self } else { other }
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[0] = self.0;
    }
}

impl Mask<One> for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
    #[inline(always)]
    fn pick(self, yes: f32, no: f32) -> f32 {
        if self { yes } else { no }
    }
    #[inline(always)]
    fn pick_word(self, yes: Scalar, no: Scalar) -> Scalar {
        if self { yes } else { no }
    }
}
