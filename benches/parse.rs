//! How fast text becomes a tree: `cargo bench --bench parse`.

use divan::Bencher;
use divan::counter::BytesCount;
use rt_lang::span::SourceId;
use rt_lang::syntax::parse;
use std::fmt::Write;

fn main() {
    divan::main();
}

/// So many things in each text.
const THINGS: usize = 200_000;

/// Numbers that look random and are the same every time: the linear congruence of Knuth's MMIX.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 40
    }

    /// Hundredths from −5 to 5.
    fn metres(&mut self) -> f64 {
        (self.next() % 1001) as f64 / 100.0 - 5.0
    }
}

fn spheres(material: impl Fn(&mut Numbers) -> String) -> String {
    let (mut text, mut numbers) = (String::new(), Numbers(1));
    for _ in 0..THINGS {
        let (x, y, z) = (numbers.metres(), numbers.metres(), numbers.metres());
        let (radius, material) = (1 + numbers.next() % 99, material(&mut numbers));
        writeln!(text, "sphere {{ at: ({x:.2}, {y:.2}, {z:.2})m, radius: {radius}mm{material} }}")
            .expect("a string takes any text");
    }
    text
}

fn read(bencher: Bencher, text: &str) {
    bencher.counter(BytesCount::of_str(text)).bench(|| parse(SourceId(0), text));
}

#[divan::bench(sample_count = 10)]
fn flat_spheres(bencher: Bencher) {
    read(bencher, &spheres(|_| String::new()));
}

#[divan::bench(sample_count = 10)]
fn flat_spheres_with_materials(bencher: Bencher) {
    read(
        bencher,
        &spheres(|numbers| match numbers.next() % 3 {
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
