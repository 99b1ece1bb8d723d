//! Shares of a picture's samples: made, put together, and what is none.

use super::{ROOM, build, desk};
use crate::command::{assert_same, ended};
use std::fs;
use std::process::Stdio;
use std::time::Duration;

#[test]
fn shares_put_together_are_the_picture_of_one_machine() {
    let desk = desk();
    build(&desk, "--samples 10 -o one.exr -o one.png -j 1").expect(0, &[]);
    for index in 1..=3 {
        build(&desk, &format!("--samples 10 --shard {index}/3 -o part{index}.exr")).expect(0, &[]);
    }
    desk.run("merge part3.exr part1.exr part2.exr -o all.exr -o all.png")
        .expect(0, &["all.exr, all.png: 48×36, 10 samples", "of 3 shares"]);
    assert_same(&desk.path("one.exr"), &desk.path("all.exr"));
    assert_same(&desk.path("one.png"), &desk.path("all.png"));

    desk.run("merge part1.exr part3.exr -o no.exr").expect(2, &["share 2 of 3 is missing", "--partial"]);
    desk.run("merge part1.exr -o no.exr").expect(2, &["shares 2, 3 of 3 are missing"]);
    desk.run("merge --partial part1.exr part3.exr -o look.png")
        .expect(0, &["share 2 of 3 is missing", "7 samples"]);
    build(&desk, "--samples 10 --shard 1/2 -o part1.exr")
        .expect(2, &["`part1.exr` is share 1 of 3, and would be replaced by share 1 of 2", "--shard 1/3"]);
    build(&desk, "--samples 10 --shard 1/3 -o part1.exr").expect(0, &[]);
    build(&desk, "--samples 10 --shard 1/2 -o one.exr -o half.exr").expect(0, &[]);
    build(&desk, "--samples 10 -o one.exr").expect(0, &[]);
    // What lacks samples says so, and what has all of them is like any picture.
    desk.run("merge --partial part1.exr part3.exr -o some.exr -q").expect(0, &[]);
    desk.run("merge --partial part2.exr -o look.png").expect(0, &["of 1 share\n"]);
    let says = |file: &str| desk.get(file).windows(10).any(|bytes| bytes == b"rtc.shares");
    assert_eq!((says("some.exr"), says("all.exr")), (true, false));
    for (flag, said) in
        [("--exposure 4", "(this share: 4)"), ("--tonemap none", "`--tonemap neutral` (this share: none)")]
    {
        build(&desk, &format!("--samples 10 --shard 2/3 {flag} -o foreign.exr")).expect(0, &[]);
        for order in ["part1.exr foreign.exr part3.exr", "part3.exr part1.exr foreign.exr"] {
            desk.run(&format!("merge {order} -o no.exr"))
                .expect(2, &["`foreign.exr` does not go with", said]);
        }
    }
    fs::copy(desk.path("part2.exr"), desk.path("again.exr")).unwrap();
    desk.run("merge part1.exr part2.exr again.exr -o no.exr")
        .expect(2, &["`again.exr` is share 2 of 3, and so is `part2.exr`"]);
    build(&desk, "--samples 10 --shard 2/3 --seed 9 -o foreign.exr").expect(0, &[]);
    desk.run("merge part1.exr foreign.exr part3.exr -o no.exr")
        .expect(2, &["`foreign.exr` does not go with `part1.exr` and 1 more", "`--seed 0` (this share: 9)"]);
    // The odd one is that which most do not go with, wherever it stands; of two that is nobody.
    desk.run("merge --partial foreign.exr part1.exr part3.exr -o look.png").expect(
        0,
        &["warning: `foreign.exr` does not go with", "it is left out", "7 samples", "of 2 shares"],
    );
    let quiet = desk.run("merge --partial foreign.exr part1.exr part3.exr -o look.png -q");
    assert_eq!((quiet.code, quiet.stderr.as_str()), (Some(0), ""));
    desk.run("merge --partial foreign.exr part1.exr -o no.exr")
        .expect(2, &["`foreign.exr` and `part1.exr` are shares of different pictures"]);
    // Given again and again it is one share.
    desk.run("merge --partial part1.exr part3.exr foreign.exr foreign.exr foreign.exr -o look.png")
        .expect(0, &["`foreign.exr` does not go with", "7 samples", "of 2 shares"]);
    desk.run("merge one.exr -o no.exr")
        .expect(2, &["`one.exr` is a picture alone", "have `--partial` leave it out"]);
    desk.run("merge room.rt -o no.exr").expect(
        2,
        &["`room.rt` is no checkpoint and no share of a picture: it is a text", "`rtc build --shard I/N`"],
    );
    fs::write(desk.path("torn.exr"), &desk.get("part2.exr")[..9000]).unwrap();
    desk.run("merge part1.exr torn.exr part3.exr -o no.exr")
        .expect(2, &["`torn.exr` cannot be read: it is damaged or cut short"]);
    // Of many files it is said which one is not as it should be, wherever it stands.
    let mut spoilt = desk.get("part2.exr");
    let middle = spoilt.len() / 2;
    spoilt[middle] ^= 1;
    desk.put("spoilt.exr", spoilt);
    for wrong in ["torn.exr", "spoilt.exr", "one.exr", "missing.exr"] {
        for order in [format!("{wrong} part1.exr part3.exr"), format!("part1.exr part3.exr {wrong}")] {
            desk.run(&format!("merge {order} -o no.exr")).expect(2, &[&format!("`{wrong}`")]);
        }
    }
    desk.run("merge --partial part1.exr torn.exr part3.exr -o look.png").expect(0, &["it is left out"]);
    assert!(!desk.names().contains(&"no.exr".to_string()));
}

/// A file with another value of an attribute, whose name and type these are.
#[cfg(unix)]
fn with_attribute(file: &[u8], name: &str, value: &[u8]) -> Vec<u8> {
    let name = name.as_bytes();
    let at = file.windows(name.len()).position(|bytes| bytes == name).unwrap() + name.len();
    let length = u32::from_le_bytes(*file[at..].first_chunk().unwrap()) as usize;
    [&file[..at], &(value.len() as u32).to_le_bytes(), value, &file[at + 4 + length..]].concat()
}

#[cfg(unix)]
#[test]
fn a_hostile_file_is_refused_by_its_name_within_little_memory() {
    let desk = desk();
    let flags = "build room.rt --size 10000x10000 --crop 0,0,4,4 --samples 2 --quiet";
    desk.run(&format!("{flags} --shard 1/2 -o part1.exr")).expect(0, &[]);
    desk.run(&format!("{flags} --checkpoint=kept -o some.exr")).expect(0, &[]);
    let window = |side: u32| [0, 0, side - 1, side - 1].map(u32::to_le_bytes).concat();
    for kept in ["part1.exr", "kept"] {
        let data = |file: &[u8], side| with_attribute(file, "dataWindow\0box2i\0", &window(side));
        // As many pixels as there may be, in few bytes; and more than there may be.
        let all = with_attribute(&desk.get(kept), "rtc.saved.crop\0string\0", b"0,0,10000,10000");
        desk.put("all", data(&all, 10_000));
        let display = with_attribute(&desk.get(kept), "displayWindow\0box2i\0", &window(32_768));
        desk.put("billion", data(&display, 32_768));
        // More bytes than memory, of which nothing is told.
        fs::File::create(desk.path("empty")).and_then(|file| file.set_len(8 << 30)).unwrap();
        let hostiles = [
            ("all", "cannot hold"),
            ("billion", "1073741824 pixels"),
            ("empty", "is no checkpoint and no share"),
        ];
        for (hostile, said) in hostiles {
            let merge = format!("merge part1.exr {hostile} -o no.exr");
            let resume = format!(
                "{} --crop 0,0,10000,10000 --resume={hostile} -o no.exr",
                flags.replace("--crop 0,0,4,4", "")
            );
            for arguments in [merge, resume] {
                let capped = format!("ulimit -v 4194304; exec '{}' {arguments}", env!("CARGO_BIN_EXE_rtc"));
                let mut command = std::process::Command::new("sh");
                command.args(["-c", &capped]).current_dir(desk.path("."));
                ended(command.output().unwrap()).expect(2, &[&format!("`{hostile}`"), said]);
            }
        }
    }
}

#[test]
fn a_share_that_is_made_twice_at_once_is_one_whole_file() {
    let desk = desk();
    let share = "build room.rt --size 96x72 --samples 60 --quiet --shard 2/3";
    desk.run(&format!("{share} -o one.exr")).expect(0, &[]);
    // As the scripts of a farm ask for it, and without what keeps another one from it.
    for (keeping, written) in
        [("--checkpoint --checkpoint-every 1spp", "two.exr.checkpoint"), ("", ".rtc-two.exr.1.tmp")]
    {
        let start =
            || desk.command(&format!("{share} -o two.exr {keeping}")).stderr(Stdio::piped()).spawn().unwrap();
        // With one thread it takes a while on any machine.
        let lost = format!("{share} -o two.exr {keeping} -j 1");
        assert!(desk.kill_after(&lost, written, Duration::ZERO), "it was done before");
        let both: Vec<_> = (0..3).map(|_| start()).collect();
        let both: Vec<_> = both.into_iter().map(|child| ended(child.wait_with_output().unwrap())).collect();
        assert!(both.iter().any(|ended| ended.code == Some(0)), "{both:?}");
        for ended in both.iter().filter(|ended| ended.code != Some(0)) {
            ended.expect(2, &["`two.exr", "another process is writing it"]);
        }
        assert_same(&desk.path("one.exr"), &desk.path("two.exr"));
        desk.run(&format!("{share} -o two.exr {keeping}")).expect(0, &[]);
        assert_same(&desk.path("one.exr"), &desk.path("two.exr"));
        fs::remove_file(desk.path("two.exr")).unwrap();
    }
}

#[test]
fn a_share_needs_a_number_of_samples_and_an_exr() {
    let desk = desk();
    let refused = |rest: &str, said: &str| build(&desk, rest).expect(2, &[said]);
    refused("--shard 1/2 --noise 1% -o a.exr", "`--shard` and `--noise` do not go together");
    refused("--shard 1/2 --time 1s -o a.exr", "`--shard` and `--time` do not go together");
    refused("--shard 1/2 --aov depth -o a.exr", "`--shard` and `--aov` do not go together");
    refused("--shard 1/2 -o a.png", "a share of a picture is an EXR");
    refused("--shard 1/2", "a share of a picture is an EXR");
    refused("--shard 1/9 --samples 4 -o a.exr", "cannot be divided into 9 shares");
    refused("--shard 0/2 -o a.exr", "counted from 1 to 2");
    refused("--shard auto -o a.exr", "this is none");
    desk.put("noisy.rt", format!("{ROOM}render {{ noise: 5% }}\n"));
    desk.run("build noisy.rt --shard 1/2 -o a.exr").expect(2, &["the scene asks for a noise", "--samples N"]);

    let by_slurm = |id: &str, count: &str, max: &str| {
        let mut command = desk.command("build room.rt --size 8x6 --samples 4 --quiet --shard auto -o a.exr");
        let variables = [("ID", id), ("COUNT", count), ("MIN", "1"), ("MAX", max)];
        command.envs(variables.map(|(name, value)| (format!("SLURM_ARRAY_TASK_{name}"), value)));
        ended(command.output().unwrap())
    };
    by_slurm("2", "2", "2").expect(0, &[]);
    desk.run("merge a.exr -o b.exr").expect(2, &["share 1 of 2 is missing"]);
    by_slurm("2", "1", "2").expect(2, &["auto/N"]);
}
