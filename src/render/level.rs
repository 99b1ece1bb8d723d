//! Which vector instructions the tracer runs on.

#[cfg(target_arch = "x86_64")]
use super::lanes::{Eight, Sixteen};
use super::lanes::{Four, One};
use fearless_simd::Level as Processor;

/// A set of vector instructions, the narrowest first. Which are there depends on the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// None: one path at a time.
    One,
    /// SSE2, which every x86-64 processor has, or NEON.
    Basic,
    /// AVX2.
    Avx2,
    /// AVX-512 of Ice Lake and later.
    Avx512,
}

impl Level {
    /// All of them.
    pub const ALL: [Level; 4] = [Level::One, Level::Basic, Level::Avx2, Level::Avx512];

    /// The best that the processor has.
    pub fn best() -> Level {
        Level::ALL.into_iter().rev().find(|level| level.is_there()).unwrap_or(Level::One)
    }

    /// Whether the processor has it.
    pub fn is_there(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Level::One | Level::Basic => true,
            Level::Avx2 => Processor::new().as_avx2().is_some(),
            Level::Avx512 => Processor::new().as_avx512().is_some(),
        };
        #[cfg(not(target_arch = "x86_64"))]
        return self <= Level::Basic;
    }

    /// Runs a task on it, or on the best below it that the processor has.
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        let processor = Processor::new();
        #[cfg(target_arch = "x86_64")]
        match self {
            Level::One => {}
            Level::Avx512 if let Some(simd) = processor.as_avx512() => return task.run(Sixteen(simd)),
            Level::Avx512 | Level::Avx2 if let Some(simd) = processor.as_avx2() => {
                return task.run(Eight(simd));
            }
            _ => {
                if let Some(simd) = processor.as_sse2() {
                    return task.run(Four(simd));
                }
            }
        }
        #[cfg(target_arch = "aarch64")]
        if self > Level::One
            && let Some(simd) = processor.as_neon()
        {
            return task.run(Four(simd));
        }
        let _ = processor;
        task.run(One)
    }
}

/// Something to do in lanes, however many they are.
pub(super) trait Task {
    /// What comes of it.
    type Output;
    /// Does it.
    fn run<L: super::lanes::Lanes>(self, l: L) -> Self::Output;
}
