//! How fast text becomes a tree: `cargo bench --bench parse`.

use divan::Bencher;
use divan::counter::BytesCount;
use rt_lang::span::SourceId;
use rt_lang::syntax::parse;
use scenes::spheres;

mod scenes;

fn main() {
    divan::main();
}

/// So many things in each text.
const THINGS: usize = 200_000;

fn read(bencher: Bencher, text: &str) {
    bencher.counter(BytesCount::of_str(text)).bench(|| parse(SourceId(0), text));
}

#[divan::bench(sample_count = 10)]
fn flat_spheres(bencher: Bencher) {
    read(bencher, &spheres(THINGS, |_| String::new()));
}

#[divan::bench(sample_count = 10)]
fn flat_spheres_with_materials(bencher: Bencher) {
    read(
        bencher,
        &spheres(THINGS, |numbers| match numbers.next() % 3 {
            0 => format!(", material: diffuse {{ color: #{:06x} }}", numbers.next() & 0xff_ffff),
            1 => format!(", material: metal {{ color: #c9a227, roughness: {}% }}", numbers.next() % 100),
            _ => ", material: dielectric { ior: 1.5 }".into(),
        }),
    );
}

/// A text written by hand, again and again: little in it is alike.
#[divan::bench(sample_count = 10)]
fn written_by_hand(bencher: Bencher) {
    let text = include_str!("../tests/cases/syntax/third.rt");
    read(bencher, &text.repeat(1000));
}
