//! Samples that are kept and gone on with.

mod limits;
mod shares;

use super::{Desk, assert_same};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A scene in which paths take a while.
const ROOM: &str = "
sphere { radius: 1m, material: dielectric { ior: 1.5 } }
sphere { at: (1.5, 0, 0.5)m, radius: 40cm, material: metal { roughness: 20% } }
plane { at: (0, -1, 0)m }
light { at: (2, 4, 3)m, radius: 30cm, power: 90W }
";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.put("room.rt", ROOM);
    desk
}

/// Small enough to be over soon.
fn build(desk: &Desk, rest: &str) -> super::Ended {
    desk.run(&format!("build room.rt --size 48x36 --quiet {rest}"))
}

#[test]
fn what_is_kept_depends_on_nothing_but_what_was_asked_for() {
    let desk = desk();
    let kept = |every: &str| {
        let flags = "--samples 64 --noise 0.1% -o a.exr --checkpoint --resume=never";
        build(&desk, &format!("{flags} --checkpoint-every {every}")).expect(0, &[]);
        desk.get("a.exr.checkpoint")
    };
    // Also where it was kept with the last sample, before that was judged.
    assert!(kept("1h") == kept("1spp"));
}

#[test]
fn a_share_is_replaced_by_no_checkpoint() {
    let desk = desk();
    build(&desk, "--samples 6 --shard 1/3 -o part.exr").expect(0, &[]);
    let share = desk.get("part.exr");
    build(&desk, "--samples 6 --checkpoint=part.exr --resume=never -o a.png")
        .expect(2, &["`part.exr` would be replaced by the checkpoint, and holds share 1/3 of 6 samples"]);
    assert!(desk.get("part.exr") == share);
}

#[test]
fn what_was_kept_goes_on_to_the_same_bytes() {
    let desk = desk();
    build(&desk, "--samples 40 -o whole.exr").expect(0, &[]);
    build(&desk, "--samples 7 -o a.exr --checkpoint").expect(0, &[]);
    assert!(desk.names().contains(&"a.exr.checkpoint".to_string()));
    // More samples for a picture that was done.
    build(&desk, "--samples 40 -o a.exr --checkpoint").expect(0, &[]);
    assert_same(&desk.path("whole.exr"), &desk.path("a.exr"));
    // Nothing is left to do; and fewer samples than there are cannot be had.
    build(&desk, "--samples 40 -o a.exr --resume -j 2").expect(0, &[]);
    assert_same(&desk.path("whole.exr"), &desk.path("a.exr"));
    build(&desk, "--samples 7 -o a.exr --resume=never --checkpoint=other").expect(0, &[]);
    build(&desk, "--samples 40 -o a.exr --resume=other").expect(0, &[]);
    assert_same(&desk.path("whole.exr"), &desk.path("a.exr"));
    // A picture in the making is a picture.
    desk.run("develop other -o other.png --quiet").expect(0, &[]);

    let refused =
        |rest: &str, said: &[&str]| build(&desk, &format!("-o a.exr --resume {rest}")).expect(2, said);
    refused(
        "--seed 3",
        &["cannot go on from `a.exr.checkpoint`", "another picture: `--seed 3` (kept: 0)", "--resume=never"],
    );
    refused("--crop 0,0,9,9", &["`--crop 0,0,9,9` (kept: 0,0,48,36)"]);
    refused("--samples 40 --shard 1/2", &["`--shard 1/2 --samples 40` (kept: no `--shard`)"]);
    refused("--resume=missing", &["--resume"]);
    let resized = desk.run("build room.rt --size 24x18 -q -o a.exr --resume");
    resized.expect(2, &["another picture: `--size 24x18` (kept: 48x36)\n"]);
    let reshaped = desk.run("build room.rt --size 47x36 -q -o a.exr --resume");
    reshaped.expect(2, &["another picture: `--size 47x36` (kept: 48x36)\n"]);
    build(&desk, "-o a.exr --resume=missing").expect(2, &["cannot read `missing`"]);
    desk.put("room.rt", ROOM.replace("power: 90W", "power: 91W"));
    refused("", &["of another picture: other materials"]);
    desk.put("room.rt", ROOM.replace("roughness: 20%", "roughness: 21%"));
    refused("", &["other materials"]);
    desk.put("room.rt", ROOM);
    let mut torn = desk.get("a.exr.checkpoint");
    let middle = torn.len() / 2;
    torn[middle] ^= 1;
    desk.put("a.exr.checkpoint", torn);
    refused("", &["cannot go on from `a.exr.checkpoint`: it ", " damaged", "begins afresh and replaces it"]);
    desk.put("empty", "");
    desk.put("picture", [0x89, b'P', b'N', b'G']);
    for (file, what) in [("empty", "it is empty"), ("picture", "it is a PNG"), ("room.rt", "it is a text")] {
        build(&desk, &format!("-o a.exr --checkpoint=kept --resume={file}"))
            .expect(2, &[what, "name a file that `--checkpoint` wrote"]);
    }
    for flag in ["--checkpoint", "--resume"] {
        let said = format!("`kept` is taken for a scene, and is probably the file of `{flag}`");
        let helped = format!("`{flag}=kept`");
        build(&desk, &format!("{flag} kept -o a.exr")).expect(2, &[&said, &helped]);
        build(&desk, &format!("{flag} kept")).expect(2, &[&said, &helped]);
        // Also where there is such a file, which is no scene.
        let (said, helped) = (said.replace("kept", "other"), helped.replace("kept", "other"));
        desk.run(&format!("build {flag} other room.rt --size 4x3")).expect(2, &[&said, &helped]);
    }
    assert!(!desk.names().contains(&"room.png".to_string()));
    build(&desk, "-o a.exr --checkpoint=a.exr").expect(2, &["both the picture and its checkpoint"]);
    build(&desk, "-o - --checkpoint").expect(2, &["--checkpoint=FILE"]);
    build(&desk, "-o a.exr --checkpoint=room.rt --resume=never").expect(2, &["would be replaced"]);
    build(&desk, "ball.rt --checkpoint=kept").expect(2, &["several scenes"]);
    build(&desk, "-o a.exr --checkpoint=no/folder").expect(2, &["there is no folder `no`"]);
}

#[test]
fn nothing_but_a_checkpoint_is_replaced_by_one() {
    let desk = desk();
    build(&desk, "--samples 1 -o a.exr -o tex.png --checkpoint=kept.exr").expect(0, &[]);
    let images =
        "sphere { radius: 1m, material: diffuse { color: image(\"tex.png\") } }\nsky { image: \"kept.exr\" }";
    desk.put("main.rt", format!("import \"ball.rt\" as ball\nball {{ }}\n{images}\n"));
    desk.put("notes.txt", "a text of years");
    desk.put("empty", "");
    let main = |file: &str, rest: &str| {
        let before = desk.get(file);
        let said = format!("`{file}` would be replaced by the checkpoint");
        let ended =
            desk.run(&format!("build main.rt --size 8x6 --samples 1 -q -o b.png --checkpoint={file} {rest}"));
        ended.expect(2, &[&said, "name another file: `--checkpoint=FILE`"]);
        assert!(desk.get(file) == before && !desk.names().contains(&"b.png".into()), "{file} {rest}");
        ended.stderr
    };
    for rest in ["", "--resume=never", "--resume=kept.exr"] {
        // What is removed is not there any more to be read.
        for input in ["main.rt", "ball.rt", "tex.png", "kept.exr"] {
            assert!(!main(input, rest).contains("remove"), "{input} {rest}");
        }
        for (other, what) in [("notes.txt", "a text"), ("a.exr", "a picture alone"), ("empty", "empty")] {
            let said = main(other, rest);
            assert!(said.contains(what) && said.contains("remove it, or"), "{said}");
        }
    }
    // One that is torn, or of another version, is one all the same.
    let kept = desk.get("kept.exr");
    let (form, at) = (b"rtc.saved.version\0string\0\x01\0\0\0", |bytes: &[u8], form: &[u8]| {
        bytes.windows(form.len()).position(|part| part == form).unwrap() + form.len()
    });
    let mut old = kept.clone();
    old[at(&kept, form)] = b'1';
    for wrong in [&kept[..kept.len() / 2], &old] {
        desk.put("wrong", wrong);
        build(&desk, "-o b.png --checkpoint=wrong").expect(2, &["cannot go on from `wrong`", "replaces it"]);
        build(&desk, "--samples 1 -o b.png --checkpoint=wrong --resume=never").expect(0, &[]);
        build(&desk, "--samples 1 -o b.png --checkpoint=wrong").expect(0, &[]);
    }
    // A name that nobody chose is of nothing else.
    desk.put("b.png.checkpoint", "junk");
    build(&desk, "--samples 1 -o b.png --resume=never").expect(0, &[]);
    fs::create_dir(desk.path("folder")).unwrap();
    build(&desk, "-o b.png --resume=folder").expect(2, &["cannot read `folder`: it is not a file"]);
}

#[cfg(unix)]
#[test]
fn samples_that_cannot_be_kept_are_a_warning() {
    let desk = desk();
    fs::create_dir(desk.path("store")).unwrap();
    // So slow that the folder is gone before the last of them are to be kept.
    let flags = "--size 48x36 --samples 1000 -j 1 -o a.png --checkpoint=store/kept --checkpoint-every 1spp";
    let mut child = desk.command(&format!("build room.rt {flags}")).stderr(Stdio::piped()).spawn().unwrap();
    desk.wait_for("store/kept", &mut child);
    fs::rename(desk.path("store"), desk.path("elsewhere")).unwrap();
    let ended = super::ended(child.wait_with_output().unwrap());
    ended.expect(0, &["warning: cannot write `store/kept`: there is no folder", "the picture goes on"]);
    assert!(!ended.stderr.contains("error") && desk.path("a.png").exists(), "{}", ended.stderr);
}

#[test]
fn what_is_kept_and_gone_on_from_is_told() {
    let desk = desk();
    let build = |rest: &str| desk.run(&format!("build room.rt --size 16x12 -o a.png {rest}"));
    let told = |ended: super::Ended| ended.stderr.lines().last().unwrap().to_string();
    assert_eq!(told(build("--samples 4 --checkpoint")), "kept 4 samples in `a.png.checkpoint`");
    let went_on = "went on from 4 samples in `a.png.checkpoint`";
    assert_eq!(told(build("--samples 9 --resume")), format!("{went_on}, kept 9 samples there"));
    let nothing_left = "went on from 9 samples in `a.png.checkpoint`, where nothing was left to trace";
    assert_eq!(told(build("--samples 9 --resume")), nothing_left);
    // Also where nothing is left to trace the file is there that was asked for.
    let elsewhere = build("--samples 9 --resume=a.png.checkpoint --checkpoint=kept");
    assert_eq!(told(elsewhere), "went on from 9 samples in `a.png.checkpoint`, kept 9 samples in `kept`");
    assert_same(&desk.path("a.png.checkpoint"), &desk.path("kept"));
    // What is kept under another name is not lost to less, or to another picture.
    build("--samples 20 --checkpoint=more").expect(0, &[]);
    build("--samples 4 --seed 2 --checkpoint=other").expect(0, &[]);
    let (more, other) = (desk.get("more"), desk.get("other"));
    let onto = |to: &str| build(&format!("--samples 16 --resume=kept --checkpoint={to}"));
    onto("more").expect(
        2,
        &["`more` would be replaced by the checkpoint: it has more samples than `kept`", "--resume=more"],
    );
    onto("other")
        .expect(2, &["`other` would be replaced by the checkpoint: it is of another picture", "--seed"]);
    assert!(desk.get("more") == more && desk.get("other") == other);
    build("--samples 25 --resume=more --checkpoint=kept").expect(0, &["went on from 20 samples in `more`"]);
    assert!(build("--samples 9 --resume=a.png.checkpoint --quiet").stderr.is_empty());
    assert!(!build("--samples 9").stderr.contains("kept"));
}

#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let kill = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status();
    assert!(kill.unwrap().success());
}

#[cfg(unix)]
#[test]
fn a_build_that_keeps_nothing_goes_on_after_a_request_to_keep() {
    let desk = desk();
    let begin = |flags: &str, aside: &str| {
        let arguments = format!("build ball.rt --size 200x150 --samples 1000000 -o a.png {flags}");
        let mut child = desk.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
        // Its ears are open before that.
        desk.wait_for(aside, &mut child);
        send("USR1", &child);
        child
    };
    let mut quiet = begin("-q", ".rtc-a.png.1.tmp");
    let mut child = begin("", ".rtc-a.png.2.tmp");
    // It says so between two steps of its work.
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.contains("SIGUSR1") && line.contains("`--checkpoint`")), "it ended");
    assert!(quiet.try_wait().unwrap().is_none(), "it ended");
    for child in [&mut quiet, &mut child] {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let mut said = String::new();
    quiet.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(said, "", "who is asked to say nothing but errors");
    // What both left goes with the next one.
    assert!(desk.names().contains(&".rtc-a.png.2.tmp".to_string()), "{:?}", desk.names());
    build(&desk, "--samples 1 -o a.png").expect(0, &[]);
    assert_eq!(desk.names(), ["a.png", "ball.rt", "room.rt"]);
}

#[cfg(unix)]
#[test]
fn what_could_not_be_kept_is_told() {
    let desk = desk();
    let told = |flags: &str, blocks: u32| {
        let arguments = format!("build room.rt --size 48x36 -o a.png --checkpoint {flags}");
        let small =
            format!("trap '' XFSZ; ulimit -f {blocks}; exec '{}' {arguments}", env!("CARGO_BIN_EXE_rtc"));
        let mut command = Command::new("sh");
        let ended = super::ended(command.args(["-c", &small]).current_dir(desk.path(".")).output().unwrap());
        ended.expect(0, &[]);
        let last = ended.stderr.lines().last().unwrap().to_string();
        (ended.stderr.contains("the samples are not kept"), last)
    };
    let small = 20;
    assert_eq!(told("--samples 4", small), (true, "could keep none".to_string()));
    assert_eq!(told("--samples 4", 2000), (false, "kept 4 samples in `a.png.checkpoint`".to_string()));
    let kept = desk.get("a.png.checkpoint");
    assert!(kept.len() > 512 * small as usize, "{}", kept.len());
    let went_on = "went on from 4 samples in `a.png.checkpoint`, could keep no more";
    assert_eq!(told("--samples 9", small), (true, went_on.to_string()));
    assert_eq!(desk.get("a.png.checkpoint"), kept);
}

#[test]
fn a_checkpoint_is_of_one_process_at_a_time() {
    let desk = desk();
    let mut first = desk.command("build room.rt --size 200x150 --samples 1000000 -o a.png --checkpoint=kept");
    let mut first = first.stderr(Stdio::null()).spawn().unwrap();
    desk.wait_for(".rtc-kept.lock.tmp", &mut first);
    build(&desk, "--samples 1 -o b.exr --checkpoint=kept")
        .expect(2, &["cannot write `kept`: another process"]);
    first.kill().unwrap();
    first.wait().unwrap();
    build(&desk, "--samples 1 -o b.exr --checkpoint=kept").expect(0, &[]);
}

#[cfg(unix)]
#[test]
fn a_pipe_beside_a_picture_is_not_waited_for() {
    let desk = desk();
    for name in [".rtc-a.exr.tmp", ".rtc-a.exr.checkpoint.tmp", ".rtc-a.exr.checkpoint.lock.tmp"] {
        assert!(Command::new("mkfifo").arg(desk.path(name)).status().unwrap().success());
        build(&desk, "--samples 1 -o a.exr --checkpoint").expect(2, &["is not a file", "remove"]);
        fs::remove_file(desk.path(name)).unwrap();
    }
    assert!(Command::new("mkfifo").arg(desk.path("pipe")).status().unwrap().success());
    let from = build(&desk, "--samples 1 -o a.exr --resume=pipe --checkpoint=kept");
    from.expect(2, &["cannot read `pipe`: it is not a file"]);
}

#[cfg(unix)]
#[test]
fn killed_at_any_moment_it_goes_on_and_the_bytes_are_the_same() {
    let desk = desk();
    let picture = "build room.rt --size 200x150 --samples 100";
    let arguments = format!("{picture} -o a.exr --checkpoint --checkpoint-every 1spp");
    // With one thread it takes a while on any machine.
    let in_time = [0, 5, 20, 100].map(|delay| {
        desk.kill_after(&format!("{arguments} -j 1"), "a.exr.checkpoint", Duration::from_millis(delay))
    });
    assert!(in_time[0] && in_time[1], "{in_time:?}");
    desk.run(&arguments).expect(0, &["100 samples", "went on from"]);
    desk.run(&format!("{picture} -o b.exr")).expect(0, &[]);
    assert_same(&desk.path("a.exr"), &desk.path("b.exr"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_terminal_ends_a_build_that_is_not_to_go_on() {
    for (begun, goes_on) in [("--default-signal=HUP", false), ("--ignore-signal=HUP", true)] {
        let desk = desk();
        let build = desk.command("build room.rt --size 48x36 --samples 1000000 -o a.png --checkpoint=kept");
        let mut command = Command::new("env");
        command.arg(begun).arg(build.get_program()).args(build.get_args());
        let mut child =
            command.current_dir(build.get_current_dir().unwrap()).stderr(Stdio::piped()).spawn().unwrap();
        desk.wait_for(".rtc-kept.lock.tmp", &mut child);
        if goes_on {
            send("HUP", &child);
        }
        send("USR1", &child);
        desk.wait_for("kept", &mut child);
        send(if goes_on { "TERM" } else { "HUP" }, &child);
        let ended = super::ended(child.wait_with_output().unwrap());
        ended.expect(130, &["interrupted; kept ", " samples in `kept`"]);
    }
}

#[cfg(unix)]
#[test]
fn signals_write_a_checkpoint() {
    let desk = desk();
    let [store, elsewhere] = ["store", "elsewhere"].map(|name| desk.path(name));
    for signal in ["INT", "TERM"] {
        fs::create_dir(&store).unwrap();
        let arguments = "build room.rt --size 48x36 --samples 1000000 -o a.png --checkpoint=store/kept";
        let mut child = desk.command(arguments).stderr(Stdio::piped()).spawn().unwrap();
        // Its ears are open before that.
        desk.wait_for("store/.rtc-kept.lock.tmp", &mut child);
        assert!(!desk.path("store/kept").exists(), "it is not time yet");
        send("USR1", &child);
        desk.wait_for("store/kept", &mut child);
        let before = desk.get("store/kept");
        // More samples, which cannot be kept until it is asked to end.
        fs::rename(&store, &elsewhere).unwrap();
        send("USR1", &child);
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
        assert!(lines.any(|line| line.contains("cannot write `store/kept`")), "it ended");
        fs::rename(&elsewhere, &store).unwrap();
        send(signal, &child);
        let said: Vec<String> = lines.collect();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{said:?}");
        let last = said.last().unwrap();
        assert!(
            last.starts_with("interrupted; kept ") && last.ends_with(" samples in `store/kept`"),
            "{last}"
        );
        assert_ne!(desk.get("store/kept"), before, "SIG{signal} wrote no checkpoint");
        // There are more already.
        desk.run("build room.rt --size 48x36 --samples 1 -o a.png --resume=store/kept")
            .expect(2, &["samples a pixel already, and no more than 1 are asked for", "`rtc develop`"]);
        desk.run("develop store/kept -o a.png").expect(0, &[]);
        fs::remove_file(desk.path("store/kept")).unwrap();
        fs::remove_dir(&store).unwrap();
        fs::remove_file(desk.path("a.png")).unwrap();
        assert_eq!(desk.names(), ["ball.rt", "room.rt"]);
    }
}
