//! When a picture is done: at which limit it stops, and how one that is on the way to a noise goes on.

use super::{build, desk};
use crate::command::assert_same;
use std::fs;

/// A scene in which noise is soon gone.
const CALM: &str = "
sphere { radius: 1m }
plane { at: (0, -1, 0)m }
light { at: (2, 4, 3)m, radius: 1m, power: 90W }
";

#[test]
fn a_noise_target_goes_on_only_as_it_was_to_be_shown() {
    let desk = desk();
    desk.put("room.rt", CALM);
    let noise = |rest: &str| {
        build(&desk, &format!("--noise 2% --samples 512 --min-samples 4 -o a.exr --checkpoint {rest}"))
    };
    noise("--exposure 2").expect(0, &[]);
    noise("--exposure 1").expect(2, &["`--exposure 1` (kept: 2)", "--resume=never"]);
    noise("--exposure 2 --tonemap none").expect(2, &["`--tonemap none` (kept: neutral)"]);
    noise("--exposure 2").expect(0, &[]);
    // A number of samples does not ask how they are shown.
    build(&desk, "--samples 600 --exposure 1 -o a.exr --checkpoint").expect(0, &[]);
    build(&desk, "--samples 600 --exposure 1 -o b.exr").expect(0, &[]);
    assert_same(&desk.path("a.exr"), &desk.path("b.exr"));
    noise("--exposure 1").expect(2, &["no more than 512 are asked for: `--samples 600` goes on"]);
    // Where all pixels have as many, none was chosen.
    build(&desk, "--noise 2% --samples 700 --exposure 1 -o a.exr --checkpoint").expect(0, &[]);
}

#[test]
fn a_picture_stops_at_the_first_limit_and_says_at_which() {
    let desk = desk();
    desk.put("room.rt", CALM);
    let run = |rest: &str| desk.run(&format!("build room.rt --size 48x36 {rest}"));
    run("--checkpoint-every 9spp -o a.exr")
        .expect(2, &["`--checkpoint-every` is for work that is kept", "keep it with"]);
    desk.run("build room.rt --size 4x3 --noise 0.01% --min-samples 70000 -o a.exr")
        .expect(0, &["70000 samples", "W0701"]);
    run("--noise 1.5% -o a.exr -j 1").expect(0, &["noise", "as wanted"]);
    run("--noise 1.5% -o b.exr -j 2").expect(0, &["as wanted"]);
    assert_same(&desk.path("a.exr"), &desk.path("b.exr"));
    let stopped = run("--noise 0.01% --samples 20 -o c.exr");
    stopped.expect(0, &["20 samples (noise"]);
    assert!(!stopped.stderr.contains("W0701"), "who limits the samples knows: {}", stopped.stderr);
    run("--noise 50% --min-samples 40 -o c.exr").expect(0, &["40 samples"]);
    run("--min-samples 40 --samples 50 -o c.exr").expect(2, &["`--min-samples` is for a noise target"]);
    let timed = run("--time 300ms -o timed.png");
    timed.expect(0, &["stopped by the time"]);
    let (_, after) = timed.stderr.split_once("again by `--samples ").unwrap();
    let samples = after.split_once('`').unwrap().0;
    run(&format!("--samples {samples} -o again.png")).expect(0, &[]);
    assert_same(&desk.path("timed.png"), &desk.path("again.png"));
    run("--time 1h --samples 3 -o c.exr").expect(0, &["3 samples"]);
}

#[test]
fn a_noise_target_that_was_put_aside_goes_on_to_the_same_bytes() {
    let desk = desk();
    desk.put("room.rt", CALM);
    let run = |rest: &str| build(&desk, &format!("--noise 1.5% {rest}")).expect(0, &[]);
    run("-o whole.exr");
    // In the middle of a rung, and at its end.
    for samples in [5, 64, 96, 128] {
        build(&desk, &format!("--noise 1.5% --samples {samples} -o a.exr --checkpoint=kept")).expect(0, &[]);
        run("-o a.exr --checkpoint=kept");
        assert_same(&desk.path("whole.exr"), &desk.path("a.exr"));
        fs::remove_file(desk.path("kept")).unwrap();
    }
}
