//! How soon an editor has its answers on a text of 2 000 lines: `cargo bench --bench ide`.

use divan::Bencher;
use rt_lang::eval::Limits;
use rt_lang::files::{FileError, FilePath, Files, Memory};
use rt_lang::ide::{Analysis, complete, signatures};
use rt_lang::source::Source;
use rt_lang::{Options, analyse};
use scenes::Numbers;
use std::fmt::Write;
use std::sync::Arc;

mod scenes;

fn main() {
    divan::main();
}

const LINES: usize = 2000;

/// No files, and what was read before.
#[derive(Default)]
struct Desk(Memory);

impl Files for Desk {
    fn read(&self, _: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        Err(FileError::Missing)
    }

    fn memory(&self) -> Option<&Memory> {
        Some(&self.0)
    }
}

/// A text as it is edited: a letter longer each time.
fn edited(text: &str) -> impl Fn() -> String {
    let edits = std::cell::Cell::new(0);
    move || {
        edits.set(edits.get() + 1);
        text.replacen("seat / 2", &format!("seat / {}", edits.get()), 1)
    }
}

/// A text as people write them: parts, materials, groups, loops, and things that use them.
fn written() -> String {
    let mut text = String::from(
        "/// How many.\nparam count: int = 7 in 1 to 20\nplane { at: (0, -100, 0)m, material: diffuse { color: #705848 } }\n",
    );
    let mut numbers = Numbers(1);
    for block in 0.. {
        if text.lines().count() + 5 > LINES {
            break;
        }
        let [x, y, z] = [(); 3].map(|()| numbers.metres());
        let piece = format!(
            "material glaze{block} = plastic {{ color: #{:06x}, roughness: {}% }}\n\
             let r{block} = {}mm * (1 + rand({block}))\n\
             /// A stool like others.\n\
             part stool{block} {{\n  \
               param seat: length = 45cm in 20cm to 1m\n  \
               let half = seat / 2\n  \
               cylinder leg {{ radius: 3cm, height: seat, material: glaze{block} }}\n  \
               sphere cushion {{\n    radius: r{block} + half / 4\n    at: (0, seat, 0)\n    material: glaze{block}\n  }}\n\
             }}\n\
             stool{block} left{block} {{ at: ({x:.2}, {y:.2}, {z:.2})m, seat: 50cm }}\n\
             for i in range(count) {{\n  \
               sphere {{ at: (i * 1m, {y:.2}m, {z:.2}m), radius: r{block}, material: glaze{block} }}\n\
             }}\n",
            block * 7919 % 0xff_ffff,
            block % 100,
            block % 9 + 1,
        );
        text.push_str(&piece);
    }
    writeln!(text, "light {{ at: (2, 30, 4)m, power: 6kW }}").expect("a string takes all");
    text
}

/// The same things written one by one.
fn flat() -> String {
    let (mut text, mut numbers) = (String::new(), Numbers(1));
    for _ in 0..LINES {
        let [x, y, z] = [(); 3].map(|()| numbers.metres());
        writeln!(text, "sphere {{ at: ({x:.2}, {y:.2}, {z:.2})m, radius: 12mm }}")
            .expect("a string takes all");
    }
    text
}

fn analysed(desk: &Desk, text: &str) -> Analysis {
    let source = Source::new("bench.rt", text);
    let analysis = analyse(desk, source, &Options::default(), &|| false);
    analysis.expect("nobody stops it")
}

/// The first time that a text is opened.
#[divan::bench]
fn diagnostics_at_first(bencher: Bencher) {
    let text = written();
    bencher.bench(|| analysed(&Desk::default(), &text));
}

#[divan::bench]
fn diagnostics(bencher: Bencher) {
    let (text, desk) = (written(), Desk::default());
    assert!(
        analysed(&desk, &text).diagnostics.is_empty(),
        "{:?}",
        analysed(&desk, &text).diagnostics.first()
    );
    bencher.with_inputs(edited(&text)).bench_local_refs(|text| analysed(&desk, text));
}

#[divan::bench]
fn diagnostics_of_an_error(bencher: Bencher) {
    let (text, desk) = (written().replacen("radius: 3cm", "raduis: 3cm", 1), Desk::default());
    assert!(!analysed(&desk, &text).diagnostics.is_empty());
    bencher.with_inputs(edited(&text)).bench_local_refs(|text| analysed(&desk, text));
}

#[divan::bench]
fn diagnostics_of_rows(bencher: Bencher) {
    let (text, desk) = (flat(), Desk::default());
    bencher.with_inputs(edited(&text)).bench_local_refs(|text| analysed(&desk, text));
}

/// What completion takes where a text ends in an unfinished statement.
fn completed(bencher: Bencher, unfinished: &str) {
    let (text, desk) = (written() + unfinished, Desk::default());
    let source = Source::new("bench.rt", text.as_str());
    let found = || complete(&desk, &source, text.len(), &Limits::default(), &|| false);
    assert!(found().len() > 4);
    bencher.bench_local(found);
}

#[divan::bench]
fn completion_of_a_field(bencher: Bencher) {
    completed(bencher, "sphere { radius: 1m, ma");
}

#[divan::bench]
fn completion_of_a_value(bencher: Bencher) {
    completed(bencher, "sphere { radius: r");
}

#[divan::bench]
fn signature_of_a_part(bencher: Bencher) {
    let (text, desk) = (written() + "stool1 { seat: ", Desk::default());
    let source = Source::new("bench.rt", text.as_str());
    bencher.bench_local(|| signatures(&desk, &source, text.len(), &Limits::default(), &|| false));
}

#[divan::bench]
fn tokens(bencher: Bencher) {
    let text = written();
    let analysis = analysed(&Desk::default(), &text);
    bencher.bench(|| analysis.tokens(0..text.len()));
}

#[divan::bench]
fn hover(bencher: Bencher) {
    let text = written();
    let analysis = analysed(&Desk::default(), &text);
    let at = text.rfind("glaze").expect("it is used") + 2;
    bencher.bench(|| analysis.hover(at));
}

#[divan::bench]
fn the_rest(bencher: Bencher) {
    let text = written();
    let analysis = analysed(&Desk::default(), &text);
    let all = 0..text.len();
    bencher.bench(|| {
        (
            analysis.symbols(),
            analysis.folds(),
            analysis.hints(all.clone()),
            analysis.colours(),
            analysis.lenses(),
        )
    });
}
