//! What bad input gets: a clear error with its place and the right exit code, nothing lost, no panic.

use super::Desk;
use std::fs;

#[test]
fn files_that_cannot_be_read() {
    let desk = Desk::new();
    desk.quick("missing.rt").expect(2, &["cannot read `missing.rt`: no such file"]);
    desk.quick(". -o a.png").expect(2, &["`.` is a folder, not a scene"]);
    desk.quick(".").expect(2, &["`.` is a folder, not a scene"]);
    desk.run("check .").expect(2, &["is a folder"]);
    desk.put("latin.rt", b"sphere {}\n// caf\xe9\n");
    for command in ["check latin.rt", "build latin.rt"] {
        desk.run(command).expect(1, &["E0009", "[latin.rt:2:7]", "byte 0xE9"]);
    }
    assert_eq!(desk.feed("check -", "latin.rt").code, Some(1));
    desk.put("binary.rt", [0u8, 159, 146, 150, 255, 254].repeat(1000));
    desk.run("check binary.rt").expect(1, &["E0009"]);
    assert_eq!(desk.names(), ["ball.rt", "binary.rt", "latin.rt"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_source_without_end_is_over_the_limit() {
    let desk = Desk::new();
    desk.run("check /dev/zero").expect(1, &["E0406", "at most 256 MiB"]);
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_rendering() {
    let desk = Desk::new();
    fs::create_dir(desk.path("folder.png")).unwrap();
    // Far more samples than there is time for: none may be traced.
    let refused = |output: &str, said: &[&str]| {
        desk.run(&format!("build ball.rt --samples 1000000 -o {output}")).expect(2, said);
    };
    refused("picture.gif", &["`gif` is no format", "png, exr, jpg"]);
    refused("picture", &["does not say its format"]);
    refused("gif:-", &["no format", "png, exr, jpg"]);
    refused("none/picture.png", &["cannot write", "no folder"]);
    refused("folder.png", &["is a folder"]);
    refused("a.png -o ./a.png", &["given twice"]);
    refused("a.exr --bits 16", &["--bits 16"]);
    refused("a.webp --size 20000x10", &["WebP holds at most 16384"]);
    assert_eq!(desk.names(), ["ball.rt", "folder.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_found_before_rendering() {
    let desk = Desk::new();
    desk.run("build ball.rt --samples 1000000 -o /proc/picture.png").expect(2, &["cannot write"]);
    std::os::unix::fs::symlink("/dev/null", desk.path("null.png")).unwrap();
    desk.run("build ball.rt --samples 1000000 -o null.png").expect(2, &["not a file"]);
}

#[test]
fn a_scene_is_never_replaced_by_its_picture() {
    let desk = Desk::new();
    desk.put("scene.png", super::BALL);
    desk.quick("scene.png").expect(2, &["would be replaced"]);
    desk.quick("scene.png -o ./scene.png").expect(2, &["would be replaced"]);
    assert_eq!(desk.get("scene.png"), super::BALL.as_bytes());
    desk.quick("ball.rt -o a.exr").expect(0, &[]);
    let before = desk.get("a.exr");
    desk.run("develop a.exr -o a.exr").expect(2, &["would be replaced"]);
    assert!(desk.get("a.exr") == before);
}

#[test]
fn what_goes_where_must_be_plain() {
    let desk = Desk::new();
    desk.put("other.rt", super::BALL);
    desk.put("other.txt", super::BALL);
    desk.run("build -").expect(2, &["standard input", "-o picture.png"]);
    desk.quick("ball.rt other.rt -o a.png").expect(2, &["`-o` is for one scene"]);
    desk.quick("ball.rt - other.rt").expect(2, &["standard input"]);
    desk.quick("other.rt other.txt").expect(2, &["two pictures would go to `other.png`"]);
    desk.quick("ball.rt ./ball.rt").expect(2, &["given twice"]);
    assert_eq!(desk.names(), ["ball.rt", "other.rt", "other.txt"]);
}

#[test]
fn values_of_flags_show_the_right_form() {
    let desk = Desk::new();
    for (flags, said) in [
        ("--size 640", "640x480"),
        ("--size 0x480", "from 1 to 65536"),
        ("--size 65537x1", "from 1 to 65536"),
        ("--size 65536x65536", "pixels"),
        ("--samples 0", "from 1 to"),
        ("--samples many", "such as 64"),
        ("--seed -1", "such as 7"),
        ("--samples -1", "such as 64"),
        ("-j -1", "such as 4"),
        ("-j 0", "at least one thread"),
        ("-j 1000000", "at most 1024"),
        ("--crop 0,0,320", "0,0,320,240"),
        ("--crop 0,0,0,240", "no pixels"),
        ("--size 100x100 --crop 50,50,51,50", "which is 100×100"),
        ("--crop 4294967295,0,2,2", "does not lie within"),
        ("--exposure bright", "number of stops"),
        ("--exposure inf", "number of stops"),
        ("--tonemap filmic", "neutral, none, agx"),
        ("--bits 12", "8, 16"),
        ("--time 9", "a time with its unit, such as 90s"),
        ("--time 0s", "a time above 0"),
        ("--time 8761h", "a year at most, which is 8760h"),
        ("--checkpoint-every 1e9h", "a year at most"),
        ("--checkpoint=-", "standard output cannot be read again"),
        ("--checkpoint=never", "`never` is for `--resume`, and a file of that name is `./never`"),
        ("--resume=-", "samples are not read from standard input"),
        ("--noise 5% --samples 20 --min-samples 100", "more samples than `--samples 20` allows"),
        ("--sweep t=0 --frames 2 -o mp4:-", "a video is written to a file"),
        ("--sweep t=0 --frames 0", "a number of frames from 1 to 1000000, such as 48"),
        ("--sweep t=0 --frames 1000001", "from 1 to 1000000"),
        ("--sweep t=0 --frames -1", "from 1 to 1000000"),
        ("--colour", "--colour"),
    ] {
        desk.run(&format!("build ball.rt {flags}")).expect(2, &[said]);
    }
    assert_eq!(desk.names(), ["ball.rt"]);
}

#[test]
fn a_file_that_is_no_exr_is_not_developed() {
    let desk = Desk::new();
    desk.run("develop ball.rt -o a.png").expect(2, &["not an EXR", "rtc build"]);
    desk.run("develop missing.exr -o a.png").expect(2, &["cannot read"]);
    desk.quick("ball.rt -o a.exr").expect(0, &[]);
    let whole = desk.get("a.exr");
    desk.put("torn.exr", &whole[..whole.len() / 2]);
    desk.run("develop torn.exr -o a.png").expect(2, &["not an EXR"]);
    desk.run("develop a.exr").expect(2, &["--output"]);
    assert_eq!(desk.names(), ["a.exr", "ball.rt", "torn.exr"]);
}

#[test]
fn an_empty_file_is_said_to_be_empty_or_drawn() {
    let desk = Desk::new();
    desk.put("empty.rt", "");
    let ended = desk.quick("empty.rt");
    // The compiler decides; either way it is said in words, and nothing breaks.
    assert!(matches!(ended.code, Some(0 | 1)) && !ended.stderr.is_empty(), "{ended:?}");
}

#[test]
fn a_line_of_100_megabytes() {
    let desk = Desk::new();
    desk.put("long.rt", "x".repeat(100_000_000));
    let ended = desk.run("check long.rt");
    ended.expect(1, &["[long.rt:1:1]"]);
    assert!(ended.stderr.len() < 10_000, "{} bytes were said", ended.stderr.len());
    desk.put("long.rt", format!("sphere {{ radius: 1m }} //{}", " 灯".repeat(25_000_000)));
    desk.run("check long.rt").expect(0, &[]);
}

#[test]
fn a_hundred_thousand_brackets() {
    let desk = Desk::new();
    for bracket in ["(", "{", "[", "a{", "f(", "-", "not "] {
        let text = format!("sphere {{ radius: {}", bracket.repeat(100_000));
        desk.put("deep.rt", &text);
        let ended = desk.run("check deep.rt");
        ended.expect(1, &["deep.rt:1:"]);
        assert!(ended.stderr.len() < 50_000, "{bracket}: {} bytes were said", ended.stderr.len());
    }
}

#[test]
fn numbers_that_are_none_or_too_large() {
    let desk = Desk::new();
    for (text, code) in [
        ("sphere { radius: 1m / 0 }", "E0407"),
        ("sphere { radius: sqrt(-1) * 1m }", "E0407"),
        ("sphere { radius: exp(1000) * 1m }", "E0407"),
        ("sphere { radius: 0m }", "E0401"),
        ("sphere { radius: -1m }", "E0401"),
        ("hyperboloid { axes: (0, 1, 1)m }", "E0401"),
        ("sphere { radius: 1m }\nrender { samples: 0 }", "E0401"),
        ("sphere { radius: 1m }\nrender { size: (70000, 10) }", "E0401"),
    ] {
        desk.put("odd.rt", text);
        desk.run("check odd.rt").expect(1, &[code, "[odd.rt:"]);
    }
}

#[test]
fn a_camera_inside_a_wall_is_a_warning() {
    let desk = Desk::new();
    desk.put("inside.rt", "camera { from: (0, 0, 0)m, look: (0, 0, 5)m }\nsphere { radius: 1m }\n");
    desk.quick("inside.rt").expect(0, &["W0601", "[inside.rt:1:"]);
    assert_eq!(desk.quick("inside.rt --quiet").stderr, "");
}

#[test]
fn a_film_never_replaces_what_one_of_its_frames_reads() {
    let desk = Desk::new();
    let ball = "param t: number = 0\ncamera { from: (0, 0, 4)m, look: (0, 0, 0)m }\nsphere { radius: 1m + t * 1m }\n";
    desk.put("plain.rt", ball);
    let film = |scene: &str, rest: &str| {
        let mut command = desk.command(&format!("build {scene} --size 8x6 --samples 2 --frames 3 {rest}"));
        super::ended(command.args(["--sweep", "t = 0 to 1"]).output().unwrap())
    };
    film("plain.rt", "-o f.{}.png --resume").expect(0, &[]);
    film("plain.rt", "-o w.webp --resume").expect(0, &[]);
    // Read by a frame in the middle alone, of what is kept, and as a source.
    let middle = |file: &str| {
        let ground =
            format!("plane {{ at: (0, 0, -3)m, material: diffuse {{ color: image(\"{file}\", 1m) }} }}");
        format!("{ball}if t > 0.3 and t < 0.7 {{ {ground} }}\n")
    };
    desk.put("frame.rt", middle("f.1.png"));
    desk.put("kept.rt", middle("w.webp.frames/000003.exr"));
    desk.put("slashes.rt", middle(".//f.1.png"));
    desk.put("g.2.png.made", "let size = 1m\n");
    desk.put("g.2.png", desk.get("f.2.png"));
    desk.put("record.rt", format!("import \"g.2.png.made\" as record\n{ball}"));
    desk.put("h.3.png.checkpoint", "let size = 1m\n");
    desk.put("checkpoint.rt", format!("import \"h.3.png.checkpoint\" as kept\n{ball}"));
    for (scene, rest, file) in [
        ("frame.rt", "-o f.{}.png", "f.1.png"),
        ("slashes.rt", "-o f.{}.png", "f.1.png"),
        ("kept.rt", "-o w.webp --resume", "w.webp.frames/000003.exr"),
        ("record.rt", "-o g.{}.png --resume", "g.2.png.made"),
        ("checkpoint.rt", "-o h.{}.png --resume", "h.3.png.checkpoint"),
    ] {
        let before = desk.get(file);
        film(scene, rest).expect(2, &[&format!("`{file}` would be replaced")]);
        assert!(desk.get(file) == before, "{file} was replaced");
    }
    // What a comment names is read by none.
    desk.put("comment.rt", format!("/* -o \"f.1.png\" */ // \"f.2.png\"\n{ball}"));
    film("comment.rt", "-o f.{}.png").expect(0, &[]);
    // Nor what it writes beside it meanwhile.
    desk.put(".rtc-n.png.tmp", "let size = 1m\n");
    desk.put("aside.rt", format!("import \".rtc-n.png.tmp\" as aside\n{ball}"));
    desk.run("build aside.rt --size 8x6 --samples 2 -o n.png").expect(2, &["`.rtc-n.png.tmp` has the name"]);
    assert_eq!(desk.get(".rtc-n.png.tmp"), b"let size = 1m\n");
}
