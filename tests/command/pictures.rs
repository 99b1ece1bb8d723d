//! What pictures are written, where, and that they are the same whichever way they come about.

use super::{BALL, Desk, assert_same, read_png};
use std::fs;

#[test]
fn the_picture_goes_beside_its_scene() {
    let desk = Desk::new();
    fs::create_dir(desk.path("sub")).unwrap();
    desk.put("sub/other.rt", BALL);
    desk.quick("ball.rt sub/other.rt").expect(0, &["ball.png: 16×12, 1 sample", "other.png", "exposure"]);
    assert_eq!(desk.names(), ["ball.png", "ball.rt", "sub"]);
    assert_eq!(read_png(&desk.get("sub/other.png")).0, [16, 12]);
}

#[test]
fn one_failing_scene_does_not_stop_the_others() {
    let desk = Desk::new();
    desk.put("bad.rt", "sphere { radius: 8deg }\n");
    desk.quick("bad.rt ball.rt").expect(1, &["E0203"]);
    desk.quick("missing.rt bad.rt ball.rt").expect(2, &["missing.rt", "E0203"]);
    assert_eq!(desk.names(), ["bad.rt", "ball.png", "ball.rt"]);
}

#[test]
fn a_transparent_background_goes_where_it_can_be_held() {
    let desk = Desk::new();
    desk.put("open.rt", format!("{BALL}\nrender {{ background: transparent }}\n"));
    desk.quick("open.rt -o a.png -o a.exr -o a.webp").expect(0, &["a.png, a.exr, a.webp"]);
    assert_eq!(desk.get("a.png")[25], 6, "red, green, blue and alpha");
    desk.run("develop a.exr -o b.png").expect(0, &[]);
    assert_eq!(desk.get("a.png"), desk.get("b.png"));
    for format in ["jpg", "hdr", "pfm"] {
        desk.quick(&format!("open.rt -o c.png -o c.{format}")).expect(2, &["cannot be transparent", "help"]);
    }
    assert!(!desk.names().contains(&"c.png".to_string()), "it is refused before anything is made");
}

#[test]
fn several_outputs_hold_one_picture() {
    let desk = Desk::new();
    let all = ["a.exr", "a.hdr", "a.jpeg", "a.jpg", "a.pfm", "a.png", "a.webp"];
    let outputs: String = all.iter().map(|name| format!(" -o {name}")).collect();
    desk.quick(&format!("ball.rt{outputs}")).expect(0, &["a.exr, a.hdr"]);
    assert_eq!(desk.names()[..7], all);
    let starts: [(&str, &[u8]); 6] = [
        ("a.exr", b"\x76\x2f\x31\x01"),
        ("a.hdr", b"#?RADIANCE"),
        ("a.jpg", b"\xff\xd8\xff"),
        ("a.pfm", b"PF\n16 12\n"),
        ("a.png", b"\x89PNG"),
        ("a.webp", b"RIFF"),
    ];
    for (name, start) in starts {
        assert!(desk.get(name).starts_with(start), "{name}");
    }
}

#[test]
fn developing_gives_the_bytes_of_the_direct_build() {
    let desk = Desk::new();
    desk.quick("ball.rt -o a.exr -o a.png --tonemap agx").expect(0, &[]);
    desk.run("develop a.exr -o b.png").expect(0, &[]);
    assert_same(&desk.path("a.png"), &desk.path("b.png"));
    desk.quick("ball.rt -o c.png --exposure -2.5 --tonemap none --bits 16").expect(0, &["exposure -2.5"]);
    desk.run("develop a.exr -o d.png --exposure -2.5 --tonemap none --bits 16").expect(0, &[]);
    assert_same(&desk.path("c.png"), &desk.path("d.png"));
    let piped = desk.feed("develop - -o -", "a.exr");
    assert!(piped.code == Some(0) && piped.stdout == desk.get("a.png"));
}

#[test]
fn the_chosen_exposure_can_be_pinned() {
    let desk = Desk::new();
    let ended = desk.quick("ball.rt -o a.png");
    let (_, after) = ended.stderr.split_once("`exposure: ").unwrap();
    let (stops, _) = after.split_once('`').unwrap();
    desk.quick(&format!("ball.rt -o b.png --exposure {stops}")).expect(0, &[]);
    assert_same(&desk.path("a.png"), &desk.path("b.png"));
}

#[test]
fn threads_and_runs_do_not_change_the_bytes() {
    let desk = Desk::new();
    for (threads, name) in [(1, "a"), (2, "b"), (7, "c")] {
        let outputs = format!("-o {name}.exr -o {name}.png");
        desk.run(&format!("build ball.rt --size 64x48 --samples 4 -j {threads} {outputs}")).expect(0, &[]);
    }
    for other in ["b", "c"] {
        assert_same(&desk.path("a.exr"), &desk.path(&format!("{other}.exr")));
        assert_same(&desk.path("a.png"), &desk.path(&format!("{other}.png")));
    }
}

#[test]
fn a_crop_is_that_window_of_the_whole() {
    let desk = Desk::new();
    desk.run("build ball.rt --size 64x48 --samples 4 -o whole.png").expect(0, &[]);
    desk.run("build ball.rt --size 64x48 --samples 4 -o part.png --crop 13,7,30,20").expect(0, &["30×20"]);
    let (_, whole) = read_png(&desk.get("whole.png"));
    let (size, part) = read_png(&desk.get("part.png"));
    assert_eq!(size, [30, 20]);
    for (y, row) in part.chunks(30 * 3).enumerate() {
        let start = ((y + 7) * 64 + 13) * 3;
        assert!(row == &whole[start..start + 30 * 3], "row {y}");
    }
}

#[test]
fn standard_input_and_output_carry_only_what_was_asked_for() {
    let desk = Desk::new();
    desk.quick("ball.rt -o a.png -o a.exr").expect(0, &[]);
    let png = desk.feed("build --size 16x12 --samples 1 - -o -", "ball.rt");
    assert!(png.code == Some(0) && png.stdout == desk.get("a.png"));
    let exr = desk.feed("build --size 16x12 --samples 1 - -o exr:-", "ball.rt");
    assert!(exr.code == Some(0) && exr.stdout == desk.get("a.exr"));
    assert_eq!(desk.quick("ball.rt --quiet").stderr, "");
}

#[cfg(unix)]
#[test]
fn permissions_are_the_usual_ones_and_links_stay() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new();
    let mode = |name| fs::metadata(desk.path(name)).unwrap().permissions().mode() & 0o777;
    desk.put("plain.txt", "");
    desk.quick("ball.rt -o a.png").expect(0, &[]);
    assert_eq!(mode("a.png"), mode("plain.txt"));
    fs::set_permissions(desk.path("a.png"), fs::Permissions::from_mode(0o600)).unwrap();
    std::os::unix::fs::symlink("a.png", desk.path("link.png")).unwrap();
    desk.quick("ball.rt -o link.png --seed 2").expect(0, &[]);
    assert_eq!(mode("a.png"), 0o600);
    assert!(fs::symlink_metadata(desk.path("link.png")).unwrap().is_symlink());
    assert_same(&desk.path("a.png"), &desk.path("link.png"));
}

#[test]
fn a_noise_target_is_met_or_the_warning_says_it_is_not() {
    let desk = Desk::new();
    let scene = |noise: &str| {
        let light = "light { at: (2, 3, 2)m, radius: 1m, power: 60W }";
        format!("sphere {{ radius: 1m }}\n{light}\nrender {{ size: (3, 2), noise: {noise} }}\n")
    };
    desk.put("calm.rt", scene("5%"));
    let met = desk.run("build calm.rt");
    met.expect(0, &["calm.png: 3×2", "noise"]);
    assert!(!met.stderr.contains("W0701"), "{}", met.stderr);
    desk.put("strict.rt", scene("0.00001%"));
    desk.run("build strict.rt").expect(0, &["W0701 ⚠", "[strict.rt:3:31]", "65536 samples", "strict.png"]);
    desk.run("build strict.rt --samples 4 --quiet").expect(0, &[]);
}

#[test]
fn two_halves_side_by_side_are_the_picture_of_figure_10() {
    let desk = Desk::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/report/figure-10-parallel.rt");
    desk.put("parallel.rt", fs::read(scene).unwrap());
    let build = |rest: &str| {
        desk.run(&format!("build parallel.rt --size 32x24 --samples 2 {rest}")).expect(0, &[]);
    };
    build("-o whole.png");
    build("--crop 0,0,16,24 -o left.png");
    build("--crop 16,0,16,24 -o right.png");
    let whole = read_png(&desk.get("whole.png")).1;
    let [left, right] = ["left.png", "right.png"].map(|half| read_png(&desk.get(half)).1);
    let rows = left.chunks(16 * 3).zip(right.chunks(16 * 3));
    let together: Vec<u8> = rows.flat_map(|(left, right)| [left, right].concat()).collect();
    assert!(together == whole);
}
