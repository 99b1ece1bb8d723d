//! Lanes on vector instructions.

use super::{Float, Lanes, MOST, Mask, Table, Word};
use fearless_simd::prelude::*;
use fearless_simd::{
    f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, mask32x4, mask32x8, mask32x16, u8x16, u8x32, u8x64, u32x4,
    u32x8, u32x16,
};

macro_rules! vectors {
    ($(#[$doc:meta])* $name:ident, $n:literal, $group:ident, $look_up:ident, $float:ident, $word:ident, $int:ident, $byte:ident, $bytes:literal, $mask:ident $(, { $($own:tt)* })?) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name<S>(pub S);

        impl<S: Simd> Lanes for $name<S> {
            const N: usize = $n;
            type F = $float<S>;
            type U = $word<S>;
            type M = $mask<S>;
            type Group = $group<S>;

            #[inline(always)]
            fn group(self) -> $group<S> {
                $group(self.0)
            }
            #[inline(always)]
            fn look_up(self, table: &Table, rows: $word<S>) -> [$float<S>; 4] {
                $look_up(self.0, table, rows)
            }
            $($($own)*)?
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
            fn least(self, other: Self) -> Self {
                self.min(other)
            }
            #[inline(always)]
            fn most(self, other: Self) -> Self {
                self.max(other)
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
    /// Four lanes: a register of SSE or NEON.
    Four, 4, Four, look_up_four, f32x4, u32x4, i32x4, u8x16, 16, mask32x4
}
vectors! {
    /// Eight lanes: a register of AVX2.
    Eight, 8, Eight, look_up_eight, f32x8, u32x8, i32x8, u8x32, 32, mask32x8, {
        #[inline(always)]
        fn sift(
            self,
            [enter, leave]: [f32x8<S>; 2],
            words: u32x8<S>,
            turn: u32,
            to: (&mut [f32], &mut [u32]),
        ) -> usize {
            sift_eight(self.0, [enter, leave], words, turn, to)
        }
    }
}
vectors! {
    /// Sixteen lanes: a register of AVX-512, or two of AVX2.
    Sixteen, 16, Eight, look_up_sixteen, f32x16, u32x16, i32x16, u8x64, 64, mask32x16
}

#[inline(always)]
fn look_up_four<S: Simd>(simd: S, table: &Table, rows: u32x4<S>) -> [f32x4<S>; 4] {
    let mut at = [0; MOST];
    rows.store_slice(&mut at[..4]);
    gather_four(simd, &table.rows, &at, 0)
}

#[inline(always)]
fn look_up_eight<S: Simd>(simd: S, table: &Table, rows: u32x8<S>) -> [f32x8<S>; 4] {
    let mut at = [0; MOST];
    rows.store_slice(&mut at[..8]);
    gather_eight(simd, &table.rows, &at, 0)
}

#[inline(always)]
fn look_up_sixteen<S: Simd>(simd: S, table: &Table, rows: u32x16<S>) -> [f32x16<S>; 4] {
    if let Some(columns) = &table.columns {
        // The places of the four bytes of a number in its column.
        let bytes: u8x64<S> = (rows * 0x0404_0404 + 0x0302_0100).bitcast();
        let [x, y, z, w] = columns.as_ref();
        return [
            f32x16::from_slice(simd, x).swizzle_dyn(bytes),
            f32x16::from_slice(simd, y).swizzle_dyn(bytes),
            f32x16::from_slice(simd, z).swizzle_dyn(bytes),
            f32x16::from_slice(simd, w).swizzle_dyn(bytes),
        ];
    }
    let mut at = [0; MOST];
    rows.store_slice(&mut at);
    let [a, b, c, d] = gather_eight(simd, &table.rows, &at, 0);
    let [e, f, g, h] = gather_eight(simd, &table.rows, &at, 8);
    [a.combine(e), b.combine(f), c.combine(g), d.combine(h)]
}

/// Four rows as columns.
#[inline(always)]
fn gather_four<S: Simd>(simd: S, rows: &[[f32; 4]], at: &[u32; MOST], from: usize) -> [f32x4<S>; 4] {
    let mut square = [0.0; 16];
    square[0..4].copy_from_slice(&rows[at[from] as usize]);
    square[4..8].copy_from_slice(&rows[at[from + 1] as usize]);
    square[8..12].copy_from_slice(&rows[at[from + 2] as usize]);
    square[12..16].copy_from_slice(&rows[at[from + 3] as usize]);
    simd.load_four_interleaved_f32x4(&square)
}

#[inline(always)]
fn gather_eight<S: Simd>(simd: S, rows: &[[f32; 4]], at: &[u32; MOST], from: usize) -> [f32x8<S>; 4] {
    let [a, b, c, d] = gather_four(simd, rows, at, from);
    let [e, f, g, h] = gather_four(simd, rows, at, from + 4);
    [a.combine(e), b.combine(f), c.combine(g), d.combine(h)]
}

/// As [`Lanes::sift`], without branches: the lanes are put in order, and then moved together.
#[inline(always)]
fn sift_eight<S: Simd>(
    simd: S,
    [enter, leave]: [f32x8<S>; 2],
    words: u32x8<S>,
    turn: u32,
    (enters, to): (&mut [f32], &mut [u32]),
) -> usize {
    const BYTES: [u8; 32] = {
        let mut order = [0; 32];
        let mut i = 0;
        while i < 32 {
            order[i] = i as u8;
            i += 1;
        }
        order
    };
    let swap = u32x8::splat(simd, (7 ^ (turn & 7)) * 0x0404_0404);
    let order: u8x32<S> = (u8x32::simd_from(simd, BYTES).bitcast::<u32x8<S>>() ^ swap).bitcast();
    let (enter, leave) = (enter.swizzle_dyn(order), leave.swizzle_dyn(order));
    let some = enter.simd_le(leave);
    enter.compress(some).store_slice(&mut enters[..8]);
    words.swizzle_dyn(order).compress(some).store_slice(&mut to[..8]);
    some.to_bitmask().count_ones() as usize
}
