//! Small pictures, exact to the bit: `cases/pictures/*.rt`, and the examples at a stamp's size.
//!
//! They are compared decoded. Where one differs, `target/pictures` gets what was expected, what came, and the
//! difference, 16 times enlarged. `INSTA_UPDATE=always` accepts what came; look at it before.

use crate::folder::Folder;
use insta::internals::SnapshotContents;
use insta::{Comparator, Snapshot};
use rt_lang::lower::Overrides;
use rt_lang::output::{Depth, Facts, Format, Picture, encode};
use rt_lang::render::{Control, Shown, Tracer, Window};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};
use std::path::{Path, PathBuf};

#[test]
fn pictures_are_the_same_to_the_bit() {
    insta::glob!("cases/pictures/*.rt", |path| check(path, "cases/pictures", &Overrides::default()));
}

#[test]
fn examples_are_the_same_to_the_bit() {
    let stamp = Overrides { size: Some([96, 72]), samples: Some(8), ..Overrides::default() };
    insta::glob!("../examples", "**/*.rt", |path| check(path, "cases/examples", &stamp));
}

fn check(path: &Path, folder: &str, overrides: &Overrides) {
    let name = path.file_stem().unwrap().to_str().unwrap().to_string();
    let picture = render(path, overrides);
    let mut settings = insta::Settings::new();
    settings.set_snapshot_path(folder);
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_comparator(Box::new(Decoded { name: name.clone() }));
    settings.bind(|| insta::assert_binary_snapshot!(format!("{name}.png").as_str(), picture));
}

/// The picture of a scene as PNG.
fn render(path: &Path, overrides: &Overrides) -> Vec<u8> {
    let mut sources = Sources::default();
    let text = std::fs::read_to_string(path).unwrap();
    let id = sources.add(Source::new(path.display().to_string(), text));
    let options = Options { overrides: overrides.clone(), ..Options::default() };
    let compiled = compile(&Folder::of(path), &mut sources, id, &options);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{}: {:#?}", path.display(), compiled.diagnostics));
    let tracer = Tracer::new(&scene);
    let prepass = tracer.prepass();
    let stops = scene.develop.exposure.unwrap_or(prepass.exposure_stops);
    let tonemap = scene.develop.tonemap;
    let window = Window::whole(scene.trace.size);
    let shown = Shown { stops, tonemap };
    let rendered = tracer.render(window, scene.trace.target, &prepass, shown, &Control::new()).unwrap();
    let size = scene.trace.size;
    let picture = Picture::gather(size, [0, 0], size, |x, y| rendered.film.mean(x, y));
    let facts = Facts { stops: Some(stops), tonemap: Some(tonemap), ..Facts::unknown() };
    encode(&picture, &facts, Format::Png, Depth::Eight).unwrap()
}

/// Compares pictures by their pixels.
struct Decoded {
    name: String,
}

impl Comparator for Decoded {
    fn matches(&self, reference: &Snapshot, test: &Snapshot) -> bool {
        let (Some(expected), Some(actual)) = (bytes(reference), bytes(test)) else { return false };
        let same = decode(&expected) == decode(&actual);
        if !same {
            self.lay_side_by_side(&expected, &actual);
        }
        same
    }

    fn dyn_clone(&self) -> Box<dyn Comparator> {
        Box::new(Decoded { name: self.name.clone() })
    }
}

impl Decoded {
    #[expect(clippy::print_stdout, reason = "shown beside the failure of the test")]
    fn lay_side_by_side(&self, expected: &[u8], actual: &[u8]) {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("../pictures");
        std::fs::create_dir_all(&folder).unwrap();
        let put = |what: &str, bytes: &[u8]| {
            std::fs::write(folder.join(format!("{}.{what}.png", self.name)), bytes).unwrap();
        };
        put("expected", expected);
        put("actual", actual);
        let ((size, a), (other, b)) = (decode(expected), decode(actual));
        if size == other {
            let difference: Vec<u8> =
                a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b).saturating_mul(16)).collect();
            put("difference", &encode_png(size, &difference));
            let worst = a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
            let count = a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count();
            println!(
                "{}: {count} pixels differ, by at most {worst} of 255; see {}",
                self.name,
                folder.display()
            );
        } else {
            println!("{}: {size:?} pixels were expected, {other:?} came", self.name);
        }
    }
}

fn bytes(snapshot: &Snapshot) -> Option<Vec<u8>> {
    match snapshot.contents() {
        SnapshotContents::Binary(Some(bytes)) => Some(bytes.to_vec()),
        _ => None,
    }
}

/// A PNG of 8-bit red, green and blue.
fn encode_png((width, height): (u32, u32), pixels: &[u8]) -> Vec<u8> {
    let mut file = vec![];
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(pixels).unwrap();
    file
}

/// Width, height, and 8-bit red, green and blue of a PNG.
fn decode(bytes: &[u8]) -> ((u32, u32), Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    pixels.truncate(info.buffer_size());
    ((info.width, info.height), pixels)
}
