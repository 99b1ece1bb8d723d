//! Long texts are answered in a time that grows as they do, and no longer than the answer is wanted.

use super::{analysed, root};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Materials, each with a sphere that names it.
fn text(lines: usize) -> String {
    let line = |n| {
        format!("material m{n} = diffuse {{ color: red }}\nsphere s{n} {{ radius: 1m, material: m{n} }}\n")
    };
    (0..lines).map(line).collect()
}

/// How long the quickest of some tries takes: of so many that the machine is not busy with something else in all of them.
fn quickest(mut run: impl FnMut()) -> Duration {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed()
    };
    (0..20).map(time).min().unwrap()
}

#[test]
fn the_words_of_a_long_text_are_soon_known() {
    let time = |lines: usize| {
        let text = text(lines);
        let analysis = analysed(&root(), "long.rt", &text);
        let mut found = 0;
        let time = quickest(|| found = analysis.tokens(0..text.len(), &|| false).len());
        assert_eq!(found, 13 * lines);
        time
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
