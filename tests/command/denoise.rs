//! Pictures without noise.

use super::{Desk, Ended, assert_same, ended, read_png};
use exr::prelude::*;
use std::collections::BTreeMap;
use std::time::Duration;

const POTS: &str = "
sphere { radius: 1m, material: diffuse { color: #c05030 } }
plane { at: (0, -1, 0)m, material: diffuse { color: checker(#ddd, #333, 2m) } }
light { at: (2, 4, 3)m, radius: 50cm, power: 200W }
camera { from: (0, 1, 5)m, look: (0, 0, 0)m }
";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.put("pots.rt", POTS);
    desk
}

fn build(desk: &Desk, rest: &str) -> Ended {
    desk.run(&format!("build pots.rt --size 96x72 {rest}"))
}

/// The channels of an EXR by name.
fn channels(file: &[u8]) -> BTreeMap<String, Vec<f32>> {
    let reader = read().no_deep_data().largest_resolution_level().all_channels();
    let image =
        reader.first_valid_layer().all_attributes().from_buffered(std::io::Cursor::new(file)).unwrap();
    let channel = |channel: AnyChannel<FlatSamples>| {
        let FlatSamples::F32(values) = channel.sample_data else { panic!("{} is no float", channel.name) };
        (channel.name.to_string(), values)
    };
    image.layer_data.channel_data.list.into_iter().map(channel).collect()
}

/// How much the values of a channel differ from others, squared.
fn apart(one: &[f32], other: &[f32]) -> f32 {
    one.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[test]
fn an_exr_holds_the_picture_with_and_without_noise() {
    let desk = desk();
    build(&desk, "-q --samples 9 -o plain.exr -o plain.png").expect(0, &[]);
    build(&desk, "--samples 9 --denoise -o both.exr -o clean.png -o clean.pfm -j 1")
        .expect(0, &["96×72, 9 samples", ", denoised in "]);
    build(&desk, "-q --samples 9 --denoise -o again.exr -j 3").expect(0, &[]);
    assert_same(&desk.path("both.exr"), &desk.path("again.exr"));

    let (plain, both) = (channels(&desk.get("plain.exr")), channels(&desk.get("both.exr")));
    let names: Vec<&str> = both.keys().map(String::as_str).collect();
    assert_eq!(names, ["B", "G", "R", "denoised.B", "denoised.G", "denoised.R"]);
    assert!(plain.iter().all(|(name, values)| both[name] == *values), "the traced picture is the same");
    build(&desk, "-q --samples 1024 -o truth.exr").expect(0, &[]);
    let truth = channels(&desk.get("truth.exr"));
    let error = |layer: &str| -> f32 {
        ["R", "G", "B"].iter().map(|name| apart(&both[&format!("{layer}{name}")], &truth[*name])).sum()
    };
    let (before, after) = (error(""), error("denoised."));
    assert!(after < 0.5 * before, "{before} became {after}");

    // Developed later it is either of them.
    desk.run("develop -q both.exr -o later.png").expect(0, &[]);
    desk.run("develop -q both.exr --noisy -o noisy.png").expect(0, &[]);
    desk.run("develop -q both.exr -o later.pfm").expect(0, &[]);
    assert_same(&desk.path("clean.png"), &desk.path("later.png"));
    assert_same(&desk.path("clean.pfm"), &desk.path("later.pfm"));
    assert_same(&desk.path("plain.png"), &desk.path("noisy.png"));
    assert!(desk.get("plain.png") != desk.get("clean.png"));
    // As an EXR it still is both.
    desk.run("develop -q both.exr -o later.exr").expect(0, &[]);
    assert!(channels(&desk.get("later.exr")) == both);
    let tells = |file: &str| desk.get(file).windows(20).any(|bytes| bytes == b"rtc.denoised\0string\0");
    assert_eq!(["plain.exr", "both.exr", "later.exr"].map(tells), [false, true, true]);
    desk.run("develop -q plain.exr --noisy -o noisy.png").expect(0, &[]);
    assert_same(&desk.path("plain.png"), &desk.path("noisy.png"));
}

/// The mean of the squared differences of two pictures as they are shown. What is brighter than white, such as the edge of a
/// lamp, is no more wrong than white, as it is not for who looks at it.
fn shown_error(desk: &Desk, picture: &str, truth: &str) -> f64 {
    let [(_, picture), (_, truth)] = [picture, truth].map(|file| read_png(&desk.get(file)));
    let squares =
        picture.iter().zip(&truth).map(|(a, b)| u64::from(a.abs_diff(*b)) * u64::from(a.abs_diff(*b)));
    squares.sum::<u64>() as f64 / truth.len() as f64
}

#[test]
fn no_example_is_worse_than_with_its_noise() {
    let desk = Desk::new();
    insta::glob!("../../examples", "**/*.rt", |scene| {
        let scene = scene.display();
        let build = |rest: &str| desk.run(&format!("build {scene} --size 48x36 -q {rest}")).expect(0, &[]);
        build("--samples 8 --denoise -o both.exr -o clean.png");
        desk.run("develop -q both.exr --noisy -o noisy.png").expect(0, &[]);
        build("--samples 128 --seed 7 -o truth.png");
        let [before, after] = ["noisy.png", "clean.png"].map(|file| shown_error(&desk, file, "truth.png"));
        // From 0.2 to 0.6 times as much is left of most, 0.89 of what has hardly any noise: the margin is a tenth at least.
        assert!(after <= before, "{scene}: {before} became {after}");
    });
}

#[test]
fn what_is_transparent_stays_so() {
    let desk = desk();
    desk.put(
        "alone.rt",
        "sphere { radius: 1m }\nsky { radiance: 3W/m2 }\nrender { background: transparent, size: (40, 30) }\n",
    );
    desk.run("build -q alone.rt --samples 8 --denoise -o both.exr -o clean.png").expect(0, &[]);
    let both = channels(&desk.get("both.exr"));
    let nothing: Vec<usize> = (0..40 * 30).filter(|index| both["A"][*index] == 0.0).collect();
    assert!(nothing.len() > 300);
    assert!(nothing.iter().all(|index| both["denoised.R"][*index] == 0.0));
    // All that is covered has one colour, also where it is covered in part.
    let covered = (0..40 * 30).filter(|index| both["denoised.A"][*index] > 0.05);
    let colors: Vec<f32> =
        covered.map(|index| both["denoised.R"][index] / both["denoised.A"][index]).collect();
    let inside = both["denoised.R"][15 * 40 + 20];
    assert!(colors.iter().all(|color| (color / inside - 1.0).abs() < 0.05), "{colors:?}");
    // And it is all that a sample met.
    assert_eq!(colors.len() + nothing.len(), 40 * 30);
    desk.run("develop -q both.exr -o later.png").expect(0, &[]);
    assert_same(&desk.path("clean.png"), &desk.path("later.png"));
}

#[test]
fn a_window_and_a_noise_target_are_denoised_too() {
    let desk = desk();
    build(&desk, "--samples 8 --denoise --crop 5,6,20,10 -o part.exr -o part.png")
        .expect(0, &["20×10, 8 samples", ", denoised in "]);
    assert_eq!(channels(&desk.get("part.exr"))["denoised.G"].len(), 200);
    build(&desk, "--noise 2% --denoise -o target.exr -o target.png").expect(0, &[", denoised in "]);
    build(&desk, "-q --noise 2% -o plain.exr").expect(0, &[]);
    let (plain, both) = (channels(&desk.get("plain.exr")), channels(&desk.get("target.exr")));
    assert!(plain.iter().all(|(name, values)| both[name] == *values), "the traced picture is the same");
    // However little time there is, there are two halves.
    build(&desk, "--time 1ms --denoise -o short.exr")
        .expect(0, &["short.exr: 96×72, 2 samples", ", denoised in "]);
    assert!(channels(&desk.get("short.exr")).contains_key("denoised.G"));
}

#[test]
fn it_says_what_it_does_not_go_with() {
    let desk = desk();
    let refused = |rest: &str, said: &[&str]| build(&desk, rest).expect(2, said);
    refused(
        "--denoise --shard 1/2 -o a.exr",
        &["`--denoise` and `--shard` do not go together", "`rtc merge`"],
    );
    refused("--denoise --samples 1 -o a.png", &["`--denoise` needs 2 samples a pixel"]);
    assert!(!desk.names().iter().any(|name| name.starts_with("a.")));
}

#[test]
fn what_is_kept_is_denoised_as_what_is_made_at_once() {
    let desk = desk();
    let made = |rest: &str| build(&desk, &format!("-q -o a.exr -o a.png --checkpoint {rest}"));
    build(&desk, "-q --samples 40 --denoise -o whole.exr -o whole.png").expect(0, &[]);
    let is_whole = || {
        assert_same(&desk.path("whole.exr"), &desk.path("a.exr"));
        assert_same(&desk.path("whole.png"), &desk.path("a.png"));
    };
    // From fewer than half of the samples, and from more; from all, of which nothing is left to trace.
    for before in [1, 11, 20, 33, 40] {
        made(&format!("--samples {before} --denoise --resume=never"))
            .expect(if before == 1 { 2 } else { 0 }, &[]);
        made("--samples 40 --denoise").expect(0, &[]);
        is_whole();
    }
    // What was asked for without the flag in between keeps the halves.
    made("--samples 9 --denoise --resume=never").expect(0, &[]);
    made("--samples 21").expect(0, &[]);
    assert!(!channels(&desk.get("a.exr")).contains_key("denoised.G"));
    made("--samples 40 --denoise").expect(0, &[]);
    is_whole();

    // What was begun without it has none, and is neither traced on nor lost.
    made("--samples 9 --resume=never").expect(0, &[]);
    let kept = desk.get("a.exr.checkpoint");
    made("--samples 40 --denoise").expect(
        2,
        &["cannot go on from `a.exr.checkpoint`: it was begun without `--denoise`", "--resume=never"],
    );
    assert!(desk.get("a.exr.checkpoint") == kept);
    made("--samples 40").expect(0, &[]);
    build(&desk, "-q --samples 40 -o plain.exr").expect(0, &[]);
    assert_same(&desk.path("plain.exr"), &desk.path("a.exr"));
}

#[cfg(unix)]
#[test]
fn killed_at_any_moment_it_goes_on_and_is_denoised_to_the_same_bytes() {
    let desk = desk();
    let picture = "build pots.rt --size 160x120 --samples 60 --denoise";
    let arguments = format!("{picture} -o a.exr --checkpoint --checkpoint-every 1spp");
    // With one thread it takes a while on any machine.
    let in_time = [0, 5, 50, 100].map(|delay| {
        desk.kill_after(&format!("{arguments} -j 1"), "a.exr.checkpoint", Duration::from_millis(delay))
    });
    assert!(in_time[0] && in_time[1], "{in_time:?}");
    desk.run(&arguments).expect(0, &["60 samples", ", denoised in ", "went on from"]);
    desk.run(&format!("{picture} -q -o b.exr")).expect(0, &[]);
    assert_same(&desk.path("b.exr"), &desk.path("a.exr"));
}

#[test]
fn frames_of_a_film_are_denoised() {
    let desk = desk();
    desk.put(
        "pots.rt",
        POTS.replace("from: (0, 1, 5)m", "from: (t, 1m, 5m), exposure: 0") + "param t: length = 0\n",
    );
    let film = |rest: &str| {
        let mut command = desk.command("build pots.rt --size 96x72 --samples 5 --frames 2 --resume");
        command.args(["--sweep", "t = 0 to 1m"]).args(rest.split_whitespace());
        ended(command.output().unwrap())
    };
    film("--denoise -o f{}.exr -o f{}.png -o film.webp")
        .expect(0, &["f2.exr, f2.png, frame 2 of 2", ", denoised in "]);
    build(&desk, "-q --samples 5 --set t=1m --denoise -o one.exr -o one.png").expect(0, &[]);
    assert_same(&desk.path("one.exr"), &desk.path("f2.exr"));
    assert_same(&desk.path("one.png"), &desk.path("f2.png"));
    assert!(channels(&desk.get("f1.exr")).contains_key("denoised.G"));

    // Those that are done are taken, without noise too, and never for those with noise.
    film("--denoise -o f{}.exr -o f{}.png -o again.webp")
        .expect(0, &["frame 1 of 2 is done", "frame 2 of 2 is done"]);
    assert_same(&desk.path("film.webp"), &desk.path("again.webp"));
    film("-o f{}.exr -o f{}.png -o noisy.webp").expect(0, &["made anew: no `--denoise` (made: yes)"]);
    assert!(!channels(&desk.get("f1.exr")).contains_key("denoised.G"));
    assert!(desk.get("film.webp") != desk.get("noisy.webp"));
}
