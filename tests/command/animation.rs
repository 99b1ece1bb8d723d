//! Films: their frames, in files of their own and in one, which are made, and what happens half way.

mod done;

use super::{Desk, Ended, assert_same, ended, read_png};
use image::AnimationDecoder;
use std::fs;
use std::io::{BufRead, BufReader, Cursor};
use std::process::Stdio;
use std::time::Duration;

/// A ball that rises, and one more.
const RISING: &str = "
param t: number = 0
param count: int = 1
sphere { radius: 1m, at: (0, t * 1m, 0), material: diffuse { color: mix(red, blue, clamp(t, 0, 1)) } }
for i in range(count) { sphere { radius: 20cm, at: (2m, i * 50cm, 0) } }
plane { at: (0, -1, 0)m }
light { at: (2, 4, 3)m, radius: 30cm, power: 90W }
camera { from: (0, 2, 8)m, look: (0, 0.5, 0)m }
";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.put("rise.rt", RISING);
    desk
}

/// Small enough to be over soon.
fn build(desk: &Desk, rest: &str) -> Ended {
    ended(command(desk, rest).output().unwrap())
}

fn command(desk: &Desk, rest: &str) -> std::process::Command {
    let mut command = desk.command("build rise.rt --size 24x18 --samples 3");
    let mut words = rest.split('"');
    // What stands in quotes is one argument.
    while let Some(plain) = words.next() {
        command.args(plain.split_whitespace());
        command.args(words.next());
    }
    command
}

/// The words that a film's report tells the chosen exposure with.
fn exposure(said: &str) -> String {
    let (_, after) = said.split_once("`exposure: ").unwrap();
    after.split_once('`').unwrap().0.to_string()
}

#[test]
fn frames_are_the_pictures_of_their_values() {
    let desk = desk();
    let film = build(&desk, r#"--sweep "t = 0 to 1" --frames 3 -o f.{04}.exr -o f{}.png"#);
    film.expect(0, &["f.0002.exr, f2.png, frame 2 of 3: 3 samples", "3 frames in", "chosen by frame 1"]);
    let stops = exposure(&film.stderr);
    for (number, t) in [(1, "0"), (2, "0.5"), (3, "mix(0, 1, 2/2)")] {
        let set = format!(r#"--set "t={t}" --exposure {stops} -o s.exr -o s.png --quiet"#);
        build(&desk, &set).expect(0, &[]);
        assert_same(&desk.path("s.exr"), &desk.path(&format!("f.000{number}.exr")));
        assert_same(&desk.path("s.png"), &desk.path(&format!("f{number}.png")));
    }
    // The first frame alone chooses the same exposure, and so do those who make others.
    let alone = build(&desk, "-o alone.png");
    assert_eq!(exposure(&alone.stderr), stops);
    assert_same(&desk.path("alone.png"), &desk.path("f1.png"));
    let last = build(&desk, r#"--sweep "t = 0 to 1" --frames 3 --only 3 -o last.{}.png -j 1"#);
    last.expect(0, &["1 of 3 frames in"]);
    assert_eq!(exposure(&last.stderr), stops);
    assert_same(&desk.path("last.3.png"), &desk.path("f3.png"));
}

#[test]
fn a_loop_ends_before_its_end_and_several_values_change_together() {
    let desk = desk();
    let sweeps = r#"--sweep "t = 0 until 1" --sweep "count = 1 to 4" --frames 4 --exposure 0 --quiet"#;
    build(&desk, &format!("{sweeps} -o f{{}}.png")).expect(0, &[]);
    for (number, t, count) in [(1, "0", 1), (2, "0.25", 2), (3, "0.5", 3), (4, "0.75", 4)] {
        let set = format!("--set t={t} --set count={count} --exposure 0 -o s.png --quiet");
        build(&desk, &set).expect(0, &[]);
        assert_same(&desk.path("s.png"), &desk.path(&format!("f{number}.png")));
    }
}

#[test]
fn a_number_that_the_camera_gives_is_that_of_each_frame() {
    let desk = desk();
    desk.put("rise.rt", RISING.replace("camera {", "camera { exposure: 2 * t,"));
    build(&desk, r#"--sweep "t = 0 to 1" --frames 2 -o f{}.png --quiet"#).expect(0, &[]);
    build(&desk, "--set t=1 -o s.png --quiet").expect(0, &[]);
    assert_same(&desk.path("s.png"), &desk.path("f2.png"));
    // Nothing is traced again where only the exposure changes, and the picture is the same.
    desk.put("rise.rt", RISING.replace("t * 1m", "0m").replace("clamp(t, 0, 1)", "0"));
    desk.put(
        "rise.rt",
        String::from_utf8(desk.get("rise.rt")).unwrap().replace("camera {", "camera { exposure: t,"),
    );
    build(&desk, r#"--sweep "t = 0 to 1" --frames 2 -o f{}.png --quiet"#).expect(0, &[]);
    build(&desk, "--set t=1 -o s.png --quiet").expect(0, &[]);
    assert_same(&desk.path("s.png"), &desk.path("f2.png"));
}

#[test]
fn films_hold_the_very_frames() {
    let desk = desk();
    let films = "-o f{}.png -o film.apng -o also.png -o film.webp --fps 25";
    build(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 3 {films}"#)).expect(
        0,
        &["film.apng: animated PNG of 3 frames, 24×18, 0.12 s", "film.webp: animated WebP of 3 frames"],
    );
    let frames: Vec<Vec<u8>> =
        (1..=3).map(|number| read_png(&desk.get(&format!("f{number}.png"))).1).collect();
    assert_ne!(frames[0], frames[2]);
    assert_same(&desk.path("film.apng"), &desk.path("also.png"));

    let mut reader = png::Decoder::new(Cursor::new(desk.get("film.apng"))).read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
    for frame in &frames {
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        assert!(bytes == *frame);
        let control = reader.info().frame_control().unwrap();
        assert_eq!((control.delay_num, control.delay_den), (1, 25));
    }

    let decoder = image::codecs::webp::WebPDecoder::new(Cursor::new(desk.get("film.webp"))).unwrap();
    let shown = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(shown.len(), 3);
    for (shown, frame) in shown.iter().zip(&frames) {
        assert_eq!(shown.delay().numer_denom_ms(), (40, 1));
        let pixels: Vec<u8> =
            shown.buffer().pixels().flat_map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]).collect();
        assert!(pixels == *frame);
    }

    // Beside its scene, and on standard output.
    build(&desk, r#"--sweep "t = 0 to 1" --frames 3 --fps 25 --quiet"#).expect(0, &[]);
    assert_same(&desk.path("film.apng"), &desk.path("rise.apng"));
    let piped = build(&desk, r#"--sweep "t = 0 to 1" --frames 3 --fps 25 --quiet -o webp:-"#);
    assert!(piped.code == Some(0) && piped.stdout == desk.get("film.webp"));
}

#[test]
fn only_some_frames_are_made() {
    let desk = desk();
    let only = |only: &str, variables: &[(&str, &str)]| {
        let rest = format!(r#"--sweep "t = 0 to 1" --frames 5 -o o{{02}}.png --quiet --only {only}"#);
        let mut command = command(&desk, &rest);
        command.env_remove("SLURM_ARRAY_TASK_ID").env_remove("JOB_COMPLETION_INDEX");
        ended(command.envs(variables.iter().copied()).output().unwrap())
    };
    let made = || {
        let mut names = desk.names();
        names.retain(|name| name.starts_with('o'));
        names.iter().for_each(|name| fs::remove_file(desk.path(name)).unwrap());
        names.join(" ")
    };
    only("2,4-", &[]).expect(0, &[]);
    assert_eq!(made(), "o02.png o04.png o05.png");
    only("auto", &[("SLURM_ARRAY_TASK_ID", "3")]).expect(0, &[]);
    assert_eq!(made(), "o03.png");
    only("auto/2", &[("JOB_COMPLETION_INDEX", "1")]).expect(0, &[]);
    assert_eq!(made(), "o03.png o04.png o05.png");
    only("6", &[]).expect(2, &["there is no frame 6: the film has 5"]);
    only("auto", &[]).expect(2, &["no scheduler says which frame this is", "SLURM_ARRAY_TASK_ID"]);
    only("3-2", &[]).expect(2, &["ends before it begins"]);
    only("0", &[]).expect(2, &["counted from 1"]);
    assert_eq!(made(), "");
}

#[test]
fn what_cannot_be_is_refused_before_any_work() {
    let desk = desk();
    let refused = |rest: &str, said: &[&str]| {
        build(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 5 {rest}"#)).expect(2, said);
        assert_eq!(desk.names(), ["ball.rt", "rise.rt"], "{rest}");
    };
    refused("-o out.exr", &["all frames would go to the one picture `out.exr`", "-o out.{04}.exr"]);
    refused("-o {04}.{04}.png", &["two places"]);
    refused("-o %04d.png", &["`{04}`"]);
    refused("-o {04}.png -o {04}.png", &["`0001.png` is given twice"]);
    refused("-o out.gif", &["no format of films"]);
    refused(
        "-o {}.png --shard 1/2",
        &["`--shard` is for one picture, and `--sweep` with `--frames`", "--only"],
    );
    refused("-o {}.png --feedback", &["`--feedback`"]);
    refused("-o {}.png --checkpoint=kept", &["`kept` cannot keep all frames"]);
    refused("-o {}.png --aov depth", &["`--aov` is for EXR files"]);
    refused("-o film.webp --bits 16", &["`--bits 16` is for PNG files"]);
    refused("-o webp:- --resume", &["no name to keep its frames beside"]);
    refused("-o film.webp ball.rt", &["a film is of one scene"]);
    refused("-o film.webp --fps 0", &["frames a second"]);
    refused("-o {}.png --fps 25", &["`--fps` is for a film in one file", "-o film.webp"]);
    refused("-o {}.png --resume kept", &["`--resume=kept`"]);
    refused("-o no/film.webp", &["there is no folder `no`"]);
    refused("-o no/{}.png", &["there is no folder `no`"]);
    for folder in ["g1", "g2"] {
        fs::create_dir(desk.path(folder)).unwrap();
    }
    let folders = build(&desk, r#"--sweep "t = 0 to 1" --frames 3 -o g{}/a.png"#);
    folders.expect(2, &["cannot write `g3/a.png`: there is no folder `g3`"]);
    for folder in ["g1", "g2"] {
        // Empty, for no frame was made.
        fs::remove_dir(desk.path(folder)).unwrap();
    }
    build(&desk, "-o out.{04}.png").expect(2, &["`out.{04}.png` is the name of frames", "--frames 48"]);
    build(&desk, "-o out.mp4").expect(2, &["`mp4` is no format of pictures", "--frames 48"]);
    build(&desk, "--frames 5 -o {}.png").expect(2, &["--sweep"]);
    build(&desk, r#"--sweep "t = 0 to 1" -o {}.png"#).expect(2, &["--frames"]);
    let wrong = |sweep: &str, said: &[&str]| {
        build(&desk, &format!(r#"--sweep "{sweep}" --frames 5 -o {{}}.png"#)).expect(1, said);
        assert_eq!(desk.names(), ["ball.rt", "rise.rt"], "{sweep}");
    };
    wrong("t = 1", &["E0503", "[--sweep:1:", "`to` or `until`", "frame 1 of 5 cannot be made"]);
    wrong("t = 0 to 8deg", &["E0203", "8deg"]);
    wrong("t = 0 to 1 to 2", &["E0503", "this has more", "choose the values"]);
    wrong("t = 0 until 1 until 2", &["E0503", "this has more"]);
    wrong("s = 0 to 1", &["E0503", "no param `s`"]);
    desk.put("rise.rt", RISING.replace("= 0\n", "= 0 in 0 to 1\n"));
    // Found before the frames on the way to it are made.
    wrong("t = 0 to 2", &["E0401", "frame 5 of 5, with `t = 2`, cannot be made"]);
}

/// A task that is asked for again while the first one is still at it.
#[test]
fn frames_that_are_made_twice_at_once_are_whole() {
    let desk = desk();
    let film = |name: &str| {
        let flags = format!("--frames 6 --size 48x36 --samples 10 -o {name}{{}}.exr --resume");
        let mut command = desk.command("build rise.rt");
        command.args(["--sweep", "t = 0 to 1"]).args(flags.split_whitespace()).stderr(Stdio::piped());
        command
    };
    ended(film("one").output().unwrap()).expect(0, &[]);
    let both = [(); 2].map(|()| film("two").spawn().unwrap());
    let both = both.map(|child| ended(child.wait_with_output().unwrap()));
    assert!(both.iter().any(|ended| ended.code == Some(0)), "{both:?}");
    for ended in both.iter().filter(|ended| ended.code != Some(0)) {
        ended.expect(2, &["another process is writing it"]);
    }
    ended(film("two").output().unwrap()).expect(0, &["6 of 6 is done"]);
    for number in 1..=6 {
        assert_same(&desk.path(&format!("one{number}.exr")), &desk.path(&format!("two{number}.exr")));
    }
    assert!(desk.names().iter().all(|name| !name.ends_with(".tmp")), "{:?}", desk.names());
}

#[test]
fn a_film_in_one_file_is_waited_for() {
    let desk = desk();
    for outputs in ["-o film.webp", "-o f.{}.exr -o both.webp"] {
        let film = |rest: &str| {
            let mut command =
                command_of(&desk, &format!("--frames 3 --size 24x18 {outputs} --resume {rest}"));
            command.stderr(Stdio::piped()).spawn().unwrap()
        };
        let mut first = film("--samples 1000000");
        while !desk.names().iter().any(|name| name.ends_with(".webp.tmp")) {
            assert!(first.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(5));
        }
        ended(film("--samples 3").wait_with_output().unwrap())
            .expect(2, &["another process is writing it", "--wait"]);
        let mut second = film("--samples 3 --wait 10min");
        let mut lines = BufReader::new(second.stderr.take().unwrap()).lines().map_while(Result::ok);
        assert!(lines.any(|line| line.contains("it is waited for")), "it ended");
        first.kill().unwrap();
        first.wait().unwrap();
        assert!(lines.any(|line| line.starts_with("3 frames in")), "it ended");
        assert!(second.wait().unwrap().success());
    }
}

#[test]
fn a_film_of_very_many_frames_begins_at_once() {
    let desk = desk();
    let start = std::time::Instant::now();
    let film = |rest: &str| build(&desk, &format!(r#"--sweep "t = 0 to 2deg" --frames 1000000 {rest}"#));
    film("-o f{06}.exr").expect(1, &["E0203"]);
    film("-o f{}.png -o f{03}.png").expect(2, &["`f100.png` is given twice"]);
    film("-o rise.{04}.png -o rise.rt").expect(2, &["rise.rt"]);
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

/// A program that is called ffmpeg, in a folder that is the path.
#[cfg(unix)]
fn fake_ffmpeg(desk: &Desk, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    fs::create_dir_all(desk.path("bin")).unwrap();
    desk.put(
        "bin/ffmpeg",
        format!("#!/bin/sh\nPATH=/usr/bin:/bin\n[ \"$1\" = -version ] && exit 0\n{script}\n"),
    );
    fs::set_permissions(desk.path("bin/ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
}

#[cfg(unix)]
fn with_fake(desk: &Desk, rest: &str) -> std::process::Command {
    let mut command = command(desk, &format!(r#"--sweep "t = 0 to 1" --frames 3 {rest}"#));
    command.env("PATH", desk.path("bin"));
    command
}

#[cfg(unix)]
#[test]
fn ffmpeg_gets_the_frames_and_the_film_is_whole_or_not_there() {
    let desk = desk();
    fs::create_dir(desk.path("bin")).unwrap();
    let run = |rest: &str| ended(with_fake(&desk, rest).output().unwrap());
    run("-o film.mp4").expect(2, &["`film.mp4` is made by ffmpeg, which cannot be run", "-o frame.{04}.png"]);
    // It writes what it gets, and tells what it was told.
    fake_ffmpeg(&desk, "for file; do :; done\nprintf '%s\\n' \"$@\" > told\ncat > \"${file#file:}\"");
    run("-o film.mp4 -o f{}.png --fps 23.976").expect(0, &["film.mp4: video of 3 frames, 24×18, 0.13 s"]);
    let frames: Vec<Vec<u8>> =
        (1..=3).map(|number| read_png(&desk.get(&format!("f{number}.png"))).1).collect();
    assert!(desk.get("film.mp4") == frames.concat());
    let told = String::from_utf8(desk.get("told")).unwrap();
    for line in ["rawvideo", "rgb24", "24x18", "23976/1000", "pipe:0", "mp4", "-y"] {
        assert!(told.lines().any(|told| told == line), "{line} in {told}");
    }
    run("-o film.mkv").expect(0, &["film.mkv: video"]);
    run("-o odd.mp4 --crop 0,0,23,18").expect(2, &["even width and height", "--size 24x18"]);

    desk.put("film.mp4", "the film of yesterday");
    fake_ffmpeg(&desk, "cat > /dev/null; echo 'no such encoder' >&2; exit 1");
    run("-o film.mp4").expect(2, &["ffmpeg could not make the film: no such encoder"]);
    fake_ffmpeg(&desk, "exit 3");
    run("-o film.mp4").expect(2, &["ffmpeg could not make the film: exit status: 3"]);
    fake_ffmpeg(&desk, "cat > /dev/null");
    run("-o film.mp4").expect(2, &["ffmpeg could not make the film: it has written nothing"]);
    assert_eq!(desk.get("film.mp4"), b"the film of yesterday");
    let names = desk.names();
    assert!(!names.iter().any(|name| name.ends_with(".tmp") || name == "odd.mp4"), "{names:?}");
}

#[cfg(unix)]
#[test]
fn an_interrupted_film_leaves_what_was_there_and_goes_on() {
    let desk = desk();
    let interrupt = |command: &mut std::process::Command, wait: &dyn Fn() -> bool| {
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        while !wait() {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(5));
        }
        let kill =
            std::process::Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
        assert!(kill.unwrap().success());
        ended(child.wait_with_output().unwrap()).expect(130, &["interrupted"]);
    };
    let left = |desk: &Desk| {
        let mut names = desk.names();
        names.retain(|name| name.ends_with(".tmp"));
        names
    };
    for film in ["film.webp", "film.apng"] {
        desk.put(film, "the film of yesterday");
        let mut command =
            command(&desk, &format!(r#"--sweep "t = 0 to 1" --frames 100000 -o {film} -o f{{}}.png"#));
        interrupt(&mut command, &|| desk.path("f3.png").exists());
        assert_eq!(desk.get(film), b"the film of yesterday");
        assert_eq!(left(&desk), Vec::<String>::new());
        (1..=3).for_each(|number| drop(fs::remove_file(desk.path(&format!("f{number}.png")))));
    }

    // The program that makes it ends too, and first.
    fake_ffmpeg(
        &desk,
        "for file; do :; done\necho $$ > pid\ncat > \"${file#file:}\"; sleep 600; echo late > \"${file#file:}\"",
    );
    let rest = r#"--sweep "t = 0 to 1" --frames 100000 -o film.mp4"#;
    let mut command = command(&desk, rest);
    command.env("PATH", desk.path("bin"));
    interrupt(&mut command, &|| desk.path("pid").exists());
    assert!(!desk.path("film.mp4").exists() && left(&desk).is_empty());
    let id = String::from_utf8(desk.get("pid")).unwrap();
    let alive = std::process::Command::new("sh").args(["-c", &format!("kill -0 {}", id.trim())]).output();
    assert!(!alive.unwrap().status.success(), "ffmpeg goes on");

    // Kept samples of the frame under way, and done ones.
    let frames = "--frames 3 -o long.webp --checkpoint";
    let mut slow = command_of(&desk, &format!("--samples 100 --size 320x240 {frames}"));
    interrupt(&mut slow, &|| desk.path("long.webp.frames/000001.exr.made").exists());
    assert!(!desk.path("long.webp").exists() && left(&desk).is_empty());
    ended(command_of(&desk, &format!("--samples 100 --size 320x240 {frames}")).output().unwrap())
        .expect(0, &["frame 1 of 3 is done", "long.webp: animated WebP of 3 frames"]);
    ended(command_of(&desk, "--samples 100 --size 320x240 --frames 3 -o once.webp").output().unwrap())
        .expect(0, &[]);
    assert_same(&desk.path("long.webp"), &desk.path("once.webp"));
}

/// A film of the rising ball with flags of its own.
fn command_of(desk: &Desk, rest: &str) -> std::process::Command {
    let mut command = desk.command("build rise.rt");
    command.args(["--sweep", "t = 0 to 1"]).args(rest.split_whitespace());
    command
}

#[test]
fn a_transparent_film_keeps_what_is_not_covered() {
    let desk = desk();
    desk.put("rise.rt", RISING.replace("plane { at: (0, -1, 0)m }", "render { background: transparent }"));
    build(&desk, r#"--sweep "t = 0 to 1" --frames 2 -o film.webp -o film.apng -o f{}.png"#).expect(0, &[]);
    assert_eq!(desk.get("film.apng")[25], 6, "red, green, blue and alpha");
    let decoder = image::codecs::webp::WebPDecoder::new(Cursor::new(desk.get("film.webp"))).unwrap();
    let shown = decoder.into_frames().collect_frames().unwrap();
    for (number, shown) in (1..).zip(&shown) {
        assert!(shown.buffer().as_raw()[..] == read_png(&desk.get(&format!("f{number}.png"))).1[..]);
    }
}
