//! How soon an editor has its answers on a text of 2 000 lines: `cargo bench --bench ide`.

use divan::Bencher;
use rt_lang::eval::Limits;
use rt_lang::files::NoFiles;
use rt_lang::ide::{Analysis, complete, signatures};
use rt_lang::source::Source;
use rt_lang::{Options, analyse};
use scenes::Numbers;
use std::fmt::Write;

mod scenes;

fn main() {
    divan::main();
}

const LINES: usize = 2000;

/// A text as people write them: parts, materials, groups, loops, and things that use them.
fn written() -> String {
    let mut text = String::from(
        "/// How many.\nparam count: int = 7 in 1 to 20\nplane { material: diffuse { color: #705848 } }\n",
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
        writeln!(text, "sphere {{ at: ({x:.2}, {y:.2}, {z:.2})m, radius: 12mm }}").expect("a string takes all");
    }
    text
}

fn analysed(text: &str) -> Analysis {
    let source = Source::new("bench.rt", text);
    let analysis = analyse(&NoFiles, source, &Options::default(), &|| false);
    analysis.expect("nobody stops it")
}

#[divan::bench]
fn diagnostics(bencher: Bencher) {
    let text = written();
    assert!(analysed(&text).diagnostics.is_empty(), "{:?}", analysed(&text).diagnostics.first());
    bencher.bench(|| analysed(&text));
}

#[divan::bench]
fn diagnostics_of_an_error(bencher: Bencher) {
    let text = written().replacen("radius: 3cm", "raduis: 3cm", 1);
    assert!(!analysed(&text).diagnostics.is_empty());
    bencher.bench(|| analysed(&text));
}

#[divan::bench]
fn diagnostics_of_rows(bencher: Bencher) {
    let text = flat();
    bencher.bench(|| analysed(&text));
}

#[divan::bench]
fn completion_of_a_field(bencher: Bencher) {
    let text = format!("{}sphere {{ radius: 1m, ma", written());
    let source = Source::new("bench.rt", text.as_str());
    bencher.bench(|| complete(&NoFiles, &source, text.len(), &Limits::default(), &|| false));
}

#[divan::bench]
fn completion_of_a_value(bencher: Bencher) {
    let text = format!("{}sphere {{ radius: r", written());
    let source = Source::new("bench.rt", text.as_str());
    bencher.bench(|| complete(&NoFiles, &source, text.len(), &Limits::default(), &|| false));
}

#[divan::bench]
fn signature_of_a_part(bencher: Bencher) {
    let text = format!("{}stool1 {{ seat: ", written());
    let source = Source::new("bench.rt", text.as_str());
    bencher.bench(|| signatures(&NoFiles, &source, text.len(), &Limits::default(), &|| false));
}

#[divan::bench]
fn tokens(bencher: Bencher) {
    let text = written();
    let analysis = analysed(&text);
    bencher.bench(|| analysis.tokens(0..text.len()));
}

#[divan::bench]
fn hover(bencher: Bencher) {
    let text = written();
    let analysis = analysed(&text);
    let at = text.rfind("glaze").expect("it is used") + 2;
    bencher.bench(|| analysis.hover(at));
}

#[divan::bench]
fn the_rest(bencher: Bencher) {
    let text = written();
    let analysis = analysed(&text);
    let all = 0..text.len();
    bencher.bench(|| {
        (analysis.symbols(), analysis.folds(), analysis.hints(all.clone()), analysis.colours(), analysis.lenses())
    });
}
