//! What the language means, seen in the scenes it makes.

use proptest::prelude::*;
use rt_lang::diagnostic::Code;
use rt_lang::files::{FileError, FilePath, Files, NoFiles};
use rt_lang::scene::Scene;
use rt_lang::schema::{Category, Field, FieldType, KINDS, Kind, KindId, PLACED, Preset};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile, units};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Files in memory, with a list of what was read.
#[derive(Default)]
struct Memory {
    files: BTreeMap<String, &'static str>,
    read: Mutex<Vec<String>>,
}

impl Files for Memory {
    fn read(&self, path: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        self.read.lock().unwrap().push(path.as_str().into());
        self.files.get(path.as_str()).map(|text| text.as_bytes().into()).ok_or(FileError::Missing)
    }
}

fn scene_of(files: &dyn Files, text: &str, set: &[&str]) -> Scene {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("main.rt", text));
    let set = set.iter().map(|set| set.to_string()).collect();
    let compiled = compile(files, &mut sources, id, &Options { set, ..Options::default() });
    compiled.scene.unwrap_or_else(|| panic!("{text}\n{:#?}", compiled.diagnostics))
}

fn scene(text: &str) -> Scene {
    scene_of(&NoFiles, text, &[])
}

/// Surfaces with their materials, in no order.
fn surfaces(scene: &Scene) -> Vec<String> {
    let each = scene.primitives.iter();
    let mut all: Vec<String> =
        each.map(|primitive| format!("{:?} {:?}", primitive.shape, scene.material(primitive))).collect();
    all.sort();
    all
}

const STATEMENTS: &[&str] = &[
    "camera { from: (0, 1, 9)m, look: left.knob }",
    "let r = 2 * size",
    "param size: length = 3cm",
    "material red_paint = diffuse { color: red * 0.5 }",
    "part post { param h: length = r, cylinder pole { radius: h / 9, height: h }, sphere knob { radius: h / 4, at: (0, bounds(pole).max.y, 0) } }",
    "post left { h: 1m, material: red_paint }",
    "fn place_of(i: int) -> point = (i * size, size, 0)",
    "for i in 0 to 3 { ball { at: place_of(i) } }",
    "let ball = sphere { radius: size }",
    "group both { ball { at: bounds(left).max }, post { at: (1, 0, 0)m } }",
    "sphere { radius: left.knob.radius, at: both.at }",
];

proptest! {
    #[test]
    fn order_never_matters(order in Just((0..STATEMENTS.len()).collect::<Vec<_>>()).prop_shuffle()) {
        let text = |order: &[usize]| order.iter().map(|&i| STATEMENTS[i]).collect::<Vec<_>>().join("\n");
        let written: Vec<usize> = (0..STATEMENTS.len()).collect();
        let (given, shuffled) = (scene(&text(&written)), scene(&text(&order)));
        prop_assert_eq!(surfaces(&given), surfaces(&shuffled));
        prop_assert_eq!(given.camera, shuffled.camera);
    }

    #[test]
    fn off_is_as_good_as_deleted(index in 0..5_usize) {
        let lines = [
            "sphere { radius: 1cm }",
            "for i in range(5) { sphere { radius: 1cm, at: (i, 1, 0)m } }",
            "group { sphere { radius: 2cm } }",
            "if true { sphere { radius: 3cm } }",
            "lens { aperture: 8cm, focus: 3m }",
        ];
        let marked = |mark: &str| {
            let line = |(i, line): (usize, &&str)| if i == index { format!("{mark}{line}") } else { line.to_string() };
            let mut all = lines.iter().enumerate().map(line).collect::<Vec<_>>();
            let lens = all.pop().unwrap();
            scene(&format!("{}\ncamera {{\n{lens}\n}}", all.join("\n")))
        };
        let (off, deleted) = (marked("@off "), marked("// "));
        prop_assert_eq!(surfaces(&off), surfaces(&deleted));
        prop_assert_eq!(off.camera, deleted.camera);
    }
}

/// A file of things that differ in their literals, sound or not. In each are four blanks before the closing brace.
fn things_alike() -> impl Strategy<Value = String> {
    let shape = prop::sample::select(vec![
        "sphere { at: (N, N, N)m, radius: Nmm     }",
        "sphere { at: (Nm, N, -Nm), radius: Nm, material: diffuse { color: #N1a     } }",
        "sphere { radius: Nm, material: glass { roughness: N%     } }",
        "ball { at: (N, N, N)cm     }",
        "hyperboloid { axes: (N, N, N)m, sheets: N     }",
        "sphere { radios: Nm     }",
        "knob { size: Nm     }",
        "light { at: (N, N, N)m, power: NW     }",
        "box { size: (N, 1, N)m, place: turn(y: Ndeg)     }",
    ]);
    let number = prop::sample::select(vec!["0", "1", "2", "12", "0.5", "0.0", "55", "100", "1000.25"]);
    let item = (shape, prop::collection::vec(number, 4)).prop_map(|(shape, numbers)| {
        let pieces = shape.split('N').enumerate();
        pieces
            .map(|(i, piece)| if i > 0 { format!("{}{piece}", numbers[i % 4]) } else { piece.into() })
            .collect()
    });
    prop::collection::vec(item, 1..40).prop_map(|items: Vec<String>| {
        let declared = "material glass = dielectric {}\nlet ball = sphere { radius: 1m }\n\
            part knob { param size: length = 1m in 1cm to 50m, sphere { radius: size } }\n";
        format!("{declared}{}", items.join("\n"))
    })
}

proptest! {
    /// A comment in a thing keeps its tree from being taken for one of a row.
    #[test]
    fn rows_are_what_they_stand_for(text in things_alike()) {
        let compiled = |text: &str| {
            let mut sources = Sources::default();
            let id = sources.add(Source::new("main.rt", text));
            let compiled = compile(&NoFiles, &mut sources, id, &Options::default());
            let primitives = compiled.scene.iter().flat_map(|scene| scene.primitives.iter());
            let origins: Vec<_> = primitives.map(|each| compiled.origins.chain(each.origin)).collect();
            (format!("{:?}", compiled.diagnostics), compiled.scene, origins)
        };
        let (rows, apart) = (compiled(&text), compiled(&text.replace("     }", "/**/ }")));
        prop_assert_eq!(rows.0.replace("     }", "/**/ }"), apart.0);
        prop_assert_eq!(rows.1, apart.1);
        prop_assert_eq!(rows.2, apart.2);
    }
}

#[test]
fn things_come_in_the_order_written() {
    let scene = scene("sphere { radius: r }\nlet r = 2 * q\nsphere { radius: q }\nlet q = 1m");
    let radius = |i: usize| scene.primitives[i].shape.bounds().unwrap().max.x;
    assert_eq!([radius(0), radius(1)], [2.0, 1.0]);
}

#[test]
fn what_is_alone_leaves_others_out() {
    let part = "part p { @solo sphere { radius: 1cm }, sphere { radius: 2cm } }\n";
    let scene = scene(&format!("{part}p {{}}\np {{ at: (1, 0, 0)m }}\nplane {{}}\nlight {{ power: 1W }}"));
    assert_eq!(scene.primitives.len(), 2);
    assert_eq!(scene.lights.len(), 1, "a soft sky in place of the lamp");
}

#[test]
fn settings_reach_params_and_may_use_names() {
    let text = "param n: int = 2 in 1 to 9\nparam r: length = 1cm\nlet wide = 3cm\nfor i in range(n) { sphere { radius: r, at: (i, 0, 0)m } }\nsphere { radius: wide }";
    let scene = scene_of(&NoFiles, text, &["n = 4", "r=2*wide"]);
    assert_eq!(scene.primitives.len(), 5);
    assert!((scene.primitives[0].shape.bounds().unwrap().max.x - 0.06).abs() < 1e-12);
}

#[test]
fn a_file_is_read_once_and_its_blocks_are_ignored() {
    let mut files = Memory::default();
    files.files.insert("lib/ball.rt".into(), "import \"paint.rt\" as paint\nparam r: length = 1cm\nsphere { radius: r, material: paint.blue_one }\ncamera { from: (0, 0, 1)m }\nrender { samples: 3 }");
    files.files.insert("lib/paint.rt".into(), "material blue_one = diffuse { color: blue }");
    let text = "import \"lib/ball.rt\" as ball\nimport \"lib/paint.rt\" as paint\nball {}\nball { r: 2cm, at: (1, 0, 0)m }\nsphere { radius: 1cm, material: paint.blue_one }";
    let scene = scene_of(&files, text, &[]);
    assert_eq!(scene.primitives.len(), 3);
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(*files.read.lock().unwrap(), ["lib/ball.rt", "lib/paint.rt"]);
}

#[test]
fn tables_give_rows() {
    let mut files = Memory::default();
    files.files.insert("points.csv".into(), "x [mm],y [mm],size [mm],kind\n1,2,3,a\n4,5,6,b\n");
    let text = "for row in table(\"points.csv\") { sphere { at: (row.x, row.y, 0), radius: if row.kind == \"a\" then row.size else 2 * row.size } }";
    let scene = scene_of(&files, text, &[]);
    let bounds = scene.primitives[1].shape.bounds().unwrap();
    assert!((bounds.max.x - 0.016).abs() < 1e-12, "{bounds:?}");
}

/// A value that a field of this type may have, as far as one can be told from the type.
fn fitting(field: &Field) -> String {
    fn of(ty: FieldType) -> String {
        let tuple = |count: usize, dim: units::Dim| {
            format!("({}){}", ["0", "1", "0"][..count.min(3)].join(", "), dim.example_unit())
        };
        match ty {
            FieldType::Scalar(dim) => format!("1{}", dim.example_unit()),
            FieldType::Int => "1".into(),
            FieldType::Bool => "true".into(),
            FieldType::Color | FieldType::Paint => "red".into(),
            FieldType::Text => "\"x.ply\"".into(),
            FieldType::Tuple(count, dim) => tuple(count, dim),
            FieldType::IntTuple(_) => "(16, 9)".into(),
            FieldType::Transform => "turn(y: 45deg)".into(),
            FieldType::Made(Category::Material) => "mirror {}".into(),
            FieldType::Made(_) | FieldType::Target => "ball".into(),
            FieldType::Part(kind) => format!("{kind} {{ focal: 50mm }}"),
            FieldType::Named(_) => "eye".into(),
            FieldType::Choice(words) => words[0].name.into(),
            FieldType::OneOf(types) => of(types[0]),
        }
    }
    match field.default {
        Preset::Value(value) => value.into(),
        Preset::Required | Preset::Absent(_) => of(field.ty),
    }
}

/// Whatever holds entries, with every field that any kind knows: it is said to be unknown where the kind has none of the
/// name, and nowhere else.
#[test]
fn every_field_in_every_body() {
    let all = KINDS.iter().flat_map(|kind| kind.fields).chain(PLACED);
    let fields: BTreeMap<&str, &Field> = all.map(|field| (field.name, field)).collect();
    let kinds = (0..KINDS.len()).map(|index| KindId(index as u8));
    // Each with `…` for the field, and the fields that it has.
    let mut bodies: Vec<(String, Vec<&Field>)> = vec![];
    for id in kinds {
        let Kind { name, category, .. } = id.get();
        let mut written = vec![format!("let a = {name} {{ … }}\nlet b = a.‹›")];
        match category {
            Category::Material => written.push(format!("sphere {{ radius: 1m, material: {name} {{ … }} }}")),
            _ => {
                written.push(format!("{name} a {{ … }}\nlet b = a.‹›"));
                written.push(format!("let a = {name} {{}}\ngroup {{ a {{ … }} }}"));
            }
        }
        bodies.extend(written.into_iter().map(|text| (text, id.fields().collect())));
    }
    for text in
        ["part a { … }\na {}", "part a {}\na b { … }\nlet c = b.‹›", "part a { part b { … } b {} }\na {}"]
    {
        bodies.push((text.into(), PLACED.iter().collect()));
    }
    for text in ["for i in [1] { … }", "if true { … }", "if false {} else { … }", "part a { if true { … } }"]
    {
        bodies.push((text.into(), vec![]));
    }
    let mut wrong = vec![];
    for (body, own) in &bodies {
        for (name, some) in &fields {
            let own = own.iter().find(|field| field.name == *name);
            let field = format!("{name}: {}", fitting(own.unwrap_or(some)));
            // Also twice, which is another slip.
            for field in
                [field.clone(), format!("{field}, {field}")].iter().take(1 + usize::from(own.is_some()))
            {
                let text = body.replace('…', field).replace('‹', name).replace('›', "");
                let text = format!("sphere ball {{ radius: 1m }}\ncamera eye {{}}\n{text}\n");
                let mut sources = Sources::default();
                let id = sources.add(Source::new("main.rt", text.clone()));
                let compiled = compile(&NoFiles, &mut sources, id, &Options::default());
                let is_unknown = compiled.diagnostics.iter().any(|said| said.code == Code::E0301);
                if is_unknown == own.is_some() {
                    wrong.push(text);
                }
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{}:\n{}",
        wrong.len(),
        wrong.iter().take(20).cloned().collect::<Vec<_>>().join("\n")
    );
}
