//! How fast text becomes a scene, all stages together and each by itself: `cargo bench --bench compile`.

use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};
use rt_lang::check::{Program, check};
use rt_lang::eval::{Limits, Thing, Things, eval};
use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::import::import;
use rt_lang::lint::lint;
use rt_lang::lower::{Decoded, Lowered, Meshes, Overrides, lower, measure};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};
use scenes::Numbers;
use std::fmt::Write;
use std::sync::Arc;

mod scenes;

fn main() {
    divan::main();
}

/// So many things in each scene.
const THINGS: usize = 200_000;

/// The one file there is to read.
struct OneFile(Arc<[u8]>);

impl Files for OneFile {
    fn read(&self, _: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        Ok(self.0.clone())
    }
}

fn compiled(files: &OneFile, text: &str) {
    let mut sources = Sources::default();
    let main = sources.add(Source::new("bench.rt", text));
    let compiled = compile(files, &mut sources, main, &Options::default());
    assert!(compiled.scene.is_some());
}

#[divan::bench(sample_count = 5)]
fn flat_text(bencher: Bencher) {
    let (mut text, mut numbers) = (String::new(), Numbers(1));
    for _ in 0..THINGS {
        let [x, y, z] = [(); 3].map(|()| numbers.metres());
        writeln!(text, "sphere {{ at: ({x:.2}, {y:.2}, {z:.2})m, radius: 12mm }}")
            .expect("a string takes all");
    }
    let files = OneFile([].into());
    bencher.counter(BytesCount::of_str(&text)).bench(|| compiled(&files, &text));
}

#[divan::bench(sample_count = 5)]
fn loops(bencher: Bencher) {
    let text =
        format!("for i in range({THINGS}) {{ sphere {{ at: (i * 1mm, rand(i) * 1m, 0), radius: 0.3mm }} }}");
    let files = OneFile([].into());
    bencher.counter(ItemsCount::new(THINGS)).bench(|| compiled(&files, &text));
}

fn points() -> OneFile {
    let (mut table, mut numbers) = (String::from("x [m],y [m],z [m]\n"), Numbers(1));
    for _ in 0..THINGS {
        let [x, y, z] = [(); 3].map(|()| numbers.metres());
        writeln!(table, "{x:.6},{y:.6},{z:.6}").expect("a string takes all");
    }
    OneFile(table.into_bytes().into())
}

#[divan::bench(sample_count = 5)]
fn table_read(bencher: Bencher) {
    let files = points();
    let text = "let points = table(\"points.csv\")\nsphere { at: (points[0].x, 0, 0), radius: 1mm }";
    bencher.counter(BytesCount::new(files.0.len())).bench(|| compiled(&files, text));
}

#[divan::bench(sample_count = 5)]
fn table_drawn(bencher: Bencher) {
    let files = points();
    let text = "for p in table(\"points.csv\") { sphere { at: (p.x, p.y, p.z), radius: 1mm } }";
    bencher.counter(ItemsCount::new(THINGS)).bench(|| compiled(&files, text));
}

/// A loop in a loop, which makes as many things as its square root says.
fn nested(root: usize) -> String {
    format!(
        "for i in range({root}) {{ for j in range({root}) {{
           sphere {{ at: (i * 1mm, rand(i, j) * 1m, j * 1m), radius: 0.3mm }}
         }} }}"
    )
}

/// What the stages before evaluation give.
struct Checked {
    files: OneFile,
    sources: Sources,
    program: Program,
    decoded: Decoded,
}

impl Checked {
    fn new(text: &str) -> Checked {
        let files = OneFile([].into());
        let mut sources = Sources::default();
        let main = sources.add(Source::new("bench.rt", text));
        let imported = import(&files, &mut sources, main, Limits::default().levels, Limits::default().text);
        let (program, diagnostics) = check(&files, &sources, &imported, &[]);
        assert_eq!(diagnostics, []);
        Checked { files, sources, program, decoded: Decoded::default() }
    }

    fn meshes(&self) -> Meshes<'_> {
        Meshes::new(&self.files, &self.sources, &self.decoded)
    }

    fn things(&self, meshes: &Meshes) -> Things {
        let measure = |things: &Things, thing: &Thing| measure(things, thing, meshes);
        eval(&self.program, Limits::default(), &measure).0
    }

    fn lowered(&self, things: &Things, meshes: &Meshes) -> Lowered {
        lower(things, &Overrides::default(), &self.files, &self.sources, meshes)
    }
}

/// Square roots of how many things there are where a stage is timed by itself.
const ROOTS: [usize; 2] = [316, 1000];

#[divan::bench(sample_count = 5, args = ROOTS)]
fn stage_eval(bencher: Bencher, root: usize) {
    let checked = Checked::new(&nested(root));
    let meshes = checked.meshes();
    bencher.counter(ItemsCount::new(root * root)).bench_local(|| checked.things(&meshes));
}

#[divan::bench(sample_count = 5, args = ROOTS)]
fn stage_lower(bencher: Bencher, root: usize) {
    let checked = Checked::new(&nested(root));
    let meshes = checked.meshes();
    let things = checked.things(&meshes);
    bencher.counter(ItemsCount::new(root * root)).bench_local(|| checked.lowered(&things, &meshes));
}

#[divan::bench(sample_count = 5, args = ROOTS)]
fn stage_lint(bencher: Bencher, root: usize) {
    let checked = Checked::new(&nested(root));
    let meshes = checked.meshes();
    let things = checked.things(&meshes);
    let lowered = checked.lowered(&things, &meshes);
    let scene = lowered.scene.expect("the scene is sound");
    bencher
        .counter(ItemsCount::new(root * root))
        .bench_local(|| lint(&scene, &things.origins, &lowered.marks));
}
