//! Long texts are answered in a time that grows as they do, and no longer than the answer is wanted.

use super::{analysed, root};
use crate::work::work;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Materials, each with a sphere that names it.
fn text(lines: usize) -> String {
    let line = |n| {
        format!("material m{n} = diffuse {{ color: red }}\nsphere s{n} {{ radius: 1m, material: m{n} }}\n")
    };
    (0..lines).map(line).collect()
}

#[test]
fn the_words_of_a_long_text_are_soon_known() {
    let time = |lines: usize| {
        let text = text(lines);
        let analysis = analysed(&root(), "long.rt", &text);
        let run = |_| {
            let (time, found) = work(|| analysis.tokens(0..text.len(), &|| false).len());
            assert_eq!(found, 13 * lines);
            time
        };
        (0..5).map(run).min().unwrap()
    };
    // Ten times as much takes about ten times as long; with the square of the length it would be a hundred times.
    let (short, long) = (time(1_000), time(10_000));
    assert!(long < 40 * short, "{short:?} became {long:?}");
}

#[test]
fn an_answer_that_is_not_wanted_ends() {
    let text = text(1_000);
    let analysis = analysed(&root(), "long.rt", &text);
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) > 100;
    assert!(analysis.tokens(0..text.len(), &stop).len() < 100);
    asked.store(0, Ordering::Relaxed);
    assert!(analysis.colours(&stop).len() < 100);
    asked.store(0, Ordering::Relaxed);
    let _ = analysis.hints(0..text.len(), &stop);
    assert!(asked.load(Ordering::Relaxed) < 3_000, "{asked:?}");
}
