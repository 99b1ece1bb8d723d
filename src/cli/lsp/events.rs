//! Changes on the disk that nobody has heard of yet. They come on other threads, in any number; nothing of them is lost, and
//! little is kept.

use crossbeam_channel::{Receiver, Sender, bounded};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// The most paths that are kept.
const MOST: usize = 1_000;

/// What may have changed.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Files, links, or folders with all that is in them.
    pub paths: BTreeSet<PathBuf>,
    /// Whether anything else may have changed too.
    pub others: bool,
}

/// Where changes wait.
#[derive(Debug)]
pub struct Events {
    waiting: Mutex<Changes>,
    bell: Sender<()>,
}

impl Events {
    /// None yet, and what rings once there are some.
    pub fn new() -> (Events, Receiver<()>) {
        let (bell, rings) = bounded(1);
        (Events { waiting: Mutex::default(), bell }, rings)
    }

    /// These paths may have changed; where there are none, it is not known which.
    pub fn add(&self, paths: &[PathBuf]) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.paths.extend(paths.iter().cloned());
        waiting.others |= paths.is_empty();
        if waiting.paths.len() > MOST {
            *waiting = Changes { others: true, ..Changes::default() };
        }
        drop(waiting);
        // Where it rings already, this is taken with the rest.
        let _ = self.bell.try_send(());
    }

    /// All that wait, which are forgotten.
    pub fn take(&self) -> Changes {
        std::mem::take(&mut self.waiting.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_and_little_is_kept() {
        let (events, rings) = Events::new();
        let paths = |range: std::ops::Range<usize>| -> Vec<PathBuf> {
            range.map(|n| PathBuf::from(format!("/{n}"))).collect()
        };
        events.add(&paths(0..1));
        events.add(&paths(1..2));
        assert!(rings.try_recv().is_ok() && rings.try_recv().is_err());
        assert_eq!(events.take(), Changes { paths: paths(0..2).into_iter().collect(), others: false });
        events.add(&[]);
        assert!(rings.try_recv().is_ok());
        assert_eq!(events.take(), Changes { others: true, ..Changes::default() });
        for n in 0..MOST + 5 {
            events.add(&paths(n..n + 1));
        }
        let Changes { paths, others } = events.take();
        assert!(paths.len() <= MOST && others);
    }
}
