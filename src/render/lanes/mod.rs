//! One number for each of several paths: the arithmetic that the tracer is written in.
//!
//! Everything that is done once a ray is generic over [`Lanes`], so that one source serves every width:
//! [`One`] lane, which reads and runs like plain scalar code and is the reference; [`Four`], [`Eight`] and [`Sixteen`]
//! lanes on whatever vector instructions the processor has. A lane never sees its neighbours, and only operations with one exact
//! result are offered (+ − × ÷ √, comparisons, integers; nothing fused), so every width gives the same bits.
//!
//! Code for lanes is made of plain functions marked `#[inline(always)]`: they must end up inside the function that
//! was compiled for the processor's instructions, see [`Lanes::run`]. A plain function or a closure given to `map` of an
//! array may stay outside, and then every call of it sends all registers through memory: small functions on the way are
//! `#[inline]`, and arrays are gone through by loops.

mod one;
mod table;
mod vectors;

pub use one::One;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};
pub use table::Table;
pub use vectors::{Eight, Four, Sixteen};

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
    /// Writes numbers and words of the lanes where the first number is at most the second to the starts of slices, first
    /// those of which lane number xor `turn` is greatest; returns how many. There must be room for all lanes, and what is
    /// behind the last may be overwritten.
    #[inline(always)]
    fn sift(self, ends: [Self::F; 2], words: Self::U, turn: u32, to: (&mut [f32], &mut [u32])) -> usize {
        let some = ends[0].le(ends[1]).bits();
        let (mut count, mut place) = (0, 0);
        while place < Self::N {
            let lane = (Self::N - 1 - place) ^ (turn as usize & (Self::N - 1));
            (to.0[count], to.1[count]) = (ends[0].get(lane), words.get(lane));
            count += (some >> lane & 1) as usize;
            place += 1;
        }
        count
    }
    /// The columns of rows of a table, a row a lane.
    fn look_up(self, table: &Table, rows: Self::U) -> [Self::F; 4];
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
    /// The lesser of two numbers; where either is none, any of them.
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.lesser(other)
    }
    /// The greater of two numbers; where either is none, any of them.
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        self.greater(other)
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
