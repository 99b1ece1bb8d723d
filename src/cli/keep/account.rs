//! What was there of a picture's samples, and what is kept of them, in words.

use super::build;
use rt_lang::render::making::Making;
use std::path::{Path, PathBuf};

/// Which of a picture's samples were there before, and where they are kept.
#[derive(Default)]
pub struct Account {
    /// What was gone on from.
    pub(super) from: Option<Amount>,
    /// What is kept.
    pub(super) to: Option<Amount>,
    /// Whether there are more that could not be kept.
    pub(super) lacks: bool,
}

/// Samples in a file.
#[derive(Clone)]
pub(super) struct Amount {
    /// How many, in words.
    samples: String,
    /// How many a pixel has on average.
    pub(super) mean: f64,
    file: PathBuf,
}

impl Amount {
    /// Those of a picture in the making, in this file.
    pub(super) fn of(making: &Making, file: &Path) -> Amount {
        let mean = making.mean_samples();
        Amount { samples: build::count(making.samples(), mean), mean, file: file.into() }
    }
}

impl Account {
    /// From what it was gone on, in words.
    pub fn went_on(&self) -> Option<String> {
        let from = self.from.as_ref()?;
        Some(format!("went on from {} in `{}`", from.samples, from.file.display()))
    }

    /// What is kept, in words.
    pub(super) fn kept(&self) -> Option<String> {
        let kept = self.to.as_ref().map(|to| format!("kept {} in `{}`", to.samples, to.file.display()));
        self.with_lack(kept)
    }

    /// A line about both.
    pub fn line(&self) -> Option<String> {
        let there = self.to.as_ref().zip(self.from.as_ref()).filter(|(to, from)| from.file == to.file);
        let kept = match there {
            Some((to, from)) if from.mean == to.mean => match self.lacks {
                true => Some("could keep no more".to_string()),
                false => Some("where nothing was left to trace".to_string()),
            },
            Some((to, _)) => self.with_lack(Some(format!("kept {} there", to.samples))),
            None => self.kept(),
        };
        let parts: Vec<String> = self.went_on().into_iter().chain(kept).collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }

    /// What is said of what is kept, and that it is not all.
    fn with_lack(&self, kept: Option<String>) -> Option<String> {
        match (kept, self.lacks) {
            (Some(kept), true) => Some(format!("{kept}, could keep no more")),
            (None, true) => Some("could keep none".to_string()),
            (kept, false) => kept,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_account_never_says_that_what_could_not_be_kept_is() {
        let amount = |mean: u32, file: &str| {
            Some(Amount { samples: format!("{mean} samples"), mean: mean.into(), file: file.into() })
        };
        let told = |from, to, lacks| {
            let account = Account { from, to, lacks };
            [account.line(), account.kept()].map(Option::unwrap_or_default)
        };
        let went_on = "went on from 4 samples in `a`";
        for (from, to, line, kept) in [
            (None, None, "could keep none", "could keep none"),
            (None, amount(7, "a"), "kept 7 samples in `a`, could keep no more", ""),
            (amount(4, "a"), None, &format!("{went_on}, could keep none"), "could keep none"),
            (
                amount(4, "a"),
                amount(4, "a"),
                &format!("{went_on}, could keep no more"),
                "kept 4 samples in `a`, could keep no more",
            ),
            (
                amount(4, "a"),
                amount(7, "a"),
                &format!("{went_on}, kept 7 samples there, could keep no more"),
                "kept 7 samples in `a`, could keep no more",
            ),
        ] {
            let kept = if kept.is_empty() { line } else { kept };
            assert_eq!(told(from, to, true), [line, kept]);
        }
    }
}
