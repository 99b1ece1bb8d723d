//! Where files are written: through links, over what may not be written, beside what others have, and where names steer terminals.

use super::{Desk, Ended, ended};
use std::fs;
use std::io::{BufRead, BufReader};

fn build(desk: &Desk, rest: &str) -> Ended {
    desk.run(&format!("build ball.rt --size 16x12 --samples 2 --quiet {rest}"))
}

fn film(desk: &Desk, rest: &str) -> Ended {
    desk.put("rise.rt", "param t: length = 0\nsphere { radius: 1m, at: (0, t, 0) }\n");
    let mut command = desk.command("build rise.rt --size 16x12 --samples 2 --frames 3 --resume");
    ended(command.args(["--sweep", "t = 0 to 1m"]).args(rest.split_whitespace()).output().unwrap())
}

#[test]
fn nothing_that_a_file_says_steers_the_terminal() {
    let desk = Desk::new();
    let [text, name, doc] = ["z\u{1b}[31m\u{202e}", "p\u{1b}[2J.rt", "window \u{1b}]0;pwned\u{7}\u{9b}2J"];
    desk.put(name, "let r = 1m\n");
    let scene = format!(
        "import \"{name}\" as p\n/// {doc}\nparam a: text = \"{text}\"\n// {doc}\nsphere {{radius: p.r}}\n"
    );
    desk.put("steers.rt", &scene);
    desk.put("bad.rt", scene.replace("1m", "1").replace("p.r", "p.q"));
    fs::write(desk.path("steers\u{1b}[2J.rt"), "sphere { radius: 8deg }").unwrap();
    let steers = |shown: &str| shown.contains(['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}']);
    assert!(steers(&scene));
    let info = desk.run("info steers.rt");
    let printed = String::from_utf8(info.stdout).unwrap();
    assert!(
        info.code == Some(0) && printed.contains("window") && printed.contains("p\u{fffd}[2J.rt"),
        "{printed}"
    );
    assert!(!steers(&printed), "{printed:?}");
    for arguments in [
        "why steers.rt 0,0 --samples 1 --size 4x4",
        "check steers.rt bad.rt steers\u{1b}[2J.rt",
        "check --message-format short bad.rt",
        "build steers\u{1b}[2J.rt no\u{1b}[2J.rt",
        "build steers.rt --size 4x4 --samples 1 -o \u{1b}[2J.png",
        "merge \u{1b}[2J.png -o a.png",
        "develop no\u{1b}[2J.exr -o a.png",
        "fmt no\u{1b}[2J.rt",
        "export steers.rt -o no\u{1b}[2J/a.pbrt",
        "expand steers.rt -o no\u{1b}[2J/a.rt",
        "init \u{1b}[2J",
        "check -\u{1b}[2J.rt",
        "info --json=\u{1b}[2J steers.rt",
    ] {
        let Ended { stdout, stderr, .. } = desk.run(arguments);
        let printed = String::from_utf8(stdout).unwrap();
        assert!(!printed.is_empty() || !stderr.is_empty() || arguments.contains("bad.rt"), "{arguments:?}");
        assert!(!steers(&printed) && !steers(&stderr), "{arguments:?}: {printed:?} {stderr:?}");
    }
    // A program gets the text as it is; a step of the end-to-end tests sees that a terminal does not.
    let diff = desk.run("fmt --diff steers.rt");
    assert!(String::from_utf8(diff.stdout).unwrap().contains(doc));
}

#[test]
fn nothing_is_written_but_what_flags_name() {
    let desk = Desk::new();
    desk.put("rise.rt", "param t: length = 0\nsphere { radius: 1m, at: (0, t, 0) }\n");
    for reads in [
        "check rise.rt",
        "info rise.rt",
        "expand rise.rt",
        "why rise.rt 0,0 --size 4x4",
        "fmt --diff rise.rt",
    ] {
        assert_eq!(desk.run(reads).code, Some(0), "{reads}");
    }
    assert_eq!(desk.names(), ["ball.rt", "rise.rt"]);
    film(&desk, "-o f{}.exr --only 1").expect(0, &[]);
    film(&desk, "-o film.webp").expect(0, &[]);
    build(&desk, "-o a.png --checkpoint").expect(0, &[]);
    build(&desk, "").expect(0, &[]);
    assert_eq!(
        desk.names(),
        [
            "a.png",
            "a.png.checkpoint",
            "ball.png",
            "ball.rt",
            "f1.exr",
            "f1.exr.made",
            "film.webp",
            "film.webp.frames",
            "rise.rt"
        ]
    );
}

#[cfg(unix)]
mod on_unix {
    use super::super::{Desk, Ended, ended};
    use super::{BufRead, BufReader, build, film, fs};
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    use std::os::unix::process::CommandExt;
    use std::process::{Child, Stdio};

    /// As somebody who may not write everything, if this is one who may.
    fn as_anybody(desk: &Desk, arguments: &str) -> Ended {
        let mut command = desk.command(arguments);
        if fs::metadata(desk.path("ball.rt")).unwrap().uid() == 0 {
            fs::set_permissions(desk.path("."), fs::Permissions::from_mode(0o777)).unwrap();
            command.uid(65534).gid(65534);
        }
        ended(command.output().unwrap())
    }

    fn mode(desk: &Desk, name: &str) -> u32 {
        fs::metadata(desk.path(name)).unwrap().permissions().mode() & 0o777
    }

    /// Begins a picture without end, and waits until its file has this name.
    fn begin(desk: &Desk, output: &str, aside: &str) -> Child {
        let arguments =
            format!("build ball.rt --size 400x300 --samples 1000000 -o {output} --checkpoint --resume=never");
        let mut child = desk.command(&arguments).stderr(Stdio::null()).spawn().unwrap();
        desk.wait_for(aside, &mut child);
        child
    }

    fn kill(mut child: Child) {
        child.kill().unwrap();
        child.wait().unwrap();
    }

    #[test]
    fn what_is_read_only_is_replaced_and_stays_so_and_a_kill_leaves_nothing_in_the_way() {
        let desk = Desk::new();
        let arguments = "build ball.rt --size 16x12 --samples 2 --quiet -o a.png --checkpoint";
        as_anybody(&desk, arguments).expect(0, &[]);
        for name in ["a.png", "a.png.checkpoint"] {
            fs::set_permissions(desk.path(name), fs::Permissions::from_mode(0o444)).unwrap();
        }
        let long = begin(&desk, "a.png", ".rtc-a.png.tmp");
        kill(long);
        assert_eq!(mode(&desk, ".rtc-a.png.tmp") & 0o200, 0o200, "its owner may take it away");
        // Left by somebody whose files may be read alone.
        for name in [".rtc-a.png.tmp", ".rtc-a.png.checkpoint.tmp"] {
            desk.put(name, "left");
            fs::set_permissions(desk.path(name), fs::Permissions::from_mode(0o444)).unwrap();
        }
        as_anybody(&desk, &format!("{arguments} --resume=never")).expect(0, &[]);
        assert_eq!((mode(&desk, "a.png"), mode(&desk, "a.png.checkpoint")), (0o444, 0o444));
        desk.put(".rtc-a.png.tmp", "left");
        fs::set_permissions(desk.path(".rtc-a.png.tmp"), fs::Permissions::from_mode(0o0)).unwrap();
        as_anybody(&desk, arguments)
            .expect(2, &["permission denied", ".rtc-a.png.tmp` was left by another user"]);
    }

    #[test]
    fn links_are_written_through_and_two_of_them_lead_to_one_file() {
        let desk = Desk::new();
        fs::create_dir(desk.path("large")).unwrap();
        // What is not there yet is made where the link leads.
        symlink("large/kept", desk.path("a.exr.checkpoint")).unwrap();
        symlink("a.exr.checkpoint", desk.path("again")).unwrap();
        build(&desk, "-o a.exr --checkpoint=again").expect(0, &[]);
        assert!(desk.path("a.exr.checkpoint").is_symlink() && desk.path("again").is_symlink());
        assert!(desk.path("large/kept").is_file());
        build(&desk, "-o a.exr --checkpoint").expect(0, &[]);

        for name in ["l1.png", "l2.png"] {
            symlink("large/real.png", desk.path(name)).unwrap();
        }
        let first = begin(&desk, "l1.png", ".rtc-l1.png.checkpoint.lock.tmp");
        build(&desk, "-o l2.png --checkpoint").expect(2, &["cannot write `l2.png`: another process"]);
        kill(first);
        build(&desk, "-o l2.png --checkpoint").expect(0, &[]);

        // One that leads to itself, or to a disk that is not there, is not taken for nothing.
        symlink("loop", desk.path("loop")).unwrap();
        build(&desk, "-o a.exr --checkpoint=loop")
            .expect(2, &["cannot write `loop`: its links lead in a circle"]);
        build(&desk, "-o b.exr --checkpoint=kept --resume=loop").expect(2, &["cannot read `loop`"]);
        symlink("/no/such/disk/kept", desk.path("gone")).unwrap();
        build(&desk, "-o a.exr --checkpoint=gone").expect(2, &["there is no folder `/no/such/disk`"]);
        assert!(desk.path("loop").is_symlink() && desk.path("gone").is_symlink());
        build(&desk, "-o a.exr --checkpoint=./a.exr").expect(2, &["both the picture and its checkpoint"]);
    }

    #[test]
    fn a_share_that_another_process_makes_is_waited_for() {
        let desk = Desk::new();
        build(&desk, "-o b.png --wait 1s").expect(2, &["`--wait` is for work that is kept"]);
        let first = begin(&desk, "a.png", ".rtc-a.png.tmp");
        build(&desk, "-o a.png --resume").expect(2, &["cannot write `a.png`: another process", "--wait"]);
        // Who keeps nothing is in nobody's way, and nobody in theirs.
        build(&desk, "-o a.png").expect(0, &[]);
        let quiet = build(&desk, "-o a.png --resume --wait 600ms");
        quiet.expect(2, &["another process", "it was waited for 600 ms: give `--wait` longer"]);
        assert!(!quiet.stderr.contains("it is waited for"), "{}", quiet.stderr);
        let mut second = desk
            .command("build ball.rt --size 400x300 --samples 1 -o a.png --resume --wait 10min")
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(second.stderr.take().unwrap()).lines().map_while(Result::ok);
        assert!(lines.any(|line| line.contains("it is waited for")), "it ended");
        kill(first);
        assert!(lines.any(|line| line.contains("400×300")), "it ended");
        assert!(second.wait().unwrap().success());
    }

    #[test]
    fn a_frame_that_another_process_makes_does_not_hold_up_the_others() {
        let desk = Desk::new();
        let other = begin(&desk, "f1.png", ".rtc-f1.png.tmp");
        let rest = film(&desk, "-o f{}.png");
        rest.expect(
            2,
            &["cannot write `f1.png`: another process", "f2.png, frame 2 of 3", "f3.png, frame 3 of 3"],
        );
        kill(other);
        fs::remove_file(desk.path("f1.png.checkpoint")).ok();
        film(&desk, "-o f{}.png").expect(0, &["f1.png, frame 1 of 3: 2 samples", "frame 2 of 3 is done"]);
    }
}

#[test]
fn a_damaged_record_is_no_reason_to_stop_a_film() {
    let desk = Desk::new();
    film(&desk, "-o f{}.png").expect(0, &[]);
    desk.put("f1.png.made", vec![0; 70_000]);
    fs::remove_file(desk.path("f2.png.made")).unwrap();
    fs::create_dir(desk.path("f2.png.made")).unwrap();
    film(&desk, "-o f{}.png").expect(
        0,
        &[
            "made anew: `f1.png.made` is larger than 64.0 KiB",
            "made anew: cannot read `f2.png.made`: it is not a file",
            "the frame is made; asked for again",
            "frame 3 of 3 is done",
        ],
    );
    film(&desk, "-o f{}.png").expect(0, &["frame 1 of 3 is done"]);
    // Work that is not kept is told to whoever asks for nothing but errors too.
    let quiet = film(&desk, "-o f{}.png -q");
    quiet.expect(0, &["the frame is made; asked for again"]);
    assert!(quiet.stderr.starts_with("warning: ") && !quiet.stderr.contains("done"), "{}", quiet.stderr);
}

#[test]
fn a_checkpoint_beside_a_frame_that_is_done_is_removed_unless_it_has_more() {
    let desk = Desk::new();
    film(&desk, "-o f{}.png").expect(0, &[]);
    let leave = |samples: u32| {
        let rest = format!("--samples {samples} --checkpoint=f1.png.checkpoint --resume=never -o other.png");
        desk.run(&format!("build rise.rt -q --size 16x12 {rest}")).expect(0, &[]);
    };
    leave(3);
    film(&desk, "-o f{}.png").expect(0, &["frame 1 of 3 is done"]);
    assert!(desk.path("f1.png.checkpoint").exists());
    // Nor is another picture's removed.
    desk.run("build ball.rt -q --size 16x12 --samples 2 --checkpoint=f2.png.checkpoint -o other.png")
        .expect(0, &[]);
    leave(2);
    film(&desk, "-o f{}.png").expect(0, &["frame 1 of 3 is done"]);
    assert!(desk.path("f2.png.checkpoint").exists());
    assert!(!desk.path("f1.png.checkpoint").exists());
}

#[test]
fn a_film_is_not_replaced_by_some_of_its_frames() {
    let desk = Desk::new();
    // As long as there is none, some frames make one.
    film(&desk, "--only 2 -o f.webp").expect(0, &["f.webp: animated WebP of 1 frame"]);
    film(&desk, "--only 2 -o f.webp").expect(0, &["frame 2 of 3 is done", "of 1 frame"]);
    film(&desk, "-o f.webp").expect(0, &["of 3 frames"]);
    let whole = fs::read(desk.path("f.webp")).unwrap();
    film(&desk, "--only 2 -o f.webp")
        .expect(2, &["`f.webp` would be replaced by 1 of the 3 frames", "leave `--only` out"]);
    assert_eq!(fs::read(desk.path("f.webp")).unwrap(), whole);
    // What is not kept is told by nothing to be of a longer film.
    let mut command = desk.command("build rise.rt --size 16x12 --samples 2 --frames 3 --only 2 -o f.webp");
    ended(command.args(["--sweep", "t = 0 to 1m"]).output().unwrap()).expect(0, &["of 1 frame"]);
}

#[test]
fn shares_that_do_not_go_together_are_told_by_what_they_are() {
    let desk = Desk::new();
    let share = |samples: u32, share: &str, to: &str| {
        desk.run(&format!("build ball.rt -q --size 16x12 --samples {samples} --shard {share} -o {to}"))
            .expect(0, &[]);
    };
    share(10, "1/3", "1.exr");
    share(30, "2/3", "2.exr");
    desk.run("merge 1.exr 2.exr -o all.exr").expect(
        2,
        &["`2.exr` does not go with `1.exr`: its picture is of 30 samples in 3 shares, and that one of 10 samples in 3"],
    );
    desk.run("merge 1.exr 1.exr -o all.exr").expect(2, &["`1.exr` is given twice"]);
    desk.run("merge 1.exr -o all.exr").expect(2, &["shares 2, 3 of 3 are missing", "`--shard 2/3`"]);
}

#[test]
fn what_a_merge_cannot_write_is_said_before_its_shares_are_read() {
    let desk = Desk::new();
    desk.put("clear.rt", "sphere { radius: 1m }\nrender { background: transparent }\n");
    desk.run("build clear.rt -q --size 16x12 --samples 2 --shard 1/2 -o 1.exr").expect(0, &[]);
    desk.put("2.exr", "torn");
    desk.run("merge 1.exr 2.exr -o no/all.png").expect(2, &["there is no folder `no`"]);
    desk.run("merge 1.exr 2.exr -o all.jpg").expect(2, &["JPEG"]);
    assert_eq!(desk.names(), ["1.exr", "2.exr", "ball.rt", "clear.rt"]);
}

#[test]
fn a_film_that_will_be_too_large_says_so_at_its_first_frame() {
    let desk = Desk::new();
    // Noise makes it large.
    let noisy = "param t: length = 0\nplane {}\nlight { at: (2, 4, 3)m, radius: 1m, power: 90W }\n";
    desk.put("rise.rt", format!("{noisy}sphere {{ radius: 1m, at: (0, t, 0) }}\n"));
    let mut child = desk
        .command("build rise.rt --size 100x75 --samples 1 --frames 1000000 -o film.webp")
        .args(["--sweep", "t = 0 to 1m"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let said = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let warning =
        said.take_while(|line| !line.contains("frame 2 ")).find(|line| line.starts_with("warning: `film"));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(warning.is_some_and(|warning| warning.contains("`film.webp` can be 4 GiB ")));
}
