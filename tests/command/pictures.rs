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
