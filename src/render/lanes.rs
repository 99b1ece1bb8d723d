//! One number for each of several paths: the arithmetic that the tracer is written in.
//!
//! Everything that is done once a ray is generic over [`Lanes`], so that one source serves every width:
//! [`One`] lane, which reads and runs like plain scalar code and is the reference; [`Eight`] and [`Sixteen`] lanes on whatever
//! vector instructions the processor has. A lane never sees its neighbours, and only operations with one exact
//! result are offered (+ − × ÷ √, comparisons, integers; nothing fused), so every width gives the same bits.
//!
//! Code for lanes is made of plain functions marked `#[inline(always)]`: they must end up inside the function that
//! was compiled for the processor's instructions, see [`Lanes::run`].

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, f32x16, i32x8, i32x16, mask32x8, mask32x16, u8x32, u8x64, u32x8, u32x16};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// The greatest number of lanes.
pub const MOST: usize = 16;

/// A number of lanes on some vector instructions.
pub trait Lanes: Copy + Send + Sync + 'static {
    /// How many.
    const N: usize;
    /// A real number a lane.
    type F: Float<Self>;
    /// A 32-bit word a lane.
    type U: Word<Self>;
    /// A condition a lane.
    type M: Mask<Self>;
    /// As many of these lanes as make a divisor of eight: for one ray against eight things.
    type Group: Lanes;

    /// The lanes of a group.
    fn group(self) -> Self::Group;
    /// The same number in every lane.
    fn f(self, value: f32) -> Self::F;
    /// The same word in every lane.
    fn u(self, value: u32) -> Self::U;
    /// The condition of each lane by its bit.
    fn mask(self, bits: u32) -> Self::M;
    /// The first numbers of a slice, which has at least as many.
    fn load(self, from: &[f32]) -> Self::F;
    /// The first words of a slice, which has at least as many.
    fn load_words(self, from: &[u32]) -> Self::U;
    /// The columns of rows of a table, a row a lane.
    fn gather(self, table: &[[f32; 4]], rows: &[u32; MOST]) -> [Self::F; 4];
    /// Calls something in a function of its own that is compiled for the instructions.
    fn run<R>(self, f: impl FnOnce() -> R) -> R;
}

/// As [`Lanes::run`], and never made part of the caller: parts of the path loop stay functions of a size that compilers
/// deal with well.
#[inline(never)]
pub fn apart<L: Lanes, R>(l: L, f: impl FnOnce() -> R) -> R {
    l.run(f)
}

/// A real number (`f32`) a lane.
pub trait Float<L: Lanes<F = Self>>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
    + Neg<Output = Self>
{
    /// Square root, exactly rounded.
    fn root(self) -> Self;
    /// Magnitude.
    fn magnitude(self) -> Self;
    /// This magnitude with the sign of another.
    fn signed_as(self, sign: Self) -> Self;
    /// Whether less.
    fn lt(self, other: Self) -> L::M;
    /// Whether less or equal.
    fn le(self, other: Self) -> L::M;
    /// The bits.
    fn bits(self) -> L::U;
    /// The whole part of what lies in [0, 2³¹).
    fn whole(self) -> L::U;
    /// One lane.
    fn get(self, lane: usize) -> f32;
    /// Sets one lane.
    fn set(&mut self, lane: usize, value: f32);
    /// Spreads the lowest lanes over those of the mask, in order; the rest is what the other has.
    fn spread(self, mask: L::M, other: Self) -> Self;
    /// Writes all lanes to the start of a slice, which has room.
    fn store(self, to: &mut [f32]);

    /// The lesser; the other where either is no number.
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        self.lt(other).pick(self, other)
    }
    /// The greater; the other where either is no number.
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        other.lt(self).pick(self, other)
    }
    /// Whether greater.
    #[inline(always)]
    fn gt(self, other: Self) -> L::M {
        other.lt(self)
    }
}

/// A 32-bit word a lane; arithmetic wraps.
pub trait Word<L: Lanes>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// Whether equal.
    fn is(self, other: Self) -> L::M;
    /// Whether less.
    fn below(self, other: Self) -> L::M;
    /// The number with these bits.
    fn float(self) -> L::F;
    /// What it counts, of at most 2²⁴.
    fn count(self) -> L::F;
    /// The bits in the opposite order.
    fn reversed(self) -> Self;
    /// One lane.
    fn get(self, lane: usize) -> u32;
    /// Sets one lane.
    fn set(&mut self, lane: usize, value: u32);
    /// As [`Float::spread`].
    fn spread(self, mask: L::M, other: Self) -> Self;
    /// As [`Float::store`].
    fn store(self, to: &mut [u32]);
}

/// A condition a lane.
pub trait Mask<L: Lanes>: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether it holds in any lane.
    fn any(self) -> bool;
    /// The lanes where it holds, lowest bit first.
    fn bits(self) -> u32;
    /// The one where it holds, else the other.
    fn pick(self, yes: L::F, no: L::F) -> L::F;
    /// The one where it holds, else the other.
    fn pick_word(self, yes: L::U, no: L::U) -> L::U;

    /// The lanes where it holds, one after the other.
    #[inline(always)]
    fn lanes(self) -> Set {
        Set(self.bits())
    }
}

/// Lanes to go through one by one.
#[derive(Clone, Copy)]
pub struct Set(pub u32);

impl Iterator for Set {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros();
        self.0 &= self.0.wrapping_sub(1);
        (lane < u32::BITS).then_some(lane as usize)
    }
}

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
    fn gather(self, table: &[[f32; 4]], rows: &[u32; MOST]) -> [f32; 4] {
        table[rows[0] as usize]
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

macro_rules! vectors {
    ($(#[$doc:meta])* $name:ident, $n:literal, $gather:ident, $float:ident, $word:ident, $int:ident, $byte:ident, $bytes:literal, $mask:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name<S>(pub S);

        impl<S: Simd> Lanes for $name<S> {
            const N: usize = $n;
            type F = $float<S>;
            type U = $word<S>;
            type M = $mask<S>;
            type Group = Eight<S>;

            #[inline(always)]
            fn group(self) -> Eight<S> {
                Eight(self.0)
            }
            #[inline(always)]
            fn gather(self, table: &[[f32; 4]], rows: &[u32; MOST]) -> [$float<S>; 4] {
                $gather(self.0, table, rows)
            }
            #[inline(always)]
            fn f(self, value: f32) -> $float<S> {
                $float::splat(self.0, value)
            }
            #[inline(always)]
            fn u(self, value: u32) -> $word<S> {
                $word::splat(self.0, value)
            }
            #[inline(always)]
            fn mask(self, bits: u32) -> $mask<S> {
                $mask::from_bitmask(self.0, u64::from(bits))
            }
            #[inline(always)]
            fn load(self, from: &[f32]) -> $float<S> {
                $float::from_slice(self.0, &from[..$n])
            }
            #[inline(always)]
            fn load_words(self, from: &[u32]) -> $word<S> {
                $word::from_slice(self.0, &from[..$n])
            }
            #[inline(always)]
            fn run<R>(self, f: impl FnOnce() -> R) -> R {
                self.0.vectorize(f)
            }
        }

        impl<S: Simd> Float<$name<S>> for $float<S> {
            #[inline(always)]
            fn root(self) -> Self {
                self.sqrt()
            }
            #[inline(always)]
            fn magnitude(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn signed_as(self, sign: Self) -> Self {
                self.copysign(sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask<S> {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask<S> {
                self.simd_le(other)
            }
            #[inline(always)]
            fn bits(self) -> $word<S> {
                self.bitcast()
            }
            #[inline(always)]
            fn whole(self) -> $word<S> {
                // Signed numbers have an instruction everywhere.
                self.to_int::<$int<S>>().bitcast()
            }
            #[inline(always)]
            fn get(self, lane: usize) -> f32 {
                self[lane]
            }
            #[inline(always)]
            fn set(&mut self, lane: usize, value: f32) {
                self[lane] = value;
            }
            #[inline(always)]
            fn spread(self, mask: $mask<S>, other: Self) -> Self {
                self.expand_merge(mask, other)
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                self.store_slice(&mut to[..$n]);
            }
        }

        impl<S: Simd> Word<$name<S>> for $word<S> {
            #[inline(always)]
            fn is(self, other: Self) -> $mask<S> {
                self.simd_eq(other)
            }
            #[inline(always)]
            fn below(self, other: Self) -> $mask<S> {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn float(self) -> $float<S> {
                self.bitcast()
            }
            #[inline(always)]
            fn count(self) -> $float<S> {
                let signed: $int<S> = self.bitcast();
                signed.to_float()
            }
            #[inline(always)]
            fn reversed(self) -> Self {
                // Each half byte by a table, then the bytes.
                const BYTES: [u8; $bytes] = {
                    let mut order = [0; $bytes];
                    let mut i = 0;
                    while i < $bytes {
                        order[i] = (i % 16 / 4 * 4 + 3 - i % 4) as u8;
                        i += 1;
                    }
                    order
                };
                const NIBBLES: [u8; $bytes] = {
                    let mut table = [0; $bytes];
                    let mut i = 0;
                    while i < $bytes {
                        table[i] = ((i % 16) as u8).reverse_bits();
                        i += 1;
                    }
                    table
                };
                let simd = self.simd;
                let nibbles = $byte::simd_from(simd, NIBBLES);
                let low: $byte<S> = (self & 0x0f0f_0f0f).bitcast();
                let high: $byte<S> = ((self >> 4) & 0x0f0f_0f0f).bitcast();
                let low: Self = nibbles.swizzle_dyn_within_blocks(low).bitcast();
                let high: Self = nibbles.swizzle_dyn_within_blocks(high).bitcast();
                let bytes: $byte<S> = (low | (high >> 4)).bitcast();
                bytes.swizzle_dyn_within_blocks($byte::simd_from(simd, BYTES)).bitcast()
            }
            #[inline(always)]
            fn get(self, lane: usize) -> u32 {
                self[lane]
            }
            #[inline(always)]
            fn set(&mut self, lane: usize, value: u32) {
                self[lane] = value;
            }
            #[inline(always)]
            fn spread(self, mask: $mask<S>, other: Self) -> Self {
                self.expand_merge(mask, other)
            }
            #[inline(always)]
            fn store(self, to: &mut [u32]) {
                self.store_slice(&mut to[..$n]);
            }
        }

        impl<S: Simd> Mask<$name<S>> for $mask<S> {
            #[inline(always)]
            fn any(self) -> bool {
                self.any_true()
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                self.to_bitmask() as u32
            }
            #[inline(always)]
            fn pick(self, yes: $float<S>, no: $float<S>) -> $float<S> {
                self.select(yes, no)
            }
            #[inline(always)]
            fn pick_word(self, yes: $word<S>, no: $word<S>) -> $word<S> {
                self.select(yes, no)
            }
        }
    };
}

vectors! {
    /// Eight lanes: one register of AVX2, two of SSE or NEON.
    Eight, 8, gather_eight, f32x8, u32x8, i32x8, u8x32, 32, mask32x8
}
vectors! {
    /// Sixteen lanes: one register of AVX-512, two of AVX2.
    Sixteen, 16, gather_sixteen, f32x16, u32x16, i32x16, u8x64, 64, mask32x16
}

/// Four rows of a table as columns.
#[inline(always)]
fn gather_four<S: Simd>(simd: S, table: &[[f32; 4]], rows: &[u32; MOST], from: usize) -> [f32x4<S>; 4] {
    let mut square = [0.0; 16];
    square[0..4].copy_from_slice(&table[rows[from] as usize]);
    square[4..8].copy_from_slice(&table[rows[from + 1] as usize]);
    square[8..12].copy_from_slice(&table[rows[from + 2] as usize]);
    square[12..16].copy_from_slice(&table[rows[from + 3] as usize]);
    simd.load_four_interleaved_f32x4(&square)
}

#[inline(always)]
fn gather_eight<S: Simd>(simd: S, table: &[[f32; 4]], rows: &[u32; MOST]) -> [f32x8<S>; 4] {
    gather_pair(simd, table, rows, 0)
}

#[inline(always)]
fn gather_sixteen<S: Simd>(simd: S, table: &[[f32; 4]], rows: &[u32; MOST]) -> [f32x16<S>; 4] {
    let [a, b, c, d] = gather_pair(simd, table, rows, 0);
    let [e, f, g, h] = gather_pair(simd, table, rows, 8);
    [a.combine(e), b.combine(f), c.combine(g), d.combine(h)]
}

#[inline(always)]
fn gather_pair<S: Simd>(simd: S, table: &[[f32; 4]], rows: &[u32; MOST], from: usize) -> [f32x8<S>; 4] {
    let [a, b, c, d] = gather_four(simd, table, rows, from);
    let [e, f, g, h] = gather_four(simd, table, rows, from + 4);
    [a.combine(e), b.combine(f), c.combine(g), d.combine(h)]
}
