//! Frames that are done: which are skipped, and which are made anew.

use super::{RISING, build, desk};
use crate::command::assert_same;
use std::fs;

#[test]
fn done_frames_are_skipped_and_those_that_changed_made_anew() {
    let desk = desk();
    let film = |rest: &str| build(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 3 {rest}"#));
    film("-o whole.webp --quiet").expect(0, &[]);

    // Two of the frames, then all; and the film of frames that were kept is the one that was made at once.
    film("-o film.webp --resume --only 1-2 --quiet").expect(0, &[]);
    let rest = film("-o film.webp --resume");
    rest.expect(0, &["frame 1 of 3 is done", "frame 2 of 3 is done", "frame 3 of 3: 3 samples"]);
    assert_same(&desk.path("whole.webp"), &desk.path("film.webp"));
    let mut kept: Vec<String> = fs::read_dir(desk.path("film.webp.frames"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    kept.sort();
    let all =
        ["000001.exr", "000001.exr.made", "000002.exr", "000002.exr.made", "000003.exr", "000003.exr.made"];
    assert_eq!(kept, all, "no samples of what is done");

    let pictures = "-o f{}.png -o f{}.exr --resume";
    film(pictures).expect(0, &["f2.png, f2.exr, frame 2 of 3: 3 samples"]);
    let before = [desk.get("f1.png"), desk.get("f2.png")];
    film(pictures).expect(0, &["frame 1 of 3 is done", "frame 3 of 3 is done"]);
    film(&format!("{pictures} --seed 5 --only 2"))
        .expect(0, &["frame 2 of 3: 3 samples", "made anew: `--seed 5` (made: 0)"]);
    assert_ne!(desk.get("f2.png"), before[1]);
    film(pictures).expect(0, &["frame 1 of 3 is done", "`--seed 0` (made: 5)"]);
    assert_eq!(desk.get("f2.png"), before[1]);

    // A record that is damaged is no other frame, and a film needs more than the record of its pictures tells.
    let mut record = desk.get("f2.png.made");
    record[3] ^= 1;
    desk.put("f2.png.made", record);
    film(pictures).expect(0, &["made anew: its record `f2.png.made` is damaged", "frame 3 of 3 is done"]);
    film("-o p{}.png --resume --only 1").expect(0, &["1 of 3 frames in"]);
    film("-o p{}.png -o p.webp --resume --only 1")
        .expect(0, &["made anew: it was made without `p.webp.frames/000001.exr`"]);

    // By what is in the file, not by its being there.
    desk.put("f1.png", "torn");
    fs::remove_file(desk.path("f3.exr")).unwrap();
    let again = film(pictures);
    again.expect(0, &["made anew: `f1.png` was changed", "made anew: `f3.exr` is missing"]);
    assert!(again.stderr.contains("frame 2 of 3 is done"));
    assert_eq!(desk.get("f1.png"), before[0]);

    desk.put("rise.rt", RISING.replace("20cm", "30cm * t + 5cm"));
    film(pictures).expect(0, &["made anew: other surfaces"]);
    let never = film("-o f{}.png -o f{}.exr --resume=never --only 1");
    never.expect(0, &["frame 1 of 3: 3 samples"]);
}

#[test]
fn a_frame_of_other_settings_is_not_taken_for_done() {
    let desk = desk();
    let film = |rest: &str| {
        build(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 2 --only 2 -o f{{}}.exr --resume {rest}"#))
    };
    film("").expect(0, &["frame 2 of 2: 3 samples"]);
    film("").expect(0, &["frame 2 of 2 is done"]);
    for (flags, differs) in [
        ("--exposure 2", "`--exposure 2` (made: "),
        ("--tonemap agx", "`--tonemap agx` (made: neutral)"),
        ("--crop 1,1,9,9", "`--crop 1,1,9,9` (made: 0,0,24,18)"),
        ("--set count=2", "other surfaces"),
        ("--aov depth", "`--aov depth` (made: none)"),
        ("--denoise", "`--denoise` (made: none)"),
        ("--seed 4", "`--seed 4` (made: 0)"),
        ("--noise 10%", "anew: `--noise 10%` (made: none)\n"),
    ] {
        film(flags).expect(0, &[differs]);
        film(flags).expect(0, &["frame 2 of 2 is done"]);
        film("").expect(0, &["made anew"]);
    }
    // Of another film with as many frames.
    build(&desk, r#"--sweep "t = 0 to 0.5" --frames 2 --only 2 -o f{}.exr --resume"#)
        .expect(0, &["made anew"]);
    film("").expect(0, &["made anew: other surfaces"]);
    desk.put("rise.rt", RISING.replace("90W", "91W"));
    film("").expect(0, &["made anew"]);
}

#[test]
fn frames_with_names_in_them_are_made_anew_when_these_change() {
    let desk = desk();
    let named = |name: &str| {
        desk.put("rise.rt", format!("material {name} = diffuse {{ color: red }}\nsphere {name}s {{ radius: 1m, material: {name} }}\n{RISING}"))
    };
    let film = |rest: &str| build(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 1 --resume {rest}"#));
    named("rouge");
    film("-o n{}.exr --aov object,material").expect(0, &["3 samples", "\n1 frame in"]);
    film("-o plain{}.exr").expect(0, &["3 samples"]);
    film("-o n{}.exr --aov object,material").expect(0, &["is done"]);
    named("ruddy");
    film("-o n{}.exr --aov object,material").expect(0, &["made anew: other names"]);
    film("-o plain{}.exr").expect(0, &["is done"]);
}

#[test]
fn a_damaged_checkpoint_of_a_frame_has_it_made_anew() {
    let desk = desk();
    let film = |rest: &str| build(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 3 -o f{{}}.png {rest}"#));
    desk.put("f2.png.checkpoint", "junk");
    film("--resume").expect(
        0,
        &[
            "`f2.png.checkpoint` is not gone on from: it is no checkpoint",
            "frame 2 of 3: 3 samples",
            "frame 3 of 3",
        ],
    );
    assert!(!desk.names().contains(&"f2.png.checkpoint".to_string()));
    film("--resume").expect(0, &["frame 2 of 3 is done"]);
}

#[cfg(unix)]
#[test]
fn a_pipe_in_place_of_a_frame_is_not_waited_for() {
    let desk = desk();
    let film = || build(&desk, r#"--sweep "t = 0 to 1" --frames 1 -o f{}.exr --resume"#);
    film().expect(0, &["3 samples"]);
    fs::remove_file(desk.path("f1.exr")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(desk.path("f1.exr")).status().unwrap().success());
    film().expect(2, &["there is something that is not a file"]);
}
