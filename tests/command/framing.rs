//! Where the camera of a film stands whose scene does not say it.

use super::{Desk, assert_same, ended};

/// A ball that rolls away from the origin.
const ROLLING: &str = "
param t: number = 0
sphere { radius: 50cm, at: (t * 1m, 0, 0) }
";

/// Small enough to be over soon.
fn film(desk: &Desk, camera: &str, rest: &str) -> String {
    desk.put("roll.rt", format!("{ROLLING}{camera}"));
    let mut command = desk.command("build roll.rt --size 24x18 --samples 3 --frames 3");
    command.args(["--sweep", "t = 0 to 1"]).args(rest.split(' '));
    let ended = ended(command.output().unwrap());
    ended.expect(0, &[]);
    ended.stderr
}

const CHOSEN: &str = "camera placed by frame 1 for all";

#[test]
fn the_first_frame_chooses_for_all_where_the_camera_stands() {
    let desk = Desk::new();
    let said = film(&desk, "", "-o f{}.png");
    assert_eq!(said.matches("no camera:").count(), 1, "{said}");
    assert!(said.contains(CHOSEN), "{said}");
    assert_ne!(desk.get("f1.png"), desk.get("f3.png"), "the ball moves in the picture");
    // Whoever makes which frames, in whatever order.
    film(&desk, "", "--only 2,3 -o o{}.png --resume");
    assert_same(&desk.path("o2.png"), &desk.path("f2.png"));
    assert_same(&desk.path("o3.png"), &desk.path("f3.png"));
    let again = film(&desk, "", "-o o{}.png --resume");
    assert!(again.contains("frame 2 of 3 is done") && again.contains("frame 3 of 3 is done"), "{again}");
    assert_same(&desk.path("o1.png"), &desk.path("f1.png"));
    // A frame of another camera is another one, also where the same things stand in it.
    let another = film(&desk, "camera { fov: 30deg }", "-o o{}.png --resume");
    assert_eq!(another.matches("made anew: another camera").count(), 3, "{another}");
}

#[test]
fn what_a_camera_gives_is_that_of_each_frame() {
    let desk = Desk::new();
    // The middle of the first frame is the origin.
    let said = film(&desk, "camera { from: (0, 1, 4)m }", "-o open{}.png");
    assert!(said.contains(CHOSEN), "{said}");
    let said = film(&desk, "camera { from: (0, 1, 4)m, look: (0, 0, 0)m }", "-o given{}.png");
    assert!(!said.contains(CHOSEN), "{said}");
    assert_same(&desk.path("open3.png"), &desk.path("given3.png"));
    film(&desk, "camera { from: (t * 1m, 1m, 4m) }", "-o moved{}.png");
    film(&desk, "camera { from: (t * 1m, 1m, 4m), look: (0, 0, 0)m }", "-o also{}.png");
    assert_same(&desk.path("moved3.png"), &desk.path("also3.png"));
    assert_ne!(desk.get("moved3.png"), desk.get("open3.png"));
}
