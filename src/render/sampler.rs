//! Random numbers that are a pure function of seed, pixel, sample and dimension.
//!
//! The points are Sobol's first two dimensions with Owen's scrambling, padded: every pair of dimensions is the
//! same two-dimensional sequence, its order shuffled and its digits scrambled by hashes of pixel and pair
//! (Brent Burley, "Practical hash-based Owen scrambling", JCGT 2020). Any 2ᵏ samples of a pixel from a multiple
//! of 2ᵏ are stratified in every pair, and pairs are independent of each other.

use super::lanes::{Lanes, Word, apart};

/// Pairs of dimensions of one camera path: two for the camera, then the same number for each vertex, whatever
/// happens there, so that a dimension's meaning does not depend on branches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Place within the pixel's filter.
    Film,
    /// Place on the lens.
    Lens,
    /// Direction of scattering at a vertex.
    Direction,
    /// Which lobe scatters, and whether roulette lets the path live.
    Lobe,
    /// Point on a light.
    Light,
    /// Which light, and which of its parts.
    Choice,
    /// Whether to look for a caustic, and by which chain.
    Seed,
    /// Where on the lamp of a caustic.
    Chain,
}

impl Pair {
    /// Its index at the vertex with none before it.
    #[inline(always)]
    fn first(self) -> u32 {
        match self {
            Pair::Film => 0,
            Pair::Lens => 1,
            Pair::Direction => 2,
            Pair::Lobe => 3,
            Pair::Light => 4,
            Pair::Choice => 5,
            // Far behind all others.
            Pair::Seed => CAUSTIC,
            Pair::Chain => CAUSTIC + 1,
        }
    }
}

/// Pairs of each vertex.
const EACH: u32 = 4;
/// Where the pairs for caustics begin: so far on that no others come there, so that nothing depends on them where there
/// are no caustics.
const CAUSTIC: u32 = 1 << 24;
/// 2³² over the golden ratio: it spreads successive pairs over all bits.
const GOLDEN: u32 = 0x9e37_79b9;

/// The numbers of one camera path a lane.
#[derive(Clone, Copy)]
pub struct Sampler<L: Lanes> {
    /// Hash of seed and pixel.
    pub key: [L::U; 2],
    /// The sample's index, its bits in the opposite order.
    pub index: L::U,
}

/// The hash of a seed, for [`Sampler::new`].
pub fn seed_key(seed: u64) -> [u32; 2] {
    let key = mix_wide(seed);
    [key as u32, (key >> 32) as u32]
}

/// A bijection that spreads every bit over all others: the finaliser of SplitMix64 (Steele, Lea and Flood, "Fast
/// splittable pseudorandom number generators", 2014).
pub(super) fn mix_wide(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl<L: Lanes> Sampler<L> {
    /// Those of a sample of a pixel of the full picture.
    #[inline(always)]
    pub fn new(l: L, seed: [u32; 2], x: L::U, y: L::U, sample: L::U) -> Sampler<L> {
        let a = mix(l, x ^ l.u(seed[0]));
        let b = mix(l, y + a);
        Sampler { key: [b, mix(l, b ^ l.u(seed[1])) + a], index: sample.reversed() }
    }

    /// Two numbers in (0, 1), at the vertex that so many others went before.
    #[inline(always)]
    pub fn pair(&self, l: L, pair: Pair, vertex: L::U) -> [L::F; 2] {
        let [numbers] = self.pairs(l, [pair], vertex);
        numbers
    }

    /// Several pairs at a vertex. Each is a long chain of steps that wait for each other, so together they take not much
    /// longer than one.
    #[inline(always)]
    pub fn pairs<const N: usize>(&self, l: L, pairs: [Pair; N], vertex: L::U) -> [[L::F; 2]; N] {
        apart(
            l,
            #[inline(always)]
            || self.pairs_here(l, pairs, vertex),
        )
    }

    #[inline(always)]
    fn pairs_here<const N: usize>(&self, l: L, pairs: [Pair; N], vertex: L::U) -> [[L::F; 2]; N] {
        // Step by step for all pairs, so that each step has others to do while it waits.
        let base = self.key[0] + vertex * l.u(EACH.wrapping_mul(GOLDEN));
        let mut hash = [base; N];
        for (hash, pair) in hash.iter_mut().zip(pairs) {
            *hash = mix(l, *hash + l.u(pair.first().wrapping_mul(GOLDEN))) ^ self.key[1];
        }
        let mut shuffle = hash;
        for shuffle in &mut shuffle {
            *shuffle = mix(l, *shuffle);
        }
        let mut scramble = shuffle;
        for scramble in &mut scramble {
            *scramble = mix(l, *scramble ^ self.key[0]);
        }
        let mut index = shuffle;
        for index in &mut index {
            *index = owen(l, self.index, *index).reversed();
        }
        let mut numbers = [[l.f(0.0); 2]; N];
        for i in 0..N {
            // Sobol's first dimension is the index with its digits reversed, as Owen's scrambling wants it reversed again.
            let x = owen(l, index[i], scramble[i]).reversed();
            let y = owen(l, pascal(l, index[i]), mix(l, scramble[i])).reversed();
            numbers[i] = [unit(l, x), unit(l, y)];
        }
        numbers
    }
}

/// The middle of one of 2²³ cells of the unit interval.
#[inline(always)]
fn unit<L: Lanes>(l: L, x: L::U) -> L::F {
    // The number from 1 to 2 with these digits, less 1 and plus half a cell: exact.
    ((x >> 9) | l.u(0x3f80_0000)).float() - (1.0 - 1.0 / 16_777_216.0)
}

/// Sobol's second dimension, before its digits are reversed. Its generator matrix is Pascal's triangle modulo 2,
/// where entry (i, j) is 1 if the bits of i are among those of j (Lucas): so digit i is the parity of the index
/// bits j ⊇ i, and one step for each of the five bits of a position sums them.
#[inline(always)]
fn pascal<L: Lanes>(l: L, index: L::U) -> L::U {
    let x = index;
    let x = x ^ ((x & l.u(0xaaaa_aaaa)) >> 1);
    let x = x ^ ((x & l.u(0xcccc_cccc)) >> 2);
    let x = x ^ ((x & l.u(0xf0f0_f0f0)) >> 4);
    let x = x ^ ((x & l.u(0xff00_ff00)) >> 8);
    x ^ (x >> 16)
}

/// Owen's nested uniform scrambling of a number given with its digits reversed, so that its leading digit is the
/// lowest bit: flips each digit depending on a hash of those before it, with the constants of Burley's section 3.
/// Every step lets bits affect only higher ones.
#[inline(always)]
fn owen<L: Lanes>(l: L, x: L::U, seed: L::U) -> L::U {
    let x = x + seed;
    let x = x ^ (x * l.u(0x6c50_b47c));
    let x = x ^ (x * l.u(0xb82f_1e52));
    let x = x ^ (x * l.u(0xc7af_e638));
    x ^ (x * l.u(0x8d22_f6e6))
}

/// A bijection that spreads every bit over all others (Chris Wellons, "Prospecting for hash functions", 2018:
/// `lowbias32`).
#[inline(always)]
fn mix<L: Lanes>(l: L, x: L::U) -> L::U {
    let x = (x ^ (x >> 16)) * l.u(0x7feb_352d);
    let x = (x ^ (x >> 15)) * l.u(0x846c_a68b);
    x ^ (x >> 16)
}
