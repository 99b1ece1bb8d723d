//! Which of two ways to find a light counts, and how much.

use crate::render::lanes::{Float, Lanes, Mask};

/// Which of the two ways to find a light counts. Both, shared; the others are for tests that compare them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(test), expect(dead_code, reason = "tests compare the ways"))]
pub enum Sharing {
    Both,
    OnlyGathered,
    OnlyFound,
}

impl Sharing {
    /// What counts of light that was found by chance, of density `found`, where a light could have been sampled
    /// with density `gathered`.
    #[inline(always)]
    pub fn found<L: Lanes>(self, l: L, found: L::F, gathered: L::F) -> L::F {
        match self {
            Sharing::Both => power_heuristic(l, found, gathered),
            Sharing::OnlyGathered => {
                let counts = l.f(f32::INFINITY).le(found) | gathered.le(l.f(0.0));
                counts.pick(l.f(1.0), l.f(0.0))
            }
            Sharing::OnlyFound => l.f(1.0),
        }
    }

    /// What counts of light that was sampled.
    #[inline(always)]
    pub fn gathered<L: Lanes>(self, l: L, gathered: L::F, found: L::F) -> L::F {
        match self {
            Sharing::Both => power_heuristic(l, gathered, found),
            Sharing::OnlyGathered => l.f(1.0),
            Sharing::OnlyFound => l.f(0.0),
        }
    }
}

/// The share of a way to find light that has density `this`, beside one of density `other`.
#[inline(always)]
fn power_heuristic<L: Lanes>(l: L, this: L::F, other: L::F) -> L::F {
    // By the ratio, which neither overflows nor underflows to 0/0.
    let ratio = other / this;
    l.f(1.0) / (ratio * ratio + 1.0)
}
