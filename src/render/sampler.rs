//! Random numbers that are a pure function of seed, pixel, sample and dimension.
//!
//! The points are Sobol's first two dimensions with Owen's scrambling, padded: every pair of dimensions is the
//! same two-dimensional sequence, its order shuffled and its digits scrambled by hashes of pixel and pair
//! (Brent Burley, "Practical hash-based Owen scrambling", JCGT 2020). Any 2ᵏ samples of a pixel from a multiple
//! of 2ᵏ are stratified in every pair, and pairs are independent of each other.

/// Pairs of dimensions of one camera path: two for the camera, then the same number for each vertex, whatever
/// happens there, so that a dimension's meaning does not depend on branches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Place within the pixel's filter.
    Film,
    /// Place on the lens.
    Lens,
    /// Direction of scattering at the vertex of that index.
    Direction(u32),
    /// Which lobe scatters, and whether roulette lets the path live.
    Lobe(u32),
    /// Point on a light.
    Light(u32),
    /// Which light, and which of its parts.
    Choice(u32),
}

impl Pair {
    fn index(self) -> u64 {
        let (vertex, offset) = match self {
            Pair::Film => return 0,
            Pair::Lens => return 1,
            Pair::Direction(vertex) => (vertex, 2),
            Pair::Lobe(vertex) => (vertex, 3),
            Pair::Light(vertex) => (vertex, 4),
            Pair::Choice(vertex) => (vertex, 5),
        };
        offset + 4 * u64::from(vertex)
    }
}

/// The numbers of one camera path.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    key: u64,
    sample: u32,
}

impl Sampler {
    /// Those of a sample of a pixel of the full picture.
    pub fn new(seed: u64, x: u32, y: u32, sample: u32) -> Sampler {
        Sampler { key: mix(mix(seed) ^ (u64::from(x) | u64::from(y) << 32)), sample }
    }

    /// Two numbers in (0, 1).
    pub fn pair(&self, pair: Pair) -> [f64; 2] {
        // The odd constant is 2⁶⁴ over the golden ratio: it spreads successive pairs over all bits.
        let hash = mix(self.key ^ pair.index().wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let scramble = mix(hash);
        let index = owen(self.sample, hash as u32);
        let x = owen(van_der_corput(index), scramble as u32);
        let y = owen(pascal(index), (scramble >> 32) as u32);
        [unit(x), unit(y)]
    }
}

/// The middle of one of 2³² cells of the unit interval.
fn unit(x: u32) -> f64 {
    (f64::from(x) + 0.5) * (1.0 / 4_294_967_296.0)
}

/// Sobol's first dimension.
fn van_der_corput(index: u32) -> u32 {
    index.reverse_bits()
}

/// Sobol's second dimension. Its generator matrix is Pascal's triangle modulo 2, where entry (i, j) is 1 if the
/// bits of i are among those of j (Lucas): so digit i is the parity of the index bits j ⊇ i, and one step for
/// each of the five bits of a position sums them.
fn pascal(index: u32) -> u32 {
    let mut x = index;
    x ^= (x & 0xaaaa_aaaa) >> 1;
    x ^= (x & 0xcccc_cccc) >> 2;
    x ^= (x & 0xf0f0_f0f0) >> 4;
    x ^= (x & 0xff00_ff00) >> 8;
    x ^= (x & 0xffff_0000) >> 16;
    x.reverse_bits()
}

/// Flips each binary digit depending on a hash of those before it (Owen's nested uniform scrambling), with the
/// constants of Burley's section 3: on the reversed word every step lets bits affect only higher ones.
fn owen(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits().wrapping_add(seed);
    for even in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6_u32] {
        x ^= x.wrapping_mul(even);
    }
    x.reverse_bits()
}

/// A bijection that spreads every bit over all others: the finaliser of SplitMix64 (Steele, Lea and Flood, "Fast
/// splittable pseudorandom number generators", 2014).
pub(super) fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
